//! Numbers of the geometry: reals, and reals with a bound on how far they may be off.

use core::ops::{Add, Mul, Neg, Sub};

pub(super) use super::ball::Ball;
use super::ball::{radius, sin_cos_of};

/// Number with which the geometry computes.
pub(super) trait TubeNumber:
    Copy + Default + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    fn exact(value: f64) -> Self;
    fn sin_cos(self) -> (Self, Self);
    /// Ball of its possible values.
    fn ball(self) -> Ball;
}

impl TubeNumber for f64 {
    fn ball(self) -> Ball {
        Ball::exact(self)
    }

    fn exact(value: f64) -> Self {
        value
    }

    fn sin_cos(self) -> (Self, Self) {
        libm::sincos(self)
    }
}

impl TubeNumber for Ball {
    fn ball(self) -> Ball {
        self
    }

    fn exact(value: f64) -> Self {
        Self::exact(value)
    }

    fn sin_cos(self) -> (Self, Self) {
        self.sin_cos()
    }
}

/// A function of up to `N` variables in `[−1, 1]`: its value and slopes at 0, and a bound on the rest.
///
/// Products of rotations make balls of balls: each takes the sizes of what it is given, and seven joints on the
/// first-order part is a hundred times too large. Here the first order is exact, but for rounding, which is in the
/// rest.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tangent<const N: usize> {
    m: f64,
    g: [f64; N],
    r: f64,
}

impl<const N: usize> Default for Tangent<N> {
    fn default() -> Self {
        Self { m: 0.0, g: [0.0; N], r: 0.0 }
    }
}

impl<const N: usize> Tangent<N> {
    /// The variable `k`, scaled to a ball.
    pub(super) fn variable(k: usize, ball: Ball) -> Self {
        let mut g = [0.0; N];
        g[k] = ball.r;
        Self { m: ball.m, g, r: 0.0 }
    }

    /// Anything in a ball.
    pub(super) fn rest(ball: Ball) -> Self {
        Self { m: ball.m, g: [0.0; N], r: ball.r }
    }

    fn spread(&self) -> f64 {
        self.g.iter().map(|g| g.abs()).sum()
    }
}

impl<const N: usize> Add for Tangent<N> {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        let g = core::array::from_fn(|k| self.g[k] + b.g[k]);
        let sum = Self { m: self.m + b.m, g, r: 0.0 };
        Self { r: radius(self.r + b.r, sum.m.abs() + sum.spread()), ..sum }
    }
}

impl<const N: usize> Sub for Tangent<N> {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        let g = core::array::from_fn(|k| self.g[k] - b.g[k]);
        let sum = Self { m: self.m - b.m, g, r: 0.0 };
        Self { r: radius(self.r + b.r, sum.m.abs() + sum.spread()), ..sum }
    }
}

impl<const N: usize> Neg for Tangent<N> {
    type Output = Self;
    fn neg(self) -> Self {
        Self { m: -self.m, g: self.g.map(|g| -g), r: self.r }
    }
}

impl<const N: usize> Mul for Tangent<N> {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        let g = core::array::from_fn(|k| self.m * b.g[k] + b.m * self.g[k]);
        let (p, q) = (self.spread(), b.spread());
        let (m, own, other) = (self.m * b.m, self.m.abs(), b.m.abs());
        let r = own * b.r + other * self.r + (p + self.r) * (q + b.r);
        // A slope is a sum of two products: three roundings.
        Self { m, g, r: radius(r, m.abs() + own * q + other * p) }
    }
}

impl<const N: usize> TubeNumber for Tangent<N> {
    fn exact(value: f64) -> Self {
        Self { m: value, ..Self::default() }
    }

    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = sin_cos_of(self.m);
        let (spread, bend) = (self.spread(), self.spread() + self.r);
        let of = |at: Ball, slope: Ball| {
            let r = at.r + slope.size() * self.r + slope.r * spread + 0.5 * bend * bend;
            let sizes = slope.m.abs() * spread;
            Self { m: at.m, g: self.g.map(|g| slope.m * g), r: radius(r, sizes) }
        };
        (of(s, c), of(c, -s))
    }

    fn ball(self) -> Ball {
        Ball { m: self.m, r: radius(self.spread() + self.r, 0.0) }
    }
}

pub(super) type Three<S> = [S; 3];

pub(super) fn dot<S: TubeNumber>(a: Three<S>, b: Three<S>) -> S {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross<S: TubeNumber>(a: Three<S>, b: Three<S>) -> Three<S> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(super) fn plus<S: TubeNumber>(a: Three<S>, b: Three<S>) -> Three<S> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(super) fn minus<S: TubeNumber>(a: Three<S>, b: Three<S>) -> Three<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(super) fn scale<S: TubeNumber>(a: Three<S>, s: S) -> Three<S> {
    [a[0] * s, a[1] * s, a[2] * s]
}

pub(super) fn exact<S: TubeNumber>(a: Three<f64>) -> Three<S> {
    a.map(S::exact)
}

/// Turn and shift: `x → r x + p`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shift<S> {
    pub(super) r: [Three<S>; 3],
    pub(super) p: Three<S>,
}

impl<S: TubeNumber> Shift<S> {
    pub(super) fn none() -> Self {
        let (o, i) = (S::exact(0.0), S::exact(1.0));
        Self { r: [[i, o, o], [o, i, o], [o, o, i]], p: [o, o, o] }
    }

    pub(super) fn turn(&self, v: Three<S>) -> Three<S> {
        [dot(self.r[0], v), dot(self.r[1], v), dot(self.r[2], v)]
    }

    pub(super) fn turn_back(&self, v: Three<S>) -> Three<S> {
        let column = |j: usize| [self.r[0][j], self.r[1][j], self.r[2][j]];
        [dot(column(0), v), dot(column(1), v), dot(column(2), v)]
    }

    /// This one after `inner`.
    pub(super) fn after(&self, inner: &Self) -> Self {
        let column = |j: usize| self.turn([inner.r[0][j], inner.r[1][j], inner.r[2][j]]);
        let (a, b, c) = (column(0), column(1), column(2));
        let r = core::array::from_fn(|i| [a[i], b[i], c[i]]);
        Self { r, p: plus(self.turn(inner.p), self.p) }
    }
}

/// Angular part and linear part at the world's origin: of a motion, or moment and force.
#[derive(Debug, Clone, Copy)]
pub(super) struct Screw<S> {
    pub(super) w: Three<S>,
    pub(super) v: Three<S>,
}

impl<S: TubeNumber> Screw<S> {
    pub(super) fn zero() -> Self {
        let o = [S::exact(0.0); 3];
        Self { w: o, v: o }
    }

    pub(super) fn plus(self, b: Self) -> Self {
        Self { w: plus(self.w, b.w), v: plus(self.v, b.v) }
    }

    pub(super) fn minus(self, b: Self) -> Self {
        Self { w: minus(self.w, b.w), v: minus(self.v, b.v) }
    }

    pub(super) fn times(self, s: S) -> Self {
        Self { w: scale(self.w, s), v: scale(self.v, s) }
    }

    /// Motion across motion.
    pub(super) fn cross(self, b: Self) -> Self {
        Self { w: cross(self.w, b.w), v: plus(cross(self.w, b.v), cross(self.v, b.w)) }
    }

    /// Motion across a wrench (moment in `w`, force in `v`).
    pub(super) fn cross_wrench(self, f: Self) -> Self {
        Self { w: plus(cross(self.w, f.w), cross(self.v, f.v)), v: cross(self.w, f.v) }
    }

    /// Power of a wrench on this motion.
    pub(super) fn power(self, f: Self) -> S {
        dot(self.w, f.w) + dot(self.v, f.v)
    }

    pub(super) fn moved(self, by: &Shift<S>) -> Self {
        let w = by.turn(self.w);
        Self { w, v: plus(by.turn(self.v), cross(by.p, w)) }
    }
}
