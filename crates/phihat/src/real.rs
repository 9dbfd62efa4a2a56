//! The scalar of the core: `f32` or `f64`.

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// A real number the controller can run on: `f32` for microcontrollers, `f64` elsewhere.
///
/// Design-time arithmetic is always `f64`; only the running law uses this scalar.
pub trait Real:
    sealed::Sealed
    + Copy
    + Debug
    + Default
    + PartialOrd
    + Add<Output = Self>
    + AddAssign
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Zero.
    const ZERO: Self;
    /// The nearest value to `x`.
    fn from_f64(x: f64) -> Self;
    /// The same value.
    fn to_f64(self) -> f64;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;

    /// Magnitude below which a state is taken as zero, far above the subnormal range: arithmetic on
    /// subnormal numbers is slow on many processors.
    const TINY: Self;
    /// `|self|`.
    #[must_use]
    fn abs(self) -> Self;
    /// `√self`, within one unit in the last place; zero for negative arguments and NaN.
    #[must_use]
    fn sqrt(self) -> Self;

    /// `self`, or zero when it is smaller than [`Self::TINY`].
    #[must_use]
    fn snap(self) -> Self {
        if self < Self::TINY && self > -Self::TINY { Self::ZERO } else { self }
    }

    /// `2^(E − 32)`, `2^E` being where the scalar ends.
    const REACH: Self;

    /// Zero when every value can be one of an arm, NaN otherwise, without a branch: finite, and within ±2³²
    /// (4.3e9) rad, rad/s, rad/s² or N·m. What is beyond could not be forgotten again. Doubts may be added up.
    #[must_use]
    fn doubt<const N: usize>(values: [Self; N]) -> Self {
        // From −0, to which adding costs nothing.
        let mut sum = -Self::ZERO;
        for value in values {
            sum += value * Self::REACH * Self::ZERO;
        }
        sum
    }

    /// `self` limited to `[−limit, limit]`; NaN stays NaN, so that it cannot turn into a torque
    /// silently (`max().min()` would answer `−limit`).
    #[must_use]
    fn saturate(self, limit: Self) -> Self {
        if self > limit {
            limit
        } else if self < -limit {
            -limit
        } else {
            self
        }
    }
}

impl Real for f32 {
    const ZERO: Self = 0.0;
    #[allow(
        clippy::cast_possible_truncation,
        reason = "rounding to the running scalar is the point"
    )]
    fn from_f64(x: f64) -> Self {
        x as f32
    }
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    fn is_finite(self) -> bool {
        self.is_finite()
    }
    const TINY: Self = 1e-30;
    const REACH: Self = Self::from_bits((127 + 96) << 23);
    fn abs(self) -> Self {
        self.abs()
    }
    fn sqrt(self) -> Self {
        if !(self > Self::TINY && self.is_finite()) {
            return Self::ZERO;
        }
        // Halving the exponent is within 4 %; each step of Newton's doubles the digits.
        let mut root = Self::from_bits((self.to_bits() >> 1) + 0x1fbd_1df5);
        for _ in 0..3 {
            root = 0.5 * (root + self / root);
        }
        root
    }
}

impl Real for f64 {
    const ZERO: Self = 0.0;
    fn from_f64(x: f64) -> Self {
        x
    }
    fn to_f64(self) -> f64 {
        self
    }
    fn is_finite(self) -> bool {
        self.is_finite()
    }
    const TINY: Self = 1e-150;
    const REACH: Self = Self::from_bits((1023 + 992) << 52);
    fn abs(self) -> Self {
        self.abs()
    }
    fn sqrt(self) -> Self {
        if !(self > Self::TINY && self.is_finite()) {
            return Self::ZERO;
        }
        // Halving the exponent is within 4 %; each step of Newton's doubles the digits.
        let mut root = Self::from_bits((self.to_bits() >> 1) + 0x1ff7_a3be_a91d_9b1b);
        for _ in 0..4 {
            root = 0.5 * (root + self / root);
        }
        root
    }
}
