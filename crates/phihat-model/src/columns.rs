//! Wrenches in columns: `L` of them moved between frames by one pair of screws.

use crate::Scalar;
use crate::compile::Segment;
use crate::description::Motion;
use crate::inertia::Inertia;
use crate::vector::{Turn, Vec3};

/// `L` forces and moments, one array per coordinate so that the lanes fill vector registers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Columns<S, const L: usize> {
    pub(crate) fx: [S; L],
    pub(crate) fy: [S; L],
    pub(crate) fz: [S; L],
    pub(crate) nx: [S; L],
    pub(crate) ny: [S; L],
    pub(crate) nz: [S; L],
}

impl<S: Scalar, const L: usize> Columns<S, L> {
    #[inline(always)]
    pub(crate) fn zero() -> Self {
        let z = [S::splat(0.0); L];
        Self { fx: z, fy: z, fz: z, nx: z, ny: z, nz: z }
    }

    /// Writes one column.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, force: Vec3<S>, moment: Vec3<S>) {
        // A blend of whole vectors: a scalar store here would stall the vector load that follows.
        for k in 0..L {
            let here = k == lane;
            self.fx[k] = if here { force.x } else { self.fx[k] };
            self.fy[k] = if here { force.y } else { self.fy[k] };
            self.fz[k] = if here { force.z } else { self.fz[k] };
            self.nx[k] = if here { moment.x } else { self.nx[k] };
            self.ny[k] = if here { moment.y } else { self.ny[k] };
            self.nz[k] = if here { moment.z } else { self.nz[k] };
        }
    }

    /// Reads one column.
    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> (Vec3<S>, Vec3<S>) {
        let force = Vec3::new(self.fx[lane], self.fy[lane], self.fz[lane]);
        (force, Vec3::new(self.nx[lane], self.ny[lane], self.nz[lane]))
    }

    /// Moves all columns to the frame before `Rx Tx(a) Rz Tz(d)`.
    #[inline(always)]
    pub(crate) fn out(&mut self, tilt: Turn<S>, a: S, turn: Turn<S>, d: S) {
        for k in 0..L {
            self.out_one(k, tilt, a, turn, d);
        }
    }

    /// Moves one column to the frame before `Rx Tx(a) Rz Tz(d)`.
    #[inline(always)]
    pub(crate) fn out_one(&mut self, lane: usize, tilt: Turn<S>, a: S, turn: Turn<S>, d: S) {
        let (f, n) = self.get(lane);
        let (fx, fy) = (turn.c * f.x - turn.s * f.y, turn.s * f.x + turn.c * f.y);
        let (nx, ny) = (n.x - d * f.y, n.y + d * f.x);
        let (nx, ny) = (turn.c * nx - turn.s * ny, turn.s * nx + turn.c * ny);
        let (fy, fz) = (tilt.c * fy - tilt.s * f.z, tilt.s * fy + tilt.c * f.z);
        let (ny, nz) = (tilt.c * ny - tilt.s * n.z, tilt.s * ny + tilt.c * n.z);
        self.fx[lane] = fx;
        self.fy[lane] = fy;
        self.fz[lane] = fz;
        self.nx[lane] = nx;
        self.ny[lane] = ny - a * fz;
        self.nz[lane] = nz + a * fy;
    }

    /// What each column does along the joint of `segment`.
    #[inline(always)]
    pub(crate) fn along(&self, segment: &Segment) -> &[S; L] {
        match segment.motion {
            Motion::Prismatic => &self.fz,
            _ => &self.nz,
        }
    }
}

/// The wrench that accelerates `inertia` at unit rate along the joint of `segment`.
#[inline(always)]
pub(crate) fn unit_wrench<S: Scalar>(
    segment: &Segment,
    inertia: &Inertia<S>,
) -> (Vec3<S>, Vec3<S>) {
    let (h, zero) = (inertia.h, S::splat(0.0));
    match segment.motion {
        Motion::Prismatic => (Vec3::new(zero, zero, inertia.m), Vec3::new(h.y, -h.x, zero)),
        _ => (Vec3::new(-h.y, h.x, zero), Vec3::new(inertia.xz, inertia.yz, inertia.zz)),
    }
}
