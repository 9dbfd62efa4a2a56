//! Kinetic and potential energy, and the torque of gravity alone.

use crate::description::JointMotion;
use crate::inverse_dynamics::wrench_on_parent;
use crate::segment::Segment;
use crate::vector::Vec3;
use crate::workspace::Pose3;
use crate::{Model, Scalar, Workspace};

impl Model {
    /// Gives the torques that hold the robot still: `g(q)`.
    ///
    /// # Panics
    ///
    /// If a slice is not of length [`joint_count`](Self::joint_count).
    pub fn gravity_torque<S: Scalar>(&self, ws: &mut Workspace<S>, q: &[S], tau: &mut [S]) {
        assert!(tau.len() == self.joint_count(), "one torque per joint");
        ws.screws.place(self, q);
        let Workspace { screws, nodes, .. } = &mut *ws;
        let base = Vec3::splat(self.lift());
        let mut lift = base;
        for (i, segment) in self.segments().iter().enumerate() {
            if !segment.follows_parent(i) {
                lift = segment.parent.map_or(base, |p| nodes[p].motion.acc);
            }
            let ((tilt, _), (turn, _)) = (segment.tilt(), screws.at(i, segment));
            lift = turn.into_z(tilt.into_x(lift));
            let node = &mut nodes[i];
            node.motion.acc = lift;
            node.force = lift.scale(S::splat(segment.m));
            node.moment = Vec3::splat(segment.h).cross(lift);
        }
        self.collect(ws, tau);
    }

    /// From tips to base: sums up the segments' wrenches and reads the joints' torques off.
    #[inline(always)]
    pub(crate) fn collect<S: Scalar>(&self, ws: &mut Workspace<S>, tau: &mut [S]) {
        let Workspace { screws, nodes, .. } = ws;
        let mut borne = (Vec3::zero(), Vec3::zero());
        for (i, segment) in self.segments().iter().enumerate().rev() {
            let node = &nodes[i];
            let (mut force, mut moment) = (node.force, node.moment);
            if segment.bears {
                force += borne.0;
                moment += borne.1;
            }
            match segment.motion {
                JointMotion::Revolute => tau[segment.joint] = moment.z,
                JointMotion::Prismatic => tau[segment.joint] = force.z,
                JointMotion::Fixed => {}
            }
            let Some(parent) = segment.parent else { continue };
            borne = wrench_on_parent(segment, screws.at(i, segment), (force, moment));
            if !segment.follows_parent(i) {
                nodes[parent].force += borne.0;
                nodes[parent].moment += borne.1;
            }
        }
    }

    /// Gives the kinetic energy `½ q̇ᵀ (M + J_r) q̇` \[J\], with `J_r` the armature.
    ///
    /// # Panics
    ///
    /// If a slice is not of length [`joint_count`](Self::joint_count).
    pub fn kinetic_energy<S: Scalar>(&self, ws: &mut Workspace<S>, q: &[S], dq: &[S]) -> S {
        assert!(dq.len() == self.joint_count(), "one velocity per joint");
        ws.screws.place(self, q);
        let zero = S::splat(0.0);
        let rest = (Vec3::zero(), Vec3::zero());
        let mut twice = zero;
        let Workspace { screws, nodes, .. } = ws;
        for (i, segment) in self.segments().iter().enumerate() {
            let parent = segment.parent.map_or(rest, |p| {
                let motion = &nodes[p].motion;
                (motion.omega, motion.acc)
            });
            let ((tilt, a), (turn, d)) = (segment.tilt::<S>(), screws.at(i, segment));
            let node = &mut nodes[i];
            let (omega, velocity): (Vec3<S>, Vec3<S>) = parent;
            let velocity = velocity + Vec3::new(zero, a * omega.z, -(a * omega.y));
            let inward = |v: Vec3<S>| turn.into_z(tilt.into_x(v));
            let (mut omega, velocity) = (inward(omega), inward(velocity));
            let mut velocity = velocity + Vec3::new(d * omega.y, -(d * omega.x), zero);
            match segment.motion {
                JointMotion::Revolute => omega.z += dq[segment.joint],
                JointMotion::Prismatic => velocity.z += dq[segment.joint],
                JointMotion::Fixed => {}
            }
            // The velocity takes the acceleration's place.
            (node.motion.omega, node.motion.acc) = (omega, velocity);
            twice += twice_kinetic(segment, omega, velocity);
        }
        for (dq, armature) in dq.iter().zip(self.armature()) {
            twice += S::splat(*armature) * *dq * *dq;
        }
        S::splat(0.5) * twice
    }

    /// Gives the potential energy `−Σ m gᵀ c` \[J\]: 0 with all mass at the world's origin. Links
    /// fixed to the base do not count.
    ///
    /// # Panics
    ///
    /// If `q` is not of length [`joint_count`](Self::joint_count).
    pub fn potential_energy<S: Scalar>(&self, ws: &mut Workspace<S>, q: &[S]) -> S {
        self.forward_kinematics(ws, q);
        let mut moment = Vec3::zero();
        for (segment, node) in self.segments().iter().zip(&ws.nodes) {
            let Pose3 { p, .. } = node.pose;
            moment += p.scale(S::splat(segment.m)) + node.pose.turn(Vec3::splat(segment.h));
        }
        -moment.dot(Vec3::splat(self.gravity()))
    }
}

/// `m v² + 2 v·(ω × h) + ω·I ω`.
#[inline(always)]
fn twice_kinetic<S: Scalar>(segment: &Segment, omega: Vec3<S>, velocity: Vec3<S>) -> S {
    let [xx, yy, zz, xy, xz, yz] = segment.i.map(S::splat);
    let turning = omega.cross(Vec3::splat(segment.h));
    let spin = Vec3::new(
        xx * omega.x + xy * omega.y + xz * omega.z,
        xy * omega.x + yy * omega.y + yz * omega.z,
        xz * omega.x + yz * omega.y + zz * omega.z,
    );
    let linear = velocity.scale(S::splat(segment.m)) + turning + turning;
    velocity.dot(linear) + omega.dot(spin)
}
