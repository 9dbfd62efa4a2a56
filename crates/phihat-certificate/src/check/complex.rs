//! Complex numbers.

use core::ops::{Add, Mul, Neg, Sub};

/// Squares of sizes that are neither too small nor too large to be added up.
const ROOTED: core::ops::Range<f64> = 1e-280..1e280;

/// A complex number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Complex {
    pub(crate) re: f64,
    pub(crate) im: f64,
}

impl Complex {
    pub(crate) fn new(re: f64, im: f64) -> Self {
        Self { re, im }
    }

    pub(crate) fn size(self) -> f64 {
        let square = self.re * self.re + self.im * self.im;
        // Nothing overflows, and nothing is lost below: a root is as good, and much quicker.
        if ROOTED.contains(&square) { square.sqrt() } else { libm::hypot(self.re, self.im) }
    }

    pub(crate) fn conjugate(self) -> Self {
        Self::new(self.re, -self.im)
    }

    pub(crate) fn times(self, factor: f64) -> Self {
        Self::new(self.re * factor, self.im * factor)
    }

    /// `self/other`.
    pub(crate) fn over(self, other: Self) -> Self {
        (self * other.conjugate()).times(1.0 / (other.re * other.re + other.im * other.im))
    }
}

impl Add for Complex {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::new(self.re + other.re, self.im + other.im)
    }
}

impl Sub for Complex {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self::new(self.re - other.re, self.im - other.im)
    }
}

impl Mul for Complex {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self::new(self.re * other.re - self.im * other.im, self.re * other.im + self.im * other.re)
    }
}

impl Neg for Complex {
    type Output = Self;

    fn neg(self) -> Self {
        Self::new(-self.re, -self.im)
    }
}
