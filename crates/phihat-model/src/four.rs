//! Vectors of four scalars: those of the machine, and four of any scalar.

use core::ops::{Add, Mul, Sub};

use crate::{Four, Scalar};

/// Four of any [`Scalar`], one after the other.
#[derive(Debug, Clone, Copy, Default)]
pub struct Quad<S>(pub [S; 4]);

macro_rules! impl_vector {
    ($vector:ty, $scalar:ty) => {
        impl Four<$scalar> for $vector {
            #[inline(always)]
            fn splat(value: $scalar) -> Self {
                Self::splat(value)
            }

            #[inline(always)]
            fn from_lanes(lanes: [$scalar; 4]) -> Self {
                Self::new(lanes)
            }

            #[inline(always)]
            fn lanes(self) -> [$scalar; 4] {
                self.to_array()
            }
        }
    };
}

impl_vector!(wide::f64x4, f64);
impl_vector!(wide::f32x4, f32);

impl<S: Scalar> Four<S> for Quad<S> {
    #[inline(always)]
    fn splat(value: S) -> Self {
        Self([value; 4])
    }

    #[inline(always)]
    fn from_lanes(lanes: [S; 4]) -> Self {
        Self(lanes)
    }

    #[inline(always)]
    fn lanes(self) -> [S; 4] {
        self.0
    }
}

macro_rules! impl_lane_by_lane {
    ($operation:ident, $method:ident) => {
        impl<S: Scalar> $operation for Quad<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, b: Self) -> Self {
                Self(core::array::from_fn(|k| self.0[k].$method(b.0[k])))
            }
        }
    };
}

impl_lane_by_lane!(Add, add);
impl_lane_by_lane!(Sub, sub);
impl_lane_by_lane!(Mul, mul);
