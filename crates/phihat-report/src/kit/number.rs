//! Numbers for people and for the page's data.

/// Decimal exponent of a finite, non-zero number after rounding to `digits` significant digits.
fn exponent(value: f64, digits: usize) -> i32 {
    let text = format!("{value:.*e}", digits.saturating_sub(1));
    text.split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0)
}

/// Four significant digits: `0.01234`, `12.34`, `1234`, `1.234e-7`.
pub fn number(value: f64) -> String {
    significant(value, 4)
}

/// A tick of an axis of a given length: as short as it can be. What is left of a zero tick after
/// counting up in steps, some 1e-17 of the length, is zero.
pub fn tick(value: f64, length: f64) -> String {
    let value = if value.abs() < 1e-9 * length { 0.0 } else { value };
    trimmed(significant(value, 4))
}

/// A stated value, such as a gain or a bound: six significant digits, no idle zeros.
pub fn stated(value: f64) -> String {
    trimmed(significant(value, 6))
}

fn trimmed(text: String) -> String {
    let (digits, power) = text.split_at(text.find('e').unwrap_or(text.len()));
    if !digits.contains('.') {
        return text;
    }
    format!("{}{power}", digits.trim_end_matches('0').trim_end_matches('.'))
}

fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "not finite".to_owned();
    }
    if value.abs() < f64::MIN_POSITIVE {
        return "0".to_owned();
    }
    let exponent = exponent(value, digits);
    if !(-4..=5).contains(&exponent) {
        return format!("{value:.*e}", digits.saturating_sub(1));
    }
    let wanted = i32::try_from(digits).unwrap_or(4) - 1 - exponent;
    format!("{value:.*}", usize::try_from(wanted).unwrap_or(0))
}

/// Rounded to six significant digits: what the page's data carries.
pub fn rounded(value: f64) -> f64 {
    if value.is_finite() { format!("{value:.5e}").parse().unwrap_or(value) } else { f64::NAN }
}

/// `value` out of `whole` as a percentage.
pub fn percent(value: f64, whole: f64) -> String {
    let share = 100.0 * value / whole;
    if share.is_finite() { format!("{}\u{a0}%", significant(share, 2)) } else { "–".to_owned() }
}

#[cfg(test)]
mod tests {
    use super::{number, percent, rounded, stated, tick};

    #[test]
    fn four_digits_are_kept() {
        let cases = [
            (0.0, "0"),
            (1.0, "1.000"),
            (12.345_6, "12.35"),
            (999.96, "1000"),
            (-0.012_345, "-0.01235"),
            (123_456.0, "123456"),
            (1.5e7, "1.500e7"),
            (2.5e-9, "2.500e-9"),
            (f64::NAN, "not finite"),
        ];
        for (value, text) in cases {
            assert_eq!(number(value), text);
        }
        assert_eq!(tick(0.5, 1.0), "0.5");
        assert_eq!(tick(100.0, 200.0), "100");
        assert_eq!(tick(1e12, 2e12), "1e12");
        assert_eq!(tick(-5.551e-17, 1.0), "0");
        assert_eq!(tick(-5.551e-17, 1e-16), "-5.551e-17");
        assert_eq!(tick(f64::NAN, 1.0), "not finite");
        assert_eq!(stated(986.960_44), "986.96");
        assert_eq!(percent(1.0, 3.0), "33\u{a0}%");
        assert_eq!(percent(1.0, 0.0), "–");
        assert!((rounded(1.234_567_89) - 1.234_57).abs() < 1e-12);
        assert!(rounded(f64::INFINITY).is_nan());
    }
}
