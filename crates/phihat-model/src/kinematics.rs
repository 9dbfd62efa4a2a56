//! Poses of frames, and the Jacobian.

use crate::description::JointMotion;
use crate::model::FrameId;
use crate::placement::Placement;
use crate::vector::{Turn, Vec3};
use crate::workspace::Pose3;
use crate::{Model, Scalar, Workspace};

/// Pose of a frame in the world: `x_world = r x_frame + p`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose<S = f64> {
    /// Origin \[m\].
    pub p: [S; 3],
    /// Rotation, row by row.
    pub r: [[S; 3]; 3],
}

impl Model {
    /// Computes the pose of every frame at `q`; [`pose`](Self::pose) reads them.
    ///
    /// # Panics
    ///
    /// If `q` is not of length [`joint_count`](Self::joint_count).
    pub fn forward_kinematics<S: Scalar>(&self, ws: &mut Workspace<S>, q: &[S]) {
        ws.screws.place(self, q);
        self.sweep_poses(ws);
    }

    /// From base to tips: poses of all segments.
    #[inline(always)]
    pub(crate) fn sweep_poses<S: Scalar>(&self, ws: &mut Workspace<S>) {
        let Workspace { screws, nodes, .. } = ws;
        let base = Pose3::of(self.base());
        let mut pose = base;
        for (i, segment) in self.segments().iter().enumerate() {
            if !segment.follows_parent(i) {
                pose = segment.parent.map_or(base, |p| nodes[p].pose);
            }
            let ((tilt, a), (turn, d)) = (segment.tilt(), screws.at(i, segment));
            pose = pose.turn_x(tilt, a).turn_z(turn, d);
            nodes[i].pose = pose;
        }
    }

    /// Pose of `frame` at the position last given to
    /// [`forward_kinematics`](Self::forward_kinematics).
    ///
    /// # Panics
    ///
    /// If the workspace or the frame is another model's.
    pub fn pose<S: Scalar>(&self, ws: &Workspace<S>, frame: FrameId) -> Pose<S> {
        let seat = &self.compiled().seats[frame.0];
        let at = Pose3::of(&seat.at);
        let Some(segment) = seat.segment else { return at.pose() };
        at.within(&ws.nodes[segment].pose).pose()
    }

    /// Jacobian of `frame` at `q`, 6 × n row by row: three rows of linear velocity of the frame's
    /// origin, three of angular velocity, all in world axes. Leaves the poses as
    /// [`forward_kinematics`](Self::forward_kinematics) does.
    ///
    /// # Panics
    ///
    /// If `q` is not of length `n`, or `out` not of length `6 n`.
    pub fn jacobian<S: Scalar>(
        &self,
        ws: &mut Workspace<S>,
        q: &[S],
        frame: FrameId,
        out: &mut [S],
    ) {
        let n = self.joint_count();
        assert!(out.len() == 6 * n, "six rows of one column per joint");
        self.forward_kinematics(ws, q);
        out.fill(S::splat(0.0));
        let seat = &self.compiled().seats[frame.0];
        let Some(carrier) = seat.segment else { return };
        let origin = ws.nodes[carrier].pose.point(Vec3::splat(seat.at.p));
        let mut next = Some(carrier);
        while let Some(i) = next {
            let (segment, pose) = (&self.segments()[i], &ws.nodes[i].pose);
            let (linear, angular) = match segment.motion {
                JointMotion::Revolute => (pose.z.cross(origin - pose.p), pose.z),
                JointMotion::Prismatic => (pose.z, Vec3::zero()),
                JointMotion::Fixed => (Vec3::zero(), Vec3::zero()),
            };
            if segment.motion != JointMotion::Fixed {
                let column = linear.array().into_iter().chain(angular.array());
                for (entry, value) in out[segment.joint..].iter_mut().step_by(n).zip(column) {
                    *entry = value;
                }
            }
            next = segment.parent;
        }
    }
}

impl<S: Scalar> Pose3<S> {
    #[inline(always)]
    pub(crate) fn of(at: &Placement) -> Self {
        let column = |j| Vec3::splat([at.r[0][j], at.r[1][j], at.r[2][j]]);
        Self { x: column(0), y: column(1), z: column(2), p: Vec3::splat(at.p) }
    }

    /// A direction given in this frame's axes.
    #[inline(always)]
    pub(crate) fn turn(&self, v: Vec3<S>) -> Vec3<S> {
        self.x.scale(v.x) + self.y.scale(v.y) + self.z.scale(v.z)
    }

    /// A direction of base axes, in this frame's axes.
    #[inline(always)]
    pub(crate) fn turn_back(&self, v: Vec3<S>) -> Vec3<S> {
        Vec3::new(self.x.dot(v), self.y.dot(v), self.z.dot(v))
    }

    /// This frame, given in `carrier`, in base axes.
    #[inline(always)]
    pub(crate) fn within(&self, carrier: &Self) -> Self {
        Self {
            x: carrier.turn(self.x),
            y: carrier.turn(self.y),
            z: carrier.turn(self.z),
            p: carrier.point(self.p),
        }
    }

    /// A point given in this frame.
    #[inline(always)]
    pub(crate) fn point(&self, v: Vec3<S>) -> Vec3<S> {
        self.turn(v) + self.p
    }

    /// The frame `Rx Tx(a)` within this one.
    #[inline(always)]
    fn turn_x(&self, turn: Turn<S>, a: S) -> Self {
        Self {
            x: self.x,
            y: self.y.scale(turn.c) + self.z.scale(turn.s),
            z: self.z.scale(turn.c) - self.y.scale(turn.s),
            p: self.p + self.x.scale(a),
        }
    }

    /// The frame `Rz Tz(d)` within this one.
    #[inline(always)]
    fn turn_z(&self, turn: Turn<S>, d: S) -> Self {
        Self {
            x: self.x.scale(turn.c) + self.y.scale(turn.s),
            y: self.y.scale(turn.c) - self.x.scale(turn.s),
            z: self.z,
            p: self.p + self.z.scale(d),
        }
    }

    fn pose(&self) -> Pose<S> {
        let (x, y, z) = (self.x, self.y, self.z);
        Pose { p: self.p.array(), r: [[x.x, y.x, z.x], [x.y, y.y, z.y], [x.z, y.z, z.z]] }
    }
}
