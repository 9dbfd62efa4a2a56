//! Eight numbers side by side, one per arm, with the bits that one arm alone has.
//!
//! # Method
//!
//! Every operation is that of `f64` in each lane. Sines are those of [`trig`], the exponential is that of the
//! `libm` crate (fdlibm's), step by step; lanes outside the range of the vector code get theirs from the code
//! for one number.

use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use bytemuck::cast;
use wide::{f64x8, i64x8};

use crate::trig::{self, COS, HALF_PI, REDUCIBLE, ROUNDER, SIN};
use crate::{Quad, Scalar};

/// Eight real numbers side by side: one per arm of a [`Lockstep`](crate::Lockstep).
///
/// # Example
///
/// ```
/// use phihat_model::{Lanes, Scalar};
///
/// let angles: [f64; Lanes::COUNT] = core::array::from_fn(|k| 0.3 * k as f64);
/// let (sines, _) = Lanes::from(angles).sin_cos();
/// for (angle, sine) in angles.iter().zip(<[f64; 8]>::from(sines)) {
///     assert_eq!(sine.to_bits(), angle.sin_cos_bits());
/// }
/// # trait Bits { fn sin_cos_bits(&self) -> u64; }
/// # impl Bits for f64 { fn sin_cos_bits(&self) -> u64 { Scalar::sin_cos(*self).0.to_bits() } }
/// ```
#[derive(Debug, Clone, Copy, Default)]
pub struct Lanes(pub(crate) f64x8);

impl Lanes {
    /// Number of lanes.
    pub const COUNT: usize = 8;

    /// `√x`, lane by lane.
    #[must_use]
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        self.each(f64x8::sqrt)
    }

    /// `|x|`, lane by lane.
    #[must_use]
    #[inline(always)]
    pub fn abs(self) -> Self {
        self.each(f64x8::abs)
    }

    /// `eˣ`, lane by lane: the bits of `libm::exp`.
    #[must_use]
    #[inline(always)]
    pub fn exp(self) -> Self {
        if self.all_below(EXP_RANGE) {
            self.each(exp)
        } else {
            Self::from(<[f64; Self::COUNT]>::from(self).map(libm::exp))
        }
    }

    /// Returns true if `|x| < bound` in every lane; a NaN is not.
    #[inline(always)]
    pub fn all_below(self, bound: f64) -> bool {
        self.0.abs().simd_lt(f64x8::splat(bound)).all()
    }

    #[inline(always)]
    pub(crate) fn each(self, f: impl Fn(f64x8) -> f64x8) -> Self {
        Self(f(self.0))
    }

    #[inline(always)]
    pub(crate) fn with(self, other: Self, f: impl Fn(f64x8, f64x8) -> f64x8) -> Self {
        Self(f(self.0, other.0))
    }
}

impl From<[f64; Lanes::COUNT]> for Lanes {
    #[inline(always)]
    fn from(lanes: [f64; Self::COUNT]) -> Self {
        Self(f64x8::new(lanes))
    }
}

impl From<Lanes> for [f64; Lanes::COUNT] {
    #[inline(always)]
    fn from(lanes: Lanes) -> Self {
        lanes.0.to_array()
    }
}

macro_rules! lane_by_lane {
    ($operation:ident, $method:ident) => {
        impl $operation for Lanes {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.with(other, |a, b| a.$method(b))
            }
        }
    };
}

lane_by_lane!(Add, add);
lane_by_lane!(Sub, sub);
lane_by_lane!(Mul, mul);
lane_by_lane!(Div, div);

impl Neg for Lanes {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        let sign = f64x8::splat(-0.0);
        self.each(|x| x ^ sign)
    }
}

impl AddAssign for Lanes {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Lanes {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl Scalar for Lanes {
    type Four = Quad<Self>;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self(f64x8::splat(value))
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        // The bound of the code for one number is inside of its range: one number more.
        if self.all_below(REDUCIBLE) {
            let (sines, cosines) = sin_cos(self.0);
            (Self(sines), Self(cosines))
        } else {
            let both = <[f64; Self::COUNT]>::from(self).map(trig::sin_cos);
            (Self::from(both.map(|(sine, _)| sine)), Self::from(both.map(|(_, cosine)| cosine)))
        }
    }
}

/// As `trig::reduced`.
#[inline(always)]
fn sin_cos(angle: f64x8) -> (f64x8, f64x8) {
    let v = f64x8::splat;
    let rounded = angle * v(core::f64::consts::FRAC_2_PI) + v(ROUNDER);
    let k = rounded - v(ROUNDER);
    let quadrant: i64x8 = cast(rounded);
    let x = angle - k * v(HALF_PI[0]) - k * v(HALF_PI[1]) - k * v(HALF_PI[2]);
    let z = x * x;
    let sine = x + z * x * polynomial(z, &SIN);
    let tail = z * polynomial(z, &COS);
    let half = v(0.5) * z;
    let head = v(1.0) - half;
    let cosine = head + ((v(1.0) - head - half) + z * tail);
    let (one, two) = (i64x8::splat(1), i64x8::splat(2));
    let odd: f64x8 = cast(i64x8::splat(0) - (quadrant & one));
    let (s, c) = (odd.bitselect(cosine, sine), odd.bitselect(sine, cosine));
    let flips: f64x8 = cast((quadrant & two) << 62_u32);
    let turned: f64x8 = cast(((quadrant + one) & two) << 62_u32);
    (s ^ flips, c ^ turned)
}

/// As `trig::polynomial`.
#[inline(always)]
fn polynomial(z: f64x8, c: &[f64; 6]) -> f64x8 {
    let [c0, c1, c2, c3, c4, c5] = c.map(f64x8::splat);
    let z2 = z * z;
    (c0 + z * c1) + z2 * ((c2 + z * c3) + z2 * (c4 + z * c5))
}

/// Beyond it the exponential may lack digits.
const EXP_RANGE: f64 = 700.0;

const LN2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];
const EXP: [f64; 5] = [
    1.666_666_666_666_660_2e-1,
    -2.777_777_777_701_559_3e-3,
    6.613_756_321_437_934e-5,
    -1.653_390_220_546_525_2e-6,
    4.138_136_797_057_238_5e-8,
];

/// Limits between the branches of fdlibm's exponential, by the high word of `|x|`: 2⁻²⁸, ½ ln 2 and 1½ ln 2.
const TINY: f64 = f64::from_bits(0x3e30_0001 << 32);
const REDUCED: f64 = f64::from_bits(0x3fd6_2e43 << 32);
const ROUNDED: f64 = f64::from_bits(0x3ff0_a2b2 << 32);

/// As `libm::exp`, for `|x|` below [`EXP_RANGE`].
///
/// # References
///
/// K. C. Ng, fdlibm `e_exp.c`, Sun Microsystems 2004.
#[inline(always)]
fn exp(angle: f64x8) -> f64x8 {
    let v = f64x8::splat;
    let size = angle.abs();
    let whole = (v(core::f64::consts::LOG2_E) * size + v(0.5)).floor();
    let k = size.simd_ge(v(ROUNDED)).bitselect(whole, v(1.0));
    let k = k & size.simd_ge(v(REDUCED));
    let k = k | (angle & v(-0.0));
    let (high, low) = (angle - k * v(LN2[0]), k * v(LN2[1]));
    let x = high - low;
    let z = x * x;
    let [p1, p2, p3, p4, p5] = EXP.map(f64x8::splat);
    let c = x - z * (p1 + z * (p2 + z * (p3 + z * (p4 + z * p5))));
    let y = v(1.0) + (x * c / (v(2.0) - c) - low + high);
    // 2^k by its bits: the product is exact.
    let exponent: i64x8 = cast(k + v(ROUNDER));
    let bias: i64x8 = cast(v(ROUNDER));
    let power: f64x8 = cast((exponent - bias + i64x8::splat(1023)) << 52_u32);
    size.simd_lt(v(TINY)).bitselect(v(1.0) + angle, y * power)
}
