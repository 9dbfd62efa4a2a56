//! One segment of many arms: numbers in lanes, structure shared.

use crate::description::Motion;
use crate::inertia::Inertia;
use crate::segment::Segment;
use crate::vector::{Turn, Vec3};
use crate::{Lanes, Model, Scalar};

/// How the first screw turns, where it is the same for all arms.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Tilt {
    /// Not at all.
    Level,
    /// By a quarter turn.
    Up,
    /// By a quarter turn the other way.
    Down,
    /// By some angle.
    Any,
}

/// One segment of every arm.
#[derive(Debug, Clone)]
pub(super) struct Part {
    pub(super) motion: Motion,
    /// The first coordinate of this segment and all that hangs on it.
    pub(super) first: usize,
    tilt: Tilt,
    turn: Turn<Lanes>,
    /// `a`, and whether any arm has one.
    pub(super) a: Lanes,
    pub(super) reaches: bool,
    /// `d` and `θ₀`, and whether any arm has a `d`.
    pub(super) d: Lanes,
    pub(super) slides: bool,
    pub(super) theta: Lanes,
    pub(super) armature: Lanes,
    pub(super) matter: Inertia<Lanes>,
    pub(super) sigma: [Lanes; 6],
}

impl Part {
    /// Segment number `i` of arms of one structure; where there are fewer arms than lanes, the last one fills the rest.
    pub(super) fn of(models: &[&Model], i: usize) -> Option<Self> {
        let own = models.first()?.segments().get(i)?;
        let all = |same: &dyn Fn(&Segment) -> bool| {
            models.iter().all(|model| model.segments().get(i).is_some_and(same))
        };
        let lanes = |of: &dyn Fn(&Segment) -> f64| {
            in_lanes(models, |model| model.segments().get(i).map_or(0.0, of))
        };
        let turned = |cos: f64, sin: f64| {
            all(&|s| {
                (s.cos_alpha.to_bits(), s.sin_alpha.to_bits()) == (cos.to_bits(), sin.to_bits())
            })
        };
        let tilt = match () {
            () if turned(1.0, 0.0) => Tilt::Level,
            () if turned(0.0, 1.0) => Tilt::Up,
            () if turned(0.0, -1.0) => Tilt::Down,
            () => Tilt::Any,
        };
        let joint = own.joint;
        let armature = |model: &Model| match own.motion {
            Motion::Fixed => 0.0,
            _ => model.armature().get(joint).copied().unwrap_or(0.0),
        };
        Some(Self {
            motion: own.motion,
            first: own.coordinates.0,
            tilt,
            turn: Turn { c: lanes(&|s| s.cos_alpha), s: lanes(&|s| s.sin_alpha) },
            a: lanes(&|s| s.a),
            reaches: !all(&|s| s.a.abs() <= 0.0),
            d: lanes(&|s| s.d),
            slides: own.motion == Motion::Prismatic || !all(&|s| s.d.abs() <= 0.0),
            theta: in_lanes(models, |model| model.compiled().theta.get(i).copied().unwrap_or(0.0)),
            armature: in_lanes(models, armature),
            matter: Inertia {
                m: lanes(&|s| s.m),
                h: Vec3::new(lanes(&|s| s.h[0]), lanes(&|s| s.h[1]), lanes(&|s| s.h[2])),
                xx: lanes(&|s| s.i[0]),
                yy: lanes(&|s| s.i[1]),
                zz: lanes(&|s| s.i[2]),
                xy: lanes(&|s| s.i[3]),
                xz: lanes(&|s| s.i[4]),
                yz: lanes(&|s| s.i[5]),
            },
            sigma: core::array::from_fn(|k| lanes(&|s| s.sigma[k])),
        })
    }

    /// `Rx v`: from the tilted axes to those before.
    #[inline(always)]
    pub(super) fn tilt_out(&self, v: Vec3<Lanes>) -> Vec3<Lanes> {
        match self.tilt {
            Tilt::Level => v,
            Tilt::Up => Vec3::new(v.x, -v.z, v.y),
            Tilt::Down => Vec3::new(v.x, v.z, -v.y),
            Tilt::Any => self.turn.out_x(v),
        }
    }

    /// `Rxᵀ v`: into the tilted axes.
    #[inline(always)]
    pub(super) fn tilt_in(&self, v: Vec3<Lanes>) -> Vec3<Lanes> {
        match self.tilt {
            Tilt::Level => v,
            Tilt::Up => Vec3::new(v.x, v.z, -v.y),
            Tilt::Down => Vec3::new(v.x, -v.z, v.y),
            Tilt::Any => self.turn.into_x(v),
        }
    }

    /// `inertia` seen from the frame before `Rx Tx(a)`.
    #[inline(always)]
    pub(super) fn inertia_out_x(&self, inertia: &Inertia<Lanes>) -> Inertia<Lanes> {
        let Inertia { m, h, xx, yy, zz, xy, xz, yz } = *inertia;
        let (yy, zz, yz, xy, xz) = match self.tilt {
            Tilt::Level => (yy, zz, yz, xy, xz),
            Tilt::Up => (zz, yy, -yz, -xz, xy),
            Tilt::Down => (zz, yy, -yz, xz, -xy),
            Tilt::Any => return inertia.out_x((self.turn, self.a)),
        };
        let h = self.tilt_out(h);
        if !self.reaches {
            return Inertia { m, h, xx, yy, zz, xy, xz, yz };
        }
        let a = self.a;
        let am = a * m;
        let k = a * (h.x + h.x + am);
        Inertia {
            m,
            h: Vec3::new(h.x + am, h.y, h.z),
            xx,
            yy: yy + k,
            zz: zz + k,
            xy: xy - a * h.y,
            xz: xz - a * h.z,
            yz,
        }
    }
}

/// One number of every arm; the last one fills up.
pub(super) fn in_lanes(models: &[&Model], of: impl Fn(&Model) -> f64) -> Lanes {
    let at = |k: usize| models.get(k).or(models.last()).map_or(0.0, |model| of(model));
    Lanes::from(core::array::from_fn(at))
}

/// The constant in every lane.
#[inline(always)]
pub(super) fn zero() -> Lanes {
    Lanes::splat(0.0)
}
