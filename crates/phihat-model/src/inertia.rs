//! Composite inertia: mass and moments of a rigid collection of bodies, moved between frames.

use crate::Scalar;
use crate::segment::Segment;
use crate::vector::{Turn, Vec3};

/// Mass, first moment and inertia about a frame's origin, in its axes.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct LinkInertia<S> {
    pub(crate) m: S,
    pub(crate) h: Vec3<S>,
    pub(crate) xx: S,
    pub(crate) yy: S,
    pub(crate) zz: S,
    pub(crate) xy: S,
    pub(crate) xz: S,
    pub(crate) yz: S,
}

impl<S: Scalar> LinkInertia<S> {
    #[inline(always)]
    pub(crate) fn of(segment: &Segment) -> Self {
        let [xx, yy, zz, xy, xz, yz] = segment.i.map(S::splat);
        Self { m: S::splat(segment.m), h: Vec3::splat(segment.h), xx, yy, zz, xy, xz, yz }
    }

    #[inline(always)]
    pub(crate) fn plus(&self, b: &Self) -> Self {
        Self {
            m: self.m + b.m,
            h: self.h + b.h,
            xx: self.xx + b.xx,
            yy: self.yy + b.yy,
            zz: self.zz + b.zz,
            xy: self.xy + b.xy,
            xz: self.xz + b.xz,
            yz: self.yz + b.yz,
        }
    }

    /// Seen from the frame before `Rz Tz(d)`.
    #[inline(always)]
    pub(crate) fn out_z(&self, (turn, d): (Turn<S>, S)) -> Self {
        let h = turn.out_z(self.h);
        let dm = d * self.m;
        let k = d * (h.z + h.z + dm);
        let (xx, xy, yy) = turn_block(turn, (self.xx, self.xy, self.yy), k);
        let (c, s) = (turn.c, turn.s);
        Self {
            m: self.m,
            h: Vec3::new(h.x, h.y, h.z + dm),
            xx,
            yy,
            zz: self.zz,
            xy,
            xz: c * self.xz - s * self.yz - d * h.x,
            yz: s * self.xz + c * self.yz - d * h.y,
        }
    }

    /// Seen from the frame before `Rx Tx(a)`.
    #[inline(always)]
    pub(crate) fn out_x(&self, (turn, a): (Turn<S>, S)) -> Self {
        let h = turn.out_x(self.h);
        let am = a * self.m;
        let k = a * (h.x + h.x + am);
        let (yy, yz, zz) = turn_block(turn, (self.yy, self.yz, self.zz), k);
        let (c, s) = (turn.c, turn.s);
        Self {
            m: self.m,
            h: Vec3::new(h.x + am, h.y, h.z),
            xx: self.xx,
            yy,
            zz,
            xy: c * self.xy - s * self.xz - a * h.y,
            xz: s * self.xy + c * self.xz - a * h.z,
            yz,
        }
    }
}

/// `R B Rᵀ + k 1` for the symmetric 2 × 2 block `B = [[p, o], [o, q]]` in the plane of the turn.
///
/// More products than need be, in exchange for a short way from `p, o, q` to the result: the sweep
/// waits for it.
#[inline(always)]
fn turn_block<S: Scalar>(turn: Turn<S>, (p, o, q): (S, S, S), k: S) -> (S, S, S) {
    let (cc, ss, cs) = (turn.c * turn.c, turn.s * turn.s, turn.c * turn.s);
    let across = (cs + cs) * o;
    let p_out = (cc * p + ss * q) + (k - across);
    let q_out = (ss * p + cc * q) + (k + across);
    (p_out, cs * (p - q) + (cc - ss) * o, q_out)
}
