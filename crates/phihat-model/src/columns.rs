//! Wrenches in columns, four side by side, moved between frames by one pair of screws.

use crate::description::JointMotion;
use crate::inertia::LinkInertia;
use crate::segment::Segment;
use crate::vector::{Turn, Vec3};
use crate::{Four, Scalar};

/// Columns that travel together: as many as fill a vector register.
pub(crate) const LANES: usize = 4;

/// Forces and moments of [`LANES`] columns, one vector per coordinate.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Columns<S: Scalar> {
    fx: S::Four,
    fy: S::Four,
    fz: S::Four,
    nx: S::Four,
    ny: S::Four,
    nz: S::Four,
}

/// A force and a moment.
pub(crate) type Wrench<S> = (Vec3<S>, Vec3<S>);

/// Both screws of a segment, with every constant in all lanes.
#[derive(Clone, Copy)]
pub(crate) struct Screws4<S: Scalar> {
    tilt: Turn<S::Four>,
    a: S::Four,
    turn: Turn<S::Four>,
    d: S::Four,
}

impl<S: Scalar> Screws4<S> {
    #[inline(always)]
    pub(crate) fn new((tilt, a): (Turn<S>, S), (turn, d): (Turn<S>, S)) -> Self {
        let four = S::Four::splat;
        Self {
            tilt: Turn { c: four(tilt.c), s: four(tilt.s) },
            a: four(a),
            turn: Turn { c: four(turn.c), s: four(turn.s) },
            d: four(d),
        }
    }
}

impl<S: Scalar> Columns<S> {
    /// Adds `wrench` to one lane.
    ///
    /// By a product with a unit vector: a scalar store would stall the vector load that follows.
    #[inline(always)]
    pub(crate) fn add(&mut self, lane: usize, (force, moment): Wrench<S>) {
        let unit = unit::<S>(lane);
        let along = |value: S| unit * S::Four::splat(value);
        self.fx = self.fx + along(force.x);
        self.fy = self.fy + along(force.y);
        self.fz = self.fz + along(force.z);
        self.nx = self.nx + along(moment.x);
        self.ny = self.ny + along(moment.y);
        self.nz = self.nz + along(moment.z);
    }

    /// Takes one lane out, leaving 0.
    pub(crate) fn take(&mut self, lane: usize) -> Wrench<S> {
        let of = |four: S::Four| four.lanes()[lane % LANES];
        let force = Vec3::new(of(self.fx), of(self.fy), of(self.fz));
        let moment = Vec3::new(of(self.nx), of(self.ny), of(self.nz));
        self.add(lane, (-force, -moment));
        (force, moment)
    }

    /// These columns in the lanes where `here` is 1, `others` where it is 0.
    pub(crate) fn or(&self, here: S::Four, others: &Self) -> Self {
        let there = S::Four::splat(S::splat(1.0)) - here;
        let mix = |a: S::Four, b: S::Four| here * a + there * b;
        Self {
            fx: mix(self.fx, others.fx),
            fy: mix(self.fy, others.fy),
            fz: mix(self.fz, others.fz),
            nx: mix(self.nx, others.nx),
            ny: mix(self.ny, others.ny),
            nz: mix(self.nz, others.nz),
        }
    }

    /// All lanes in the frame before `Rx Tx(a) Rz Tz(d)`.
    #[inline(always)]
    pub(crate) fn out(&self, Screws4 { tilt, a, turn, d }: Screws4<S>) -> Self {
        let Self { fx, fy, fz, nx, ny, nz } = *self;
        let (nx, ny) = (nx - d * fy, ny + d * fx);
        let (fx, fy) = (turn.c * fx - turn.s * fy, turn.s * fx + turn.c * fy);
        let (nx, ny) = (turn.c * nx - turn.s * ny, turn.s * nx + turn.c * ny);
        let (fy, fz) = (tilt.c * fy - tilt.s * fz, tilt.s * fy + tilt.c * fz);
        let (ny, nz) = (tilt.c * ny - tilt.s * nz, tilt.s * ny + tilt.c * nz);
        Self { fx, fy, fz, nx, ny: ny - a * fz, nz: nz + a * fy }
    }

    /// Force or moment of each column along the joint of `segment`.
    #[inline(always)]
    pub(crate) fn along(&self, segment: &Segment) -> S::Four {
        match segment.motion {
            JointMotion::Prismatic => self.fz,
            _ => self.nz,
        }
    }
}

/// 1 in `lane`, counted within its vector, 0 elsewhere.
#[inline(always)]
fn unit<S: Scalar>(lane: usize) -> S::Four {
    const UNITS: [[f64; LANES]; LANES] =
        [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    S::Four::from_lanes(UNITS[lane % LANES].map(S::splat))
}

/// 1 in the lanes of vector number `chunk` that `inside` names, 0 elsewhere.
pub(crate) fn mask<S: Scalar>(chunk: usize, inside: impl Fn(usize) -> bool) -> S::Four {
    S::Four::from_lanes(core::array::from_fn(|k| {
        S::splat(f64::from(u8::from(inside(LANES * chunk + k))))
    }))
}

/// The wrench that accelerates `inertia` at unit rate along the joint of `segment`.
#[inline(always)]
pub(crate) fn unit_wrench<S: Scalar>(segment: &Segment, inertia: &LinkInertia<S>) -> Wrench<S> {
    let (h, zero) = (inertia.h, S::splat(0.0));
    match segment.motion {
        JointMotion::Prismatic => (Vec3::new(zero, zero, inertia.m), Vec3::new(h.y, -h.x, zero)),
        _ => (Vec3::new(-h.y, h.x, zero), Vec3::new(inertia.xz, inertia.yz, inertia.zz)),
    }
}
