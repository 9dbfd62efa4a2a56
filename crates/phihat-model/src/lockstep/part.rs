//! One segment of many arms: numbers in lanes, structure shared.

use crate::description::JointMotion;
use crate::inertia::LinkInertia;
use crate::segment::Segment;
use crate::shape::{SegmentShape, Tilt};
use crate::vector::{Turn, Vec3};
use crate::{Lanes, Model, Scalar};

/// One segment of every arm.
#[derive(Debug, Clone)]
pub(crate) struct LockstepSegment<S> {
    pub(crate) motion: JointMotion,
    /// The first coordinate of this segment and all that hangs on it.
    pub(crate) first: usize,
    pub(crate) shape: SegmentShape,
    pub(crate) turn: Turn<S>,
    pub(crate) a: S,
    pub(crate) d: S,
    pub(crate) theta: S,
    pub(crate) armature: S,
    pub(crate) matter: LinkInertia<S>,
    pub(crate) sigma: [S; 6],
}

impl LockstepSegment<Lanes> {
    /// Segment number `i` of arms of one structure; where there are fewer arms than lanes, the last one fills the rest.
    pub(crate) fn of(models: &[&Model], i: usize) -> Option<Self> {
        let own = models.first()?.segments().get(i)?;
        let segments: Vec<&Segment> =
            models.iter().filter_map(|model| model.segments().get(i)).collect();
        let lanes = |of: &dyn Fn(&Segment) -> f64| {
            in_lanes(models, |model| model.segments().get(i).map_or(0.0, of))
        };
        let joint = own.joint;
        let armature = |model: &Model| match own.motion {
            JointMotion::Fixed => 0.0,
            _ => model.armature().get(joint).copied().unwrap_or(0.0),
        };
        Some(Self {
            motion: own.motion,
            first: own.coordinates.0,
            shape: SegmentShape::shared(&segments),
            turn: Turn { c: lanes(&|s| s.cos_alpha), s: lanes(&|s| s.sin_alpha) },
            a: lanes(&|s| s.a),
            d: lanes(&|s| s.d),
            theta: in_lanes(models, |model| model.compiled().theta.get(i).copied().unwrap_or(0.0)),
            armature: in_lanes(models, armature),
            matter: LinkInertia {
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
}

impl<S: Scalar> LockstepSegment<S> {
    /// `Rx v`: from the tilted axes to those before.
    #[inline(always)]
    pub(crate) fn tilt_out(&self, v: Vec3<S>) -> Vec3<S> {
        match self.shape.tilt {
            Tilt::Level => v,
            Tilt::Up => Vec3::new(v.x, -v.z, v.y),
            Tilt::Down => Vec3::new(v.x, v.z, -v.y),
            Tilt::Any => self.turn.out_x(v),
        }
    }

    /// `Rxᵀ v`: into the tilted axes.
    #[inline(always)]
    pub(crate) fn tilt_in(&self, v: Vec3<S>) -> Vec3<S> {
        match self.shape.tilt {
            Tilt::Level => v,
            Tilt::Up => Vec3::new(v.x, v.z, -v.y),
            Tilt::Down => Vec3::new(v.x, -v.z, v.y),
            Tilt::Any => self.turn.into_x(v),
        }
    }

    /// `inertia` seen from the frame before `Rx Tx(a)`.
    #[inline(always)]
    pub(crate) fn inertia_out_x(&self, inertia: &LinkInertia<S>) -> LinkInertia<S> {
        let LinkInertia { m, h, xx, yy, zz, xy, xz, yz } = *inertia;
        let (yy, zz, yz, xy, xz) = match self.shape.tilt {
            Tilt::Level => (yy, zz, yz, xy, xz),
            Tilt::Up => (zz, yy, -yz, -xz, xy),
            Tilt::Down => (zz, yy, -yz, xz, -xy),
            Tilt::Any => return inertia.out_x((self.turn, self.a)),
        };
        let h = self.tilt_out(h);
        if !self.shape.reaches {
            return LinkInertia { m, h, xx, yy, zz, xy, xz, yz };
        }
        let a = self.a;
        let am = a * m;
        let k = a * (h.x + h.x + am);
        LinkInertia {
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
pub(crate) fn in_lanes(models: &[&Model], of: impl Fn(&Model) -> f64) -> Lanes {
    let at = |k: usize| models.get(k).or(models.last()).map_or(0.0, |model| of(model));
    Lanes::from(core::array::from_fn(at))
}
