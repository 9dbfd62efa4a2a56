//! Discs of complex numbers: values over a cell, with bounds on rounding.

use core::ops::{Add, Mul};

use crate::check::complex::Complex;

/// Relative error of an operation on complex numbers, at most.
pub(super) const LOST: f64 = 16.0 * f64::EPSILON;

/// All complex numbers within `radius` of a centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Disc {
    pub(super) centre: Complex,
    pub(super) radius: f64,
}

impl Disc {
    pub(super) fn new(centre: Complex, radius: f64) -> Self {
        Self { centre, radius }
    }

    /// Real numbers from `low` to `high`.
    pub(super) fn between((low, high): (f64, f64)) -> Self {
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        Self::new(Complex::new(middle, 0.0), half + LOST * middle.abs())
    }

    pub(super) fn real(value: f64) -> Self {
        Self::new(Complex::new(value, 0.0), 0.0)
    }

    /// Largest size of a member.
    pub(super) fn most(self) -> f64 {
        (self.centre.size() + self.radius) * (1.0 + LOST)
    }

    /// Smallest size of a member; not positive where 0 may be one.
    pub(super) fn least(self) -> f64 {
        self.centre.size() * (1.0 - LOST) - self.radius
    }

    pub(super) fn times(self, factor: f64) -> Self {
        self * Self::real(factor)
    }

    /// `1/self`; `None` where 0 may be a member.
    pub(super) fn inverse(self) -> Option<Self> {
        let size = self.centre.size();
        let square = (size * size - self.radius * self.radius) * (1.0 - LOST);
        (self.least() > 0.0 && square > 0.0).then(|| {
            let centre = self.centre.conjugate().times(1.0 / square);
            Self::new(centre, (self.radius + LOST * size) / square * (1.0 + LOST))
        })
    }

    /// `p(self)` by the derivatives in its centre, coefficients ascending, each known to a few units in its last place:
    /// `|p(c + d) − p(c)| ≤ Σ |p⁽ᵏ⁾(c)/k!| |d|^k`.
    pub(super) fn polynomial(self, p: &[f64]) -> Self {
        let mut shifted: Vec<Complex> = p.iter().map(|c| Complex::new(*c, 0.0)).collect();
        let n = shifted.len();
        for k in 0..n {
            for i in (k..n.saturating_sub(1)).rev() {
                shifted[i] = shifted[i] + shifted[i + 1] * self.centre;
            }
        }
        // Roundings of all shifts: so many per term of the sums of sizes.
        let size = self.centre.size() + self.radius;
        let sizes = p.iter().rev().fold(0.0, |sum, c| sum * size + c.abs());
        let lost = LOST * (n * n) as f64 * sizes;
        let spread =
            shifted.iter().skip(1).rev().fold(0.0, |sum, c| (sum + c.size()) * self.radius);
        let centre = shifted.first().copied().unwrap_or(Complex::new(0.0, 0.0));
        Self::new(centre, (spread + lost) * (1.0 + LOST))
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
