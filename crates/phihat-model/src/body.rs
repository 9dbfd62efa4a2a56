//! Rigid bodies as a description states them.

use crate::NotRigid;
use crate::placement::{Matrix3, Placement, add, apply, dot, mul, transpose};

/// A rigid body in some frame: mass, centre of mass, inertia about the centre of mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Mass \[kg\].
    pub mass: f64,
    /// Centre of mass \[m\].
    pub com: [f64; 3],
    /// Inertia about the centre of mass, axes of the frame, `xx, xy, xz, yy, yz, zz` \[kg·m²\].
    pub inertia: [f64; 6],
}

/// A principal moment so far below zero, relative to the trace, is one whose digits were cut; or so far \[kg·m²\].
const CUT_DIGITS: f64 = 1e-3;
const NOTHING: f64 = 1e-12;

/// Largest violation of a condition by a physical inertia through rounding, relative to its trace.
const ROUNDING: f64 = 1e-9;

impl Body {
    /// Says what no rigid body could have.
    pub(crate) fn check(&self) -> Result<(), NotRigid> {
        let Self { mass, com, inertia } = self;
        if !(mass.is_finite() && *mass >= 0.0) {
            return Err(NotRigid::Mass(*mass));
        }
        if com.iter().chain(inertia).any(|x| !x.is_finite()) {
            return Err(NotRigid::NotFinite);
        }
        let [xx, xy, xz, yy, yz, zz] = *inertia;
        let tiny = ROUNDING * (xx.abs() + yy.abs() + zz.abs());
        let minors = [xx * yy - xy * xy, xx * zz - xz * xz, yy * zz - yz * yz];
        let determinant = xx * minors[2] - xy * (xy * zz - xz * yz) + xz * (xy * yz - xz * yy);
        let definite = [xx, yy, zz].iter().all(|d| *d >= -tiny)
            && minors.iter().all(|m| *m >= -tiny * tiny)
            && determinant >= -tiny * tiny * tiny;
        if definite { Ok(()) } else { Err(NotRigid::Inertia(*inertia)) }
    }

    /// The same with all principal moments raised so far that none is negative, where one is by no more than
    /// digits that were cut; `None`: nothing is to be raised, or it is more than that.
    pub(crate) fn raised_if_rounded(&self) -> Option<Self> {
        let [xx, _, _, yy, _, zz] = self.inertia;
        let finite = self.inertia.iter().all(|x| x.is_finite());
        if !finite || !matches!(self.check(), Err(NotRigid::Inertia(_))) {
            return None;
        }
        let by = -1.01 * self.least_principal_moment();
        let [_, xy, xz, _, yz, _] = self.inertia;
        let raised = Self { inertia: [xx + by, xy, xz, yy + by, yz, zz + by], ..*self };
        (by <= CUT_DIGITS * (xx + yy + zz) + NOTHING && raised.check().is_ok()).then_some(raised)
    }

    /// The least eigenvalue of the inertia: the roots of its characteristic polynomial are `c + 2p cos(θ + 2πk/3)`.
    fn least_principal_moment(&self) -> f64 {
        let [xx, xy, xz, yy, yz, zz] = self.inertia;
        let c = (xx + yy + zz) / 3.0;
        let (a, b, d) = (xx - c, yy - c, zz - c);
        let p = ((a * a + b * b + d * d + 2.0 * (xy * xy + xz * xz + yz * yz)) / 6.0).sqrt();
        if p == 0.0 {
            return c;
        }
        let determinant = a * (b * d - yz * yz) - xy * (xy * d - yz * xz) + xz * (xy * yz - b * xz);
        let angle = libm::acos((0.5 * determinant / (p * p * p)).clamp(-1.0, 1.0)) / 3.0;
        c + 2.0 * p * libm::cos(angle + 2.0 * core::f64::consts::FRAC_PI_3)
    }

    /// Returns true if some mass distribution has this inertia: no principal moment above the sum of the
    /// other two, that is, `½ tr(I) 1 − I` positive semidefinite.
    pub(crate) fn obeys_triangle_inequality(&self) -> bool {
        let [xx, xy, xz, yy, yz, zz] = self.inertia;
        let half = 0.5 * (xx + yy + zz);
        let second = [half - xx, -xy, -xz, half - yy, -yz, half - zz];
        Self { inertia: second, ..*self }.check().is_ok()
    }

    pub(crate) fn lumped(&self) -> LumpedBody {
        let [xx, xy, xz, yy, yz, zz] = self.inertia;
        let about_com =
            LumpedBody { m: self.mass, h: [0.0; 3], i: [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]] };
        about_com.seen_from(&Placement { p: self.com, ..Placement::IDENTITY })
    }
}

/// Mass, first and second moments about a frame's origin, in its axes: these add up.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct LumpedBody {
    pub(crate) m: f64,
    /// Mass times centre of mass \[kg·m\].
    pub(crate) h: [f64; 3],
    /// Inertia about the origin \[kg·m²\].
    pub(crate) i: Matrix3,
}

impl LumpedBody {
    /// The same matter, in a frame in which this one is placed at `at`.
    pub(crate) fn seen_from(&self, at: &Placement) -> Self {
        let h = apply(&at.r, self.h);
        let i = mul(&mul(&at.r, &self.i), &transpose(&at.r));
        let (p, m) = (at.p, self.m);
        let diagonal = 2.0 * dot(p, h) + m * dot(p, p);
        let shifted = |a: usize, b: usize| {
            let off = p[a] * h[b] + h[a] * p[b] + m * p[a] * p[b];
            i[a][b] - off + if a == b { diagonal } else { 0.0 }
        };
        let i = core::array::from_fn(|a| core::array::from_fn(|b| shifted(a.min(b), a.max(b))));
        Self { m, h: add(h, p.map(|x| m * x)), i }
    }

    pub(crate) fn plus(&self, other: &Self) -> Self {
        let i = core::array::from_fn(|a| core::array::from_fn(|b| self.i[a][b] + other.i[a][b]));
        Self { m: self.m + other.m, h: add(self.h, other.h), i }
    }

    pub(crate) fn times(&self, factor: f64) -> Self {
        let scale = |v: [f64; 3]| v.map(|x| factor * x);
        Self { m: factor * self.m, h: scale(self.h), i: self.i.map(scale) }
    }

    /// The ten dynamic parameters, in the regressor's order.
    pub(crate) fn parameters(&self) -> [f64; 10] {
        let ([hx, hy, hz], i) = (self.h, &self.i);
        [self.m, hx, hy, hz, i[0][0], i[0][1], i[1][1], i[0][2], i[1][2], i[2][2]]
    }
}

#[cfg(test)]
mod tests {
    use super::Body;
    use crate::placement::{from_rpy, mul, transpose};

    #[test]
    fn inertia_is_raised_by_what_its_least_moment_lacks() {
        let r = from_rpy([0.3, -0.7, 1.1]);
        let body = |moments: [f64; 3]| {
            let [a, b, c] = moments;
            let turned =
                mul(&mul(&r, &[[a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]]), &transpose(&r));
            let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = turned;
            Body { mass: 1.0, com: [0.0; 3], inertia: [xx, xy, xz, yy, yz, zz] }
        };
        for (moments, least) in
            [([0.2, 0.1, -1e-5], -1e-5), ([0.4, -3e-4, 0.3], -3e-4), ([2.0, 2.0, -1e-4], -1e-4)]
        {
            let (before, after) = (body(moments), body(moments).raised_if_rounded().unwrap());
            assert!((before.least_principal_moment() - least).abs() < 1e-12);
            assert!(after.check().is_ok());
            assert!((after.inertia[0] - before.inertia[0] + 1.01 * least).abs() < 1e-12);
        }
        // What nobody rounded is refused, and what is right is left.
        assert!(body([0.2, 0.1, -0.01]).raised_if_rounded().is_none());
        assert!(body([0.2, 0.1, 0.05]).raised_if_rounded().is_none());
    }
}
