//! Joint torques from motion: recursive Newton–Euler.

use crate::description::JointMotion;
use crate::segment::Segment;
use crate::vector::{Turn, Vec3};
use crate::workspace::Spin;
use crate::{Model, Scalar, Workspace};

impl Model {
    /// Gives the torques that produce `ddq`: `τ = M(q) q̈ + C(q, q̇) q̇ + g(q) + J_r q̈`, with `J_r`
    /// the armature.
    ///
    /// # Method
    ///
    /// Recursive Newton–Euler in body axes. With `Γ = [ω̇×] + [ω×]²`, so that a point at `r` of the
    /// body accelerates by `a + Γ r`, each body takes
    ///
    /// ```text
    /// f = m a + Γ h                                                                  (1)
    /// n = vee(Γ Σ − (Γ Σ)ᵀ) + h × a                                                  (2)
    /// ```
    ///
    /// where `m, h, Σ` are its zeroth, first and second moments of mass. `Γ` also carries the
    /// acceleration from one origin to the next.
    ///
    /// # Panics
    ///
    /// If a slice is not of length [`joint_count`](Self::joint_count).
    ///
    /// # References
    ///
    /// R. Featherstone, *Rigid Body Dynamics Algorithms*, Springer 2008, section 5.3. C. A.
    /// Balafoutis, R. V. Patel, *Dynamic Analysis of Robot Manipulators*, Kluwer 1991 (form (2)).
    pub fn inverse_dynamics<S: Scalar>(
        &self,
        ws: &mut Workspace<S>,
        q: &[S],
        dq: &[S],
        ddq: &[S],
        tau: &mut [S],
    ) {
        assert!(ddq.len() == self.joint_count(), "one acceleration per joint");
        self.newton_euler(ws, q, dq, |joint| ddq[joint], tau);
        for ((tau, ddq), armature) in tau.iter_mut().zip(ddq).zip(self.armature()) {
            *tau += S::splat(*armature) * *ddq;
        }
    }

    /// Gives what motion and gravity ask of the joints at `q̈ = 0`: `C(q, q̇) q̇ + g(q)`.
    ///
    /// # Panics
    ///
    /// If a slice is not of length [`joint_count`](Self::joint_count).
    pub fn bias<S: Scalar>(&self, ws: &mut Workspace<S>, q: &[S], dq: &[S], tau: &mut [S]) {
        self.newton_euler(ws, q, dq, |_| S::splat(0.0), tau);
    }

    #[inline(always)]
    fn newton_euler<S: Scalar>(
        &self,
        ws: &mut Workspace<S>,
        q: &[S],
        dq: &[S],
        ddq: impl Fn(usize) -> S,
        tau: &mut [S],
    ) {
        assert!(tau.len() == self.joint_count(), "one torque per joint");
        ws.screws.place(self, q);
        self.sweep_out(ws, dq, ddq);
        self.collect(ws, tau);
    }

    /// From base to tips: motion of every segment, and the wrench (1), (2) its own matter takes.
    #[inline(always)]
    pub(crate) fn sweep_out<S: Scalar>(
        &self,
        ws: &mut Workspace<S>,
        dq: &[S],
        ddq: impl Fn(usize) -> S,
    ) {
        assert!(dq.len() == self.joint_count(), "one velocity per joint");
        let Workspace { screws, nodes, .. } = ws;
        let zero = Vec3::zero();
        let base = Spin { omega: zero, alpha: zero, acc: Vec3::splat(self.lift()) };
        let mut motion = base;
        for (i, segment) in self.segments().iter().enumerate() {
            if !segment.follows_parent(i) {
                motion = segment.parent.map_or(base, |p| nodes[p].motion);
            }
            let rates = match segment.motion {
                JointMotion::Fixed => (S::splat(0.0), S::splat(0.0)),
                _ => (dq[segment.joint], ddq(segment.joint)),
            };
            let gamma;
            (motion, gamma) = motion.of_child(segment, screws.at(i, segment), rates);
            let node = &mut nodes[i];
            node.motion = motion;
            (node.force, node.moment) = wrench_of(segment, &motion, &gamma);
        }
    }
}

/// `Γ = [ω̇×] + [ω×]²`, by entries.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gamma<S> {
    pub(crate) xx: S,
    pub(crate) xy: S,
    pub(crate) xz: S,
    pub(crate) yx: S,
    pub(crate) yy: S,
    pub(crate) yz: S,
    pub(crate) zx: S,
    pub(crate) zy: S,
    pub(crate) zz: S,
}

impl<S: Scalar> Gamma<S> {
    #[inline(always)]
    pub(crate) fn of(omega: Vec3<S>, alpha: Vec3<S>) -> Self {
        let Vec3 { x, y, z } = omega;
        let (x2, y2, z2) = (x * x, y * y, z * z);
        let (xy, xz, yz) = (x * y, x * z, y * z);
        Self {
            xx: -(y2 + z2),
            xy: xy - alpha.z,
            xz: xz + alpha.y,
            yx: xy + alpha.z,
            yy: -(x2 + z2),
            yz: yz - alpha.x,
            zx: xz - alpha.y,
            zy: yz + alpha.x,
            zz: -(x2 + y2),
        }
    }

    #[inline(always)]
    pub(crate) fn apply(&self, v: Vec3<S>) -> Vec3<S> {
        Vec3::new(
            self.xx * v.x + self.xy * v.y + self.xz * v.z,
            self.yx * v.x + self.yy * v.y + self.yz * v.z,
            self.zx * v.x + self.zy * v.y + self.zz * v.z,
        )
    }
}

impl<S: Scalar> Spin<S> {
    /// Motion of a child from its parent's, through both screws and the joint itself.
    #[inline(always)]
    pub(crate) fn of_child(
        &self,
        segment: &Segment,
        (turn, d): (Turn<S>, S),
        (dq, ddq): (S, S),
    ) -> (Self, Gamma<S>) {
        let (tilt, a) = segment.tilt();
        let (w, l) = (self.omega, self.alpha);
        let reach = Vec3::new(-(w.y * w.y + w.z * w.z), w.x * w.y + l.z, w.x * w.z - l.y);
        let acc = self.acc + reach.scale(a);
        let inward = |v| turn.into_z(tilt.into_x(v));
        let (mut omega, mut alpha, mut acc) = (inward(w), inward(l), inward(acc));
        match segment.motion {
            JointMotion::Revolute => {
                alpha += Vec3::new(omega.y * dq, -(omega.x * dq), ddq);
                omega.z += dq;
            }
            JointMotion::Prismatic => {
                let twice = dq + dq;
                acc += Vec3::new(omega.y * twice, -(omega.x * twice), ddq);
            }
            JointMotion::Fixed => {}
        }
        let gamma = Gamma::of(omega, alpha);
        acc += Vec3::new(gamma.xz, gamma.yz, gamma.zz).scale(d);
        (Self { omega, alpha, acc }, gamma)
    }
}

/// (1) and (2): the wrench that gives a segment's own matter its motion.
#[inline(always)]
fn wrench_of<S: Scalar>(
    segment: &Segment,
    motion: &Spin<S>,
    gamma: &Gamma<S>,
) -> (Vec3<S>, Vec3<S>) {
    let h = Vec3::splat(segment.h);
    let [xx, yy, zz, xy, xz, yz] = segment.sigma.map(S::splat);
    let g = gamma;
    let force = motion.acc.scale(S::splat(segment.m)) + g.apply(h);
    let turning = Vec3::new(
        (g.zx * xy + g.zy * yy + g.zz * yz) - (g.yx * xz + g.yy * yz + g.yz * zz),
        (g.xx * xz + g.xy * yz + g.xz * zz) - (g.zx * xx + g.zy * xy + g.zz * xz),
        (g.yx * xx + g.yy * xy + g.yz * xz) - (g.xx * xy + g.xy * yy + g.xz * yz),
    );
    (force, turning + h.cross(motion.acc))
}

/// The wrench of a segment and all it bears, about the parent's origin in the parent's axes.
#[inline(always)]
pub(crate) fn wrench_on_parent<S: Scalar>(
    segment: &Segment,
    (turn, d): (Turn<S>, S),
    (force, moment): (Vec3<S>, Vec3<S>),
) -> (Vec3<S>, Vec3<S>) {
    let (tilt, a) = segment.tilt();
    let (f, zero) = (force, S::splat(0.0));
    let moment = moment + Vec3::new(-(d * f.y), d * f.x, zero);
    let force = tilt.out_x(turn.out_z(f));
    let moment = tilt.out_x(turn.out_z(moment));
    (force, moment + Vec3::new(zero, -(a * force.z), a * force.y))
}
