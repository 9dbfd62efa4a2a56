//! Numbers of few digits, for people to read.

/// To so many significant digits, upwards.
pub fn up(value: f64, digits: i32) -> f64 {
    rounded(value, digits, f64::ceil)
}

/// To so many significant digits, downwards.
pub fn down(value: f64, digits: i32) -> f64 {
    rounded(value, digits, f64::floor)
}

/// To the nearest number of so many significant digits.
pub fn nearest(value: f64, digits: i32) -> f64 {
    rounded(value, digits, f64::round)
}

/// To so many places behind the point.
pub fn places(value: f64, places: usize) -> f64 {
    format!("{value:.places$}").parse().unwrap_or(value)
}

fn rounded(value: f64, digits: i32, to: impl Fn(f64) -> f64) -> f64 {
    let unit = libm::pow(10.0, libm::log10(value.abs()).floor() - f64::from(digits - 1));
    // As it is written: without what the product adds behind the last digit.
    let near = to(value / unit) * unit;
    format!("{near:.12e}").parse().ok().filter(|near: &f64| near.is_finite()).unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::{down, nearest, places, up};

    #[test]
    fn few_digits_to_either_side() {
        let few = [up(0.012_34, 2), down(0.012_39, 2), nearest(0.012_36, 2), up(-2.71, 2)];
        assert_eq!(few.map(|x| x.to_string()), ["0.013", "0.012", "0.012", "-2.7"]);
        let few = [up(0.3, 2), nearest(1e-7, 3), places(0.123_45, 3), up(0.0, 2)];
        assert_eq!(few.map(|x| x.to_string()), ["0.3", "0.0000001", "0.123", "0"]);
        assert!(nearest(f64::INFINITY, 2).is_infinite() && up(f64::NAN, 2).is_nan());
    }
}
