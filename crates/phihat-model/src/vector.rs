//! Three-vectors, and the planar rotations the recursions are made of.

use core::ops::{Add, AddAssign, Neg, Sub};

use crate::Scalar;

/// A vector in some frame's axes.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Vec3<S> {
    pub(crate) x: S,
    pub(crate) y: S,
    pub(crate) z: S,
}

/// Cosine and sine of a rotation about a coordinate axis.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Turn<S> {
    pub(crate) c: S,
    pub(crate) s: S,
}

impl<S: Scalar> Vec3<S> {
    #[inline(always)]
    pub(crate) fn new(x: S, y: S, z: S) -> Self {
        Self { x, y, z }
    }

    #[inline(always)]
    pub(crate) fn zero() -> Self {
        Self::splat([0.0; 3])
    }

    #[inline(always)]
    pub(crate) fn splat([x, y, z]: [f64; 3]) -> Self {
        Self::new(S::splat(x), S::splat(y), S::splat(z))
    }

    #[inline(always)]
    pub(crate) fn array(self) -> [S; 3] {
        [self.x, self.y, self.z]
    }

    #[inline(always)]
    pub(crate) fn dot(self, b: Self) -> S {
        self.x * b.x + self.y * b.y + self.z * b.z
    }

    #[inline(always)]
    pub(crate) fn cross(self, b: Self) -> Self {
        Self::new(
            self.y * b.z - self.z * b.y,
            self.z * b.x - self.x * b.z,
            self.x * b.y - self.y * b.x,
        )
    }

    #[inline(always)]
    pub(crate) fn scale(self, k: S) -> Self {
        Self::new(k * self.x, k * self.y, k * self.z)
    }
}

impl<S: Scalar> Turn<S> {
    /// `Rx v`: from the turned axes to those before the turn.
    #[inline(always)]
    pub(crate) fn out_x(self, v: Vec3<S>) -> Vec3<S> {
        Vec3::new(v.x, self.c * v.y - self.s * v.z, self.s * v.y + self.c * v.z)
    }

    /// `Rxᵀ v`: into the turned axes.
    #[inline(always)]
    pub(crate) fn into_x(self, v: Vec3<S>) -> Vec3<S> {
        Vec3::new(v.x, self.c * v.y + self.s * v.z, self.c * v.z - self.s * v.y)
    }

    /// `Rz v`: from the turned axes to those before the turn.
    #[inline(always)]
    pub(crate) fn out_z(self, v: Vec3<S>) -> Vec3<S> {
        Vec3::new(self.c * v.x - self.s * v.y, self.s * v.x + self.c * v.y, v.z)
    }

    /// `Rzᵀ v`: into the turned axes.
    #[inline(always)]
    pub(crate) fn into_z(self, v: Vec3<S>) -> Vec3<S> {
        Vec3::new(self.c * v.x + self.s * v.y, self.c * v.y - self.s * v.x, v.z)
    }
}

impl<S: Scalar> Add for Vec3<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self::new(self.x + b.x, self.y + b.y, self.z + b.z)
    }
}

impl<S: Scalar> Sub for Vec3<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self::new(self.x - b.x, self.y - b.y, self.z - b.z)
    }
}

impl<S: Scalar> Neg for Vec3<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

impl<S: Scalar> AddAssign for Vec3<S> {
    #[inline(always)]
    fn add_assign(&mut self, b: Self) {
        *self = *self + b;
    }
}
