//! A planar chain of three joints: the form of its kinematics, and a camera that sees its tip.

use phihat_model::Workspace;

use crate::error::RivalRefusal;
use crate::handed::Knows;
use crate::needs::Needs;
use crate::supply::Supply;

/// Joints of the chain, and coordinates of its tip.
pub const LINKS: usize = 3;

/// Place and direction of the tip: two lengths \[m\] in the plane of the arm and the last link's angle \[rad\].
pub type Tip = [f64; LINKS];

/// First estimate of the links' lengths over the true ones.
const MISBELIEF: f64 = 1.1;

/// Three parallel joints. With `φ_i = q_1 + … + q_i + β_i`, `ω_i = q̇_1 + … + q̇_i`:
///
/// ```text
/// x = (Σ l_i cos φ_i, Σ l_i sin φ_i, φ_3)                                              (1)
/// ẋ = Z(q, q̇) l + (0, 0, ω_3),   Z = [−ω_i sin φ_i; ω_i cos φ_i; 0]                    (2)
/// ```
///
/// A rival is told the form and the angles `β_i` at which the links lie at `q = 0`, not the lengths. It has a camera:
/// [`tip`](Self::tip) is measured, with the true lengths, from the joints' positions and velocities as sensed.
#[derive(Debug, Clone)]
pub struct Planar {
    lengths: [f64; LINKS],
    offsets: [f64; LINKS],
}

impl Planar {
    /// First belief of the lengths \[m\]: 10 % too long.
    pub fn believed(&self) -> [f64; LINKS] {
        self.lengths.map(|l| MISBELIEF * l)
    }

    /// `φ_i` \[rad\].
    pub fn angles(&self, q: &[f64]) -> [f64; LINKS] {
        let sums = running(q);
        core::array::from_fn(|i| sums[i] + self.offsets[i])
    }

    /// The tip as the camera sees it, and its velocity: (1), (2).
    pub fn tip(&self, q: &[f64], dq: &[f64]) -> [Tip; 2] {
        let [x, dx, _] = self.motion(q, dq, &[0.0; LINKS]);
        [x, dx]
    }

    /// Motion of the tip for a motion of the joints: position, velocity, acceleration.
    pub fn motion(&self, q: &[f64], dq: &[f64], ddq: &[f64]) -> [Tip; 3] {
        let (phi, rate, slope) = (self.angles(q), running(dq), running(ddq));
        let (mut x, mut dx, mut ddx) = ([0.0; LINKS], [0.0; LINKS], [0.0; LINKS]);
        for (i, l) in self.lengths.iter().enumerate() {
            let (sin, cos) = phi[i].sin_cos();
            let (w, a) = (rate[i], slope[i]);
            x[0] += l * cos;
            x[1] += l * sin;
            dx[0] -= l * w * sin;
            dx[1] += l * w * cos;
            ddx[0] -= l * (a * sin + w * w * cos);
            ddx[1] += l * (a * cos - w * w * sin);
        }
        let last = LINKS - 1;
        (x[last], dx[last], ddx[last]) = (phi[last], rate[last], slope[last]);
        [x, dx, ddx]
    }
}

/// Sums from the first joint on: what the joints do, as angles against the base.
pub(crate) fn running(x: &[f64]) -> [f64; LINKS] {
    let mut sum = 0.0;
    core::array::from_fn(|i| {
        sum += x[i];
        sum
    })
}

impl Knows for Planar {
    const NEEDS: Needs = Needs { task: true, ..Needs::NONE };
    fn of(supply: &Supply) -> Result<Self, RivalRefusal> {
        let refuse = |why: &str| RivalRefusal::NotApplicable(why.to_owned());
        let model = &supply.model;
        let n = model.joint_count();
        if n != LINKS {
            return Err(refuse(
                "three tip coordinates need three joints: with more the arm is redundant and Ĵ has no inverse",
            ));
        }
        let tip = model.frame(&supply.tip).ok_or_else(|| refuse("the arm has no such tip"))?;
        let mut ws = Workspace::new(model);
        let mut jacobian = vec![0.0; 6 * n];
        let axis = |jacobian: &[f64], j: usize| core::array::from_fn(|k| jacobian[(3 + k) * n + j]);
        model.jacobian(&mut ws, &[0.4, -0.9, 1.3], tip, &mut jacobian);
        let first: [f64; 3] = axis(&jacobian, 0);
        let parallel = (0..n).all(|j| dot(axis(&jacobian, j), first) > 1.0 - 1e-9);
        if !parallel {
            return Err(refuse("the kinematic regressor is written for parallel joints"));
        }
        model.forward_kinematics(&mut ws, &[0.0; LINKS]);
        let mut places = Vec::new();
        for j in 0..n {
            let frame = model.frame_of_joint(j).ok_or_else(|| refuse("a joint moves no frame"))?;
            places.push(model.pose(&ws, frame).p);
        }
        places.push(model.pose(&ws, tip).p);
        let link = |i: usize| -> [f64; 3] {
            let along: [f64; 3] = core::array::from_fn(|k| places[i + 1][k] - places[i][k]);
            let off = dot(along, first);
            core::array::from_fn(|k| along[k] - off * first[k])
        };
        let (u, size) = (link(0), dot(link(0), link(0)).sqrt());
        let w = cross(first, u);
        let lengths = core::array::from_fn(|i| dot(link(i), link(i)).sqrt());
        if lengths.iter().any(|l| *l < 1e-6) {
            return Err(refuse("a link has no length in the plane of the arm"));
        }
        let offsets =
            core::array::from_fn(|i| (dot(link(i), w) / size).atan2(dot(link(i), u) / size));
        Ok(Self { lengths, offsets })
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
