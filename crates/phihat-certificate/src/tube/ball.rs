//! Balls: all reals within a radius of a double, with every rounding counted.

use core::f64::consts::{FRAC_2_PI, FRAC_PI_2};
use core::ops::{Add, Mul, Neg, Sub};

/// Twice the largest relative error of an operation on doubles, rounded to nearest.
const UNIT: f64 = f64::EPSILON;

/// More than what a product loses that is too small for a double.
const TINY: f64 = 1e-280;

/// Bound on `π/2 − FRAC_PI_2`, which is 6.1233e-17.
const BEYOND_HALF: f64 = 6.1233e-17;

/// Quarter turns from which on a sine is not enclosed more tightly than by 1.
const FAR: f64 = 1e6;

/// Squares of the series of sine and cosine.
const TERMS: u32 = 9;

/// All reals within `r` of `m`.
///
/// The middle of a result is the rounded result at the middles. That is off by at most `2⁻⁵³` of the exact one, so by
/// at most `2⁻⁵²|m|`, which [`radius`] adds.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Ball {
    pub(super) m: f64,
    pub(super) r: f64,
}

/// Radius of a result: `r` is a sum of up to 100 terms of one sign, and `sizes` that of what was rounded on the way.
/// Sum and product of these lose at most `(1 − 2⁻⁵³)^120`, which the factor gives back.
pub(super) fn radius(r: f64, sizes: f64) -> f64 {
    (r + UNIT * sizes) * (1.0 + 64.0 * UNIT) + TINY
}

impl Ball {
    /// One double.
    pub(super) fn exact(value: f64) -> Self {
        Self { m: value, r: 0.0 }
    }

    /// Largest size of what is inside.
    pub(super) fn size(self) -> f64 {
        self.m.abs() + self.r
    }

    /// The ball around an interval.
    pub(super) fn around(low: f64, high: f64) -> Self {
        let m = 0.5 * (low + high);
        Self { m, r: radius(0.5 * (high - low), m.abs()) }
    }

    /// Sine and cosine: `|sin(m + d) − sin m| ≤ |cos m| r + r²/2`, likewise the cosine.
    pub(super) fn sin_cos(self) -> (Self, Self) {
        let (s, c) = sin_cos_of(self.m);
        let bend = 0.5 * self.r * self.r;
        let of = |at: Self, slope: Self| Self {
            m: at.m,
            r: if self.r > 0.0 { radius(at.r + slope.size() * self.r + bend, 0.0) } else { at.r },
        };
        (of(s, c), of(c, s))
    }

    /// Quotient by a whole number.
    fn over(self, whole: u32) -> Self {
        let by = f64::from(whole);
        let m = self.m / by;
        Self { m, r: radius(self.r / by, m.abs()) }
    }
}

/// Sine and cosine of a double: those of the platform, with their distance from Taylor's sums in balls.
///
/// With `x = kπ/2 + y`, `|y| < 0.8`: the sums end with `y¹⁹/19!` and `y¹⁸/18!`, and what is left of these alternating
/// series is at most `0.8²¹/21! < 2e-22` and `0.8²⁰/20! < 5e-21`. No accuracy of the platform is used.
pub(super) fn sin_cos_of(x: f64) -> (Ball, Ball) {
    let quarters = (x * FRAC_2_PI).round();
    if quarters.is_nan() || quarters.abs() > FAR {
        let any = Ball { m: 0.0, r: if x.is_finite() { 1.0 } else { f64::NAN } };
        return (any, any);
    }
    let half = Ball { m: FRAC_PI_2, r: BEYOND_HALF };
    let y = Ball::exact(x) - Ball::exact(quarters) * half;
    let (square, one) = (y * y, Ball::exact(1.0));
    let (mut sine, mut cosine) = (one, one);
    for j in (1..=TERMS).rev() {
        sine = one - (square * sine).over(2 * j * (2 * j + 1));
        cosine = one - (square * cosine).over(2 * j * (2 * j - 1));
    }
    sine = y * sine;
    let left = if y.size() < 0.8 { 5e-21 } else { 1.0 };
    let (sine, cosine) = match quarters.rem_euclid(4.0) {
        turn if turn < 0.5 => (sine, cosine),
        turn if turn < 1.5 => (cosine, -sine),
        turn if turn < 2.5 => (-sine, -cosine),
        _ => (-cosine, sine),
    };
    let (s, c) = libm::sincos(x);
    let around = |m: f64, sum: Ball| Ball { m, r: radius((m - sum.m).abs() + sum.r + left, 0.0) };
    (around(s, sine), around(c, cosine))
}

impl Add for Ball {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        let m = self.m + b.m;
        Self { m, r: radius(self.r + b.r, m.abs()) }
    }
}

impl Sub for Ball {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        let m = self.m - b.m;
        Self { m, r: radius(self.r + b.r, m.abs()) }
    }
}

impl Neg for Ball {
    type Output = Self;
    fn neg(self) -> Self {
        Self { m: -self.m, r: self.r }
    }
}

impl Mul for Ball {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        let m = self.m * b.m;
        let r = self.m.abs() * b.r + self.r * b.m.abs() + self.r * b.r;
        Self { m, r: radius(r, m.abs()) }
    }
}
