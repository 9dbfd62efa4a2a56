//! Complex numbers, and discs of them that hold every value a rounded calculation can stand for.

use core::ops::{Add, Mul, Neg, Sub};

/// Relative error of one operation, at most: a few roundings.
const LOST: f64 = 4.0 * f64::EPSILON;

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
        if ROOTED.contains(&square) { square.sqrt() } else { self.re.hypot(self.im) }
    }

    pub(crate) fn angle(self) -> f64 {
        self.im.atan2(self.re)
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

/// All complex numbers within `radius` of a centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Disc {
    pub(crate) centre: Complex,
    pub(crate) radius: f64,
}

impl Disc {
    pub(crate) fn new(centre: Complex, radius: f64) -> Self {
        Self { centre, radius }
    }

    pub(crate) fn real(value: f64) -> Self {
        Self::new(Complex::new(value, 0.0), 0.0)
    }

    /// Largest size of a member.
    pub(crate) fn most(self) -> f64 {
        (self.centre.size() + self.radius) * (1.0 + LOST)
    }

    /// Smallest size of a member; not positive where 0 may be one.
    pub(crate) fn least(self) -> f64 {
        self.centre.size() * (1.0 - LOST) - self.radius
    }

    pub(crate) fn times(self, factor: f64) -> Self {
        let centre = self.centre.times(factor);
        Self::new(centre, (self.radius * factor.abs() + centre.size() * LOST) * (1.0 + LOST))
    }

    /// `self^k`.
    pub(crate) fn power(self, k: usize) -> Self {
        (0..k).fold(Self::real(1.0), |product, _| product * self)
    }

    /// Half the angle under which the disc is seen from 0; infinite where it may hold 0.
    pub(crate) fn half_angle(self) -> f64 {
        let share = self.radius / self.centre.size();
        if share < 1.0 { share.asin() * (1.0 + LOST) + LOST } else { f64::INFINITY }
    }
}

impl Add for Disc {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let centre = self.centre + other.centre;
        let lost = LOST * centre.size();
        Self::new(centre, (self.radius + other.radius + lost) * (1.0 + LOST))
    }
}

impl Mul for Disc {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let (a, b) = (self.centre.size(), other.centre.size());
        let spread = a * other.radius + b * self.radius + self.radius * other.radius;
        Self::new(self.centre * other.centre, (spread + LOST * a * b) * (1.0 + LOST))
    }
}

/// `p(x)` by Horner, coefficients ascending.
pub(crate) fn horner(p: &[f64], x: Disc) -> Disc {
    p.iter().rev().fold(Disc::real(0.0), |sum, c| sum * x + Disc::real(*c))
}
