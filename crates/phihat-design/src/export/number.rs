//! Numbers as other programs read them, and rounded to the safe side for people.

/// All digits that are needed to read the same number back, with a decimal point, as YAML 1.1 and C want it.
pub(super) fn exact(value: f64) -> String {
    let text = format!("{value:?}");
    match text.split_once('e') {
        Some((digits, power)) if !digits.contains('.') => format!("{digits}.0e{power}"),
        _ => text,
    }
}

/// Four significant digits, not below the value: for upper bounds.
pub(super) fn up(value: f64) -> String {
    rounded(value, |figure, value| figure < value)
}

/// Four significant digits, not above the value: for lower bounds.
pub(super) fn down(value: f64) -> String {
    rounded(value, |figure, value| figure > value)
}

fn rounded(value: f64, wrong: impl Fn(f64, f64) -> bool) -> String {
    let text = format!("{value:.3e}");
    let figure: f64 = text.parse().unwrap_or(f64::NAN);
    if !wrong(figure, value) {
        return plain(figure);
    }
    let power: i32 = text.split_once('e').and_then(|(_, p)| p.parse().ok()).unwrap_or(0);
    let unit = 10.0_f64.powi(power - 3);
    let next = if figure < value { figure + unit } else { figure - unit };
    plain(next)
}

/// Without idle zeros; a power of ten only where it is shorter.
fn plain(value: f64) -> String {
    let text = format!("{value:.3e}");
    let figure: f64 = text.parse().unwrap_or(f64::NAN);
    if (1e-4..1e6).contains(&figure.abs()) { format!("{figure}") } else { text }
}

#[cfg(test)]
mod tests {
    use super::{down, exact, up};

    #[test]
    fn numbers_read_back_and_round_to_the_safe_side() {
        let cases =
            [(1.0, "1.0"), (1e-7, "1.0e-7"), (-1.5e-9, "-1.5e-9"), (0.1, "0.1"), (1e20, "1.0e20")];
        for (value, text) in cases {
            assert_eq!(exact(value), text);
        }
        assert_eq!((up(0.123_41), down(0.123_49)), ("0.1235".into(), "0.1234".into()));
        assert_eq!((up(1234.0), down(1234.0)), ("1234".into(), "1234".into()));
        assert_eq!((up(9.999_9), down(2.500_1e-7)), ("10".into(), "2.500e-7".into()));
    }
}
