//! The largest and the smallest of numbers. `f64::max` passes over what is not a number; a bound must not.

/// The larger; not a number where one of them is none.
#[inline]
#[must_use]
pub fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b <= a { a } else { b }
}

/// The smaller; not a number where one of them is none.
#[inline]
#[must_use]
pub fn smaller(a: f64, b: f64) -> f64 {
    if a.is_nan() || b >= a { a } else { b }
}

/// The least interval that holds all; not a number where an end of one is none.
pub fn hull(all: impl Iterator<Item = (f64, f64)>) -> (f64, f64) {
    let none = (f64::INFINITY, f64::NEG_INFINITY);
    all.fold(none, |(low, high), (a, b)| (smaller(low, a), larger(high, b)))
}

/// Ends of a row of numbers.
pub trait Extremes: Iterator<Item = f64> + Sized {
    /// The largest of sizes; 0 of none, and not a number where one of them is none.
    fn largest(self) -> f64 {
        self.fold(0.0, larger)
    }

    /// The least; ∞ of none, and not a number where one of them is none.
    fn least(self) -> f64 {
        self.fold(f64::INFINITY, smaller)
    }

    /// The least and the largest, of either sign.
    fn ends(self) -> (f64, f64) {
        hull(self.map(|value| (value, value)))
    }
}

impl<I: Iterator<Item = f64>> Extremes for I {}

#[cfg(test)]
mod tests {
    use super::{Extremes as _, hull, larger, smaller};

    #[test]
    fn what_is_no_number_is_no_bound() {
        let nan = f64::NAN;
        for (a, b) in [(1.0, nan), (nan, 1.0), (nan, nan), (f64::INFINITY, nan)] {
            assert!(larger(a, b).is_nan() && smaller(a, b).is_nan());
            assert!([a, b, 2.0].into_iter().largest().is_nan());
            assert!([a, b, 2.0].into_iter().least().is_nan());
            assert!(hull([(a, 1.0), (b, 1.0)].into_iter()).0.is_nan());
        }
        assert!(larger(1.0, 2.0) > 1.5 && smaller(1.0, 2.0) < 1.5 && larger(2.0, 1.0) > 1.5);
        assert!([1.0, 3.0, 2.0].into_iter().largest() > 2.5);
        assert!([2.0, 1.0, 3.0].into_iter().least() < 1.5);
        assert_eq!([-1.0, 2.0, -3.0].into_iter().ends(), (-3.0, 2.0));
        assert_eq!(hull([(-1.0, 0.5), (-0.5, 2.0)].into_iter()), (-1.0, 2.0));
    }
}
