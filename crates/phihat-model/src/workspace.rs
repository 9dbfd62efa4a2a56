//! Scratch memory of the dynamics, allocated once.

use crate::description::Motion;
use crate::inertia::Inertia;
use crate::vector::{Turn, Vec3};
use crate::{Model, Scalar};

/// Preallocated scratch of one [`Model`], one per thread.
///
/// Nothing in it outlives a call, but for the poses that
/// [`forward_kinematics`](Model::forward_kinematics) leaves for [`pose`](Model::pose).
#[derive(Debug, Clone)]
pub struct Workspace<S = f64> {
    pub(crate) segments: Vec<Node<S>>,
    angles: Vec<S>,
    sines: Vec<S>,
    cosines: Vec<S>,
}

/// What the recursions keep per segment.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Node<S> {
    /// The joint's own screw: rotation about z and shift along z.
    pub(crate) turn: Turn<S>,
    pub(crate) d: S,
    pub(crate) motion: Spin<S>,
    pub(crate) force: Vec3<S>,
    pub(crate) moment: Vec3<S>,
    pub(crate) inertia: Inertia<S>,
    pub(crate) pose: Pose3<S>,
}

/// Angular velocity, angular acceleration and linear acceleration of a frame, in its axes.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Spin<S> {
    pub(crate) omega: Vec3<S>,
    pub(crate) alpha: Vec3<S>,
    pub(crate) acc: Vec3<S>,
}

/// Axes of a frame and its origin, in base axes.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Pose3<S> {
    pub(crate) x: Vec3<S>,
    pub(crate) y: Vec3<S>,
    pub(crate) z: Vec3<S>,
    pub(crate) p: Vec3<S>,
}

/// Angles come in whole vectors of this many lanes.
const LANES: usize = 4;

impl<S: Scalar> Workspace<S> {
    /// Scratch for `model`.
    pub fn new(model: &Model) -> Self {
        let segments = model.segments().len();
        let zeros = |count| vec![S::splat(0.0); count];
        let padded = segments.next_multiple_of(LANES);
        let mut angles = zeros(padded);
        for (angle, segment) in angles.iter_mut().zip(model.segments()) {
            *angle = S::splat(segment.theta);
        }
        Self {
            segments: vec![Node::default(); segments],
            angles,
            sines: zeros(padded),
            cosines: zeros(padded),
        }
    }
}

impl Model {
    /// Fills in every joint's screw at `q`.
    #[inline(always)]
    pub(crate) fn place<S: Scalar>(&self, ws: &mut Workspace<S>, q: &[S]) {
        let segments = self.segments();
        let Workspace { segments: nodes, angles, sines, cosines, .. } = ws;
        assert!(q.len() == self.joint_count(), "one position per joint");
        assert!(nodes.len() == segments.len(), "a workspace of this model");
        for ((segment, node), angle) in segments.iter().zip(nodes.iter_mut()).zip(&mut *angles) {
            node.d = S::splat(segment.d);
            match segment.motion {
                Motion::Revolute => *angle = q[segment.joint] + S::splat(segment.theta),
                Motion::Prismatic => node.d += q[segment.joint],
                Motion::Fixed => {}
            }
        }
        S::sin_cos_each(angles, sines, cosines);
        for ((node, s), c) in nodes.iter_mut().zip(&*sines).zip(&*cosines) {
            node.turn = Turn { c: *c, s: *s };
        }
    }
}
