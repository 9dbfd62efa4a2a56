//! The number type of the dynamics, and four of it side by side.

use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use crate::trig;

/// Four scalars that one instruction works on, where the machine has such.
///
/// The dynamics do with `Four` what is the same for several joints. A type without vector
/// registers of its own uses [`Quad`](crate::Quad).
pub trait Four<S>:
    Copy + Default + core::fmt::Debug + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    /// `value` in every lane.
    fn splat(value: S) -> Self;

    /// From one value per lane.
    fn from_lanes(lanes: [S; 4]) -> Self;

    /// One value per lane.
    fn lanes(self) -> [S; 4];
}

/// A real number, or several side by side: what the dynamics compute with.
///
/// The algorithms never compare or branch on a `Scalar`, so a type that holds one value per SIMD
/// lane, one robot state per lane, is as good a `Scalar` as `f64`.
pub trait Scalar:
    Copy
    + Default
    + core::fmt::Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
{
    /// Four of these side by side.
    type Four: Four<Self>;

    /// The constant `value`, in every lane.
    fn splat(value: f64) -> Self;

    /// Sine and cosine of an angle \[rad\].
    fn sin_cos(self) -> (Self, Self);

    /// Sines and cosines of many angles at once; slices of one length.
    fn sin_cos_each(angles: &[Self], sines: &mut [Self], cosines: &mut [Self]) {
        for ((angle, sine), cosine) in angles.iter().zip(sines).zip(cosines) {
            (*sine, *cosine) = angle.sin_cos();
        }
    }

    /// These numbers as `f64`, if that is what they are: for code that is compiled for that type alone.
    #[doc(hidden)]
    fn as_f64(_numbers: &[Self]) -> Option<&[f64]> {
        None
    }

    /// The same, to be written to.
    #[doc(hidden)]
    fn as_f64_mut(_numbers: &mut [Self]) -> Option<&mut [f64]> {
        None
    }
}

impl Scalar for f64 {
    type Four = wide::f64x4;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        value
    }

    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        trig::sin_cos(self)
    }

    #[inline]
    fn sin_cos_each(angles: &[Self], sines: &mut [Self], cosines: &mut [Self]) {
        trig::sin_cos_each(angles, sines, cosines);
    }

    #[inline]
    fn as_f64(numbers: &[Self]) -> Option<&[f64]> {
        Some(numbers)
    }

    #[inline]
    fn as_f64_mut(numbers: &mut [Self]) -> Option<&mut [f64]> {
        Some(numbers)
    }
}

impl Scalar for f32 {
    type Four = wide::f32x4;

    #[inline(always)]
    #[allow(clippy::cast_possible_truncation, reason = "rounding to single precision is the point")]
    fn splat(value: f64) -> Self {
        value as f32
    }

    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = trig::sin_cos(f64::from(self));
        (Self::splat(sine), Self::splat(cosine))
    }
}
