//! The regressor: torques as a linear function of the dynamic parameters.

use crate::description::JointMotion;
use crate::inverse_dynamics::Gamma;
use crate::placement::Placement;
use crate::vector::Vec3;
use crate::workspace::{Pose3, Spin};
use crate::{Model, Scalar, Workspace};

/// Dynamic parameters per joint.
const PARAMETERS: usize = 10;

impl Model {
    /// Gives `Y(q, q̇, q̈)`, `n × 10 n` row by row, with `Y π = M q̈ + C q̇ + g`: armature is not in it.
    /// `π` stacks [`dynamic_parameters`](Self::dynamic_parameters).
    ///
    /// # Method
    ///
    /// In the axes of link `j`, with `Γ` as for [`inverse_dynamics`](Self::inverse_dynamics), its
    /// parameters `m, h, I` take the wrench
    ///
    /// ```text
    /// f = m a + Γ h                n = h × a + I ω̇ + ω × I ω                         (1)
    /// ```
    ///
    /// and joint `i` on the way to the base feels `v·f + w·n`, where `w, v` are the angular
    /// velocity of link `j` and the linear velocity of its origin at unit speed of joint `i`.
    /// `h` and `I` come out of the products as sums of ten known factors:
    ///
    /// ```text
    /// Y_ij = [ v·a,   Γᵀ v + a × w,   coefficients of I in w·(I ω̇ + ω × I ω) ]         (2)
    /// ```
    ///
    /// # Panics
    ///
    /// If a slice is not of length `n`, or `out` not of length `10 n²`.
    ///
    /// # References
    ///
    /// C. G. Atkeson, C. H. An, J. M. Hollerbach, "Estimation of inertial parameters of manipulator
    /// loads and links", Int. J. Robotics Research 5(3), 1986.
    pub fn regressor<S: Scalar>(
        &self,
        ws: &mut Workspace<S>,
        q: &[S],
        dq: &[S],
        ddq: &[S],
        out: &mut [S],
    ) {
        let n = self.joint_count();
        assert!(ddq.len() == n, "one acceleration per joint");
        assert!(out.len() == PARAMETERS * n * n, "n rows of ten columns per joint");
        ws.screws.place(self, q);
        self.sweep_poses(ws);
        self.sweep_out(ws, dq, |joint| ddq[joint]);
        out.fill(S::splat(0.0));
        let compiled = self.compiled();
        for (j, &at) in compiled.segment_of_joint.iter().enumerate() {
            let seat = &compiled.seats[compiled.link_of_joint[j]].at;
            let link = Pose3::of(seat).within(&ws.nodes[at].pose);
            let factors = RegressorFactors::of(&ws.nodes[at].motion.at(seat));
            let mut next = Some(at);
            while let Some(i) = next {
                let (segment, pose) = (&compiled.segments[i], &ws.nodes[i].pose);
                if segment.motion != JointMotion::Fixed {
                    let (w, v) = match segment.motion {
                        JointMotion::Prismatic => (Vec3::zero(), pose.z),
                        _ => (pose.z, pose.z.cross(link.p - pose.p)),
                    };
                    let row = factors.project(link.turn_back(w), link.turn_back(v));
                    let start = PARAMETERS * (segment.joint * n + j);
                    out[start..start + PARAMETERS].copy_from_slice(&row);
                }
                next = segment.parent;
            }
        }
    }
}

impl<S: Scalar> Spin<S> {
    /// The same motion, of a frame placed at `at` on the same body.
    #[inline(always)]
    fn at(&self, at: &Placement) -> Self {
        let pose = Pose3::of(at);
        let gamma = Gamma::of(self.omega, self.alpha);
        Self {
            omega: pose.turn_back(self.omega),
            alpha: pose.turn_back(self.alpha),
            acc: pose.turn_back(self.acc + gamma.apply(pose.p)),
        }
    }
}

/// Factors of a link's motion in its rows of `Y`.
struct RegressorFactors<S> {
    acc: Vec3<S>,
    gamma: Gamma<S>,
}

impl<S: Scalar> RegressorFactors<S> {
    #[inline(always)]
    fn of(motion: &Spin<S>) -> Self {
        Self { acc: motion.acc, gamma: Gamma::of(motion.omega, motion.alpha) }
    }

    /// (2). The moment of the inertia's part is `vee(Γ Σ − (Γ Σ)ᵀ)`, so its factors are entries of
    /// `Γ`: with `Σ = ½ tr(I) 1 − I`.
    #[inline(always)]
    fn project(&self, w: Vec3<S>, v: Vec3<S>) -> [S; PARAMETERS] {
        let g = &self.gamma;
        let first = Vec3::new(
            g.xx * v.x + g.yx * v.y + g.zx * v.z,
            g.xy * v.x + g.yy * v.y + g.zy * v.z,
            g.xz * v.x + g.yz * v.y + g.zz * v.z,
        ) + self.acc.cross(w);
        // w·vee(Γ Σ − (Γ Σ)ᵀ) = Σ_ab K_ab Σ_ab, with K = [w×]ᵀ Γ made symmetric, here by entries.
        let k = |a: Vec3<S>, b: Vec3<S>| a.dot(b);
        let columns =
            [Vec3::new(g.xx, g.yx, g.zx), Vec3::new(g.xy, g.yy, g.zy), Vec3::new(g.xz, g.yz, g.zz)];
        let zero = S::splat(0.0);
        // Row a of −[w×], so that (w × e_a)·Γ e_b is `turned[a]·columns[b]`.
        let turned =
            [Vec3::new(zero, w.z, -w.y), Vec3::new(-w.z, zero, w.x), Vec3::new(w.y, -w.x, zero)];
        let (xx, yy, zz) =
            (k(turned[0], columns[0]), k(turned[1], columns[1]), k(turned[2], columns[2]));
        let xy = k(turned[0], columns[1]) + k(turned[1], columns[0]);
        let xz = k(turned[0], columns[2]) + k(turned[2], columns[0]);
        let yz = k(turned[1], columns[2]) + k(turned[2], columns[1]);
        // From factors of Σ to factors of I: Σ_xx = (−I_xx + I_yy + I_zz)/2, Σ_xy = −I_xy.
        let half = S::splat(0.5) * (xx + yy + zz);
        let [fx, fy, fz] = first.array();
        [v.dot(self.acc), fx, fy, fz, half - xx, -xy, half - yy, -xz, -yz, half - zz]
    }
}
