//! Dynamics of a serial arm by screws in world axes, with its derivatives in closed form.
//!
//! ```text
//! S_i = Ad(e^{S_1 q_1} … e^{S_{i−1} q_{i−1}}) S_i(0)                                             (K1)
//! M_ij = S_iᵀ I_j^C S_j,  i ≤ j                                                                 (K2)
//! ∂_k M_ij = 0 (k ≤ i),  S_iᵀ (S_k ×* I_j^C S_j) (i < k ≤ j),
//!            S_iᵀ (S_k ×* I_k^C S_j − I_k^C (S_k × S_j)) (k > j)                                (K3)
//! ```
//!
//! `I_j^C`: all matter from joint `j` on. Everything beyond joint `k` turns about `S_k`, and a product of
//! things that turn together does not change.

use phihat_model::{JointKind, Model, Robot, Workspace};

use super::matter::Matter;
use super::number::{Screw, Shift, TubeNumber, cross, exact, minus, plus, scale};

/// A serial arm at its zero position, and where it carries a payload.
#[derive(Debug, Clone)]
pub(super) struct TubeChain {
    pub(super) n: usize,
    axes: Vec<Screw<f64>>,
    turns: Vec<bool>,
    bodies: Vec<Matter<f64>>,
    armature: Vec<f64>,
    gravity: [f64; 3],
    /// Frame of the payload, its origin at the middle of the box of centres of mass.
    hand: Shift<f64>,
    carrier: usize,
}

/// A body in the hand, about the hand's origin.
pub(super) type Load<S> = Matter<S>;

/// Why an arm is not such a chain.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum NotAChain {
    Tree,
    Frame,
}

impl TubeChain {
    /// `hand`: the payload's frame and the middle of its box \[m\].
    pub(super) fn new(
        robot: &Robot,
        gravity: [f64; 3],
        hand: Option<(&str, [f64; 3])>,
    ) -> Result<Self, NotAChain> {
        let model = robot.plant_model();
        let n = model.joint_count();
        let zero = vec![0.0; n];
        let mut ws = Workspace::new(&model);
        let mut axes = Vec::new();
        let mut bodies = Vec::new();
        let turns = robot.joints.iter().map(|j| j.kind != JointKind::Prismatic).collect();
        let parameters = model.dynamic_parameters();
        for j in 0..n {
            let frame = model.frame_of_joint(j).ok_or(NotAChain::Tree)?;
            let (at, jacobian) = placed(&model, &mut ws, &zero, frame);
            for i in 0..n {
                let moves = (0..6).any(|row| jacobian[row * n + i].abs() > 0.0);
                if i > j && moves {
                    return Err(NotAChain::Tree);
                }
            }
            // A branch shows as an earlier joint that moves nothing here: its axis is missing.
            for i in 0..j {
                if (0..6).all(|row| jacobian[row * n + i].abs() <= 0.0) {
                    return Err(NotAChain::Tree);
                }
            }
            let column = |row: usize| jacobian[row * n + j];
            let w = [column(3), column(4), column(5)];
            let v = [column(0), column(1), column(2)];
            axes.push(Screw { w, v: plus(v, cross(at.p, w)) });
            let [m, hx, hy, hz, xx, xy, yy, xz, yz, zz] = parameters[j];
            let own: Matter<f64> =
                Matter::exact(m, [hx, hy, hz], [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]);
            bodies.push(own.moved(&at));
        }
        let (hand, carrier) = match hand {
            None => (Shift::none(), n - 1),
            Some((name, centre)) => {
                let frame = model.frame(name).ok_or(NotAChain::Frame)?;
                let (mut at, jacobian) = placed(&model, &mut ws, &zero, frame);
                at.p = plus(at.p, at.turn(centre));
                let moved = |i: &usize| (0..6).any(|row| jacobian[row * n + i].abs() > 0.0);
                (at, (0..n).rfind(moved).ok_or(NotAChain::Frame)?)
            }
        };
        let armature = model.armature().to_vec();
        Ok(Self { n, axes, turns, bodies, armature, gravity, hand, carrier })
    }
}

/// Pose and Jacobian of a frame.
fn placed(
    model: &Model,
    ws: &mut Workspace<f64>,
    q: &[f64],
    frame: phihat_model::FrameId,
) -> (Shift<f64>, Vec<f64>) {
    let mut jacobian = vec![0.0; 6 * q.len()];
    model.jacobian(ws, q, frame, &mut jacobian);
    let pose = model.pose(ws, frame);
    (Shift { r: pose.r, p: pose.p }, jacobian)
}

/// The arm somewhere.
#[derive(Debug, Clone)]
pub(super) struct Placed<S> {
    pub(super) axes: Vec<Screw<S>>,
    bodies: Vec<Matter<S>>,
    /// All matter from each joint on.
    composite: Vec<Matter<S>>,
    hand: Shift<S>,
    armature: Vec<f64>,
    gravity: [f64; 3],
    carrier: usize,
}

impl TubeChain {
    pub(super) fn place<S: TubeNumber>(&self, q: &[S], load: Option<&Load<S>>) -> Placed<S> {
        let mut gone: Shift<S> = Shift::none();
        let (mut axes, mut bodies) = (Vec::with_capacity(self.n), Vec::with_capacity(self.n));
        let mut hand = Shift::none();
        for i in 0..self.n {
            let home = &self.axes[i];
            let axis = Screw { w: exact::<S>(home.w), v: exact::<S>(home.v) };
            axes.push(axis.moved(&gone));
            gone = gone.after(&self.step(i, q[i]));
            let own = &self.bodies[i];
            bodies.push(Matter::exact(own.m, own.h, own.i).moved(&gone));
            if i == self.carrier {
                let home = Shift { r: self.hand.r.map(exact), p: exact(self.hand.p) };
                hand = gone.after(&home);
                if let Some(load) = load {
                    bodies[i] = bodies[i].plus(load.moved(&hand));
                }
            }
        }
        let mut composite = bodies.clone();
        for i in (1..self.n).rev() {
            composite[i - 1] = composite[i - 1].plus(composite[i]);
        }
        let (armature, gravity) = (self.armature.clone(), self.gravity);
        Placed { axes, bodies, composite, hand, armature, gravity, carrier: self.carrier }
    }

    /// `e^{S_i q}` of the axis at home.
    fn step<S: TubeNumber>(&self, i: usize, q: S) -> Shift<S> {
        let Screw { w, v } = self.axes[i];
        if !self.turns[i] {
            return Shift { p: scale(exact(v), q), ..Shift::none() };
        }
        let (s, c) = q.sin_cos();
        let bend = S::exact(1.0) - c;
        let hat = [[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]];
        let r: [[S; 3]; 3] = core::array::from_fn(|a| {
            core::array::from_fn(|b| {
                let unit = if a == b { 1.0 } else { 0.0 };
                S::exact(unit) + s * S::exact(hat[a][b]) + bend * S::exact(w[a] * w[b] - unit)
            })
        });
        let centre = exact(cross(w, v));
        let turn = Shift { r, p: [S::exact(0.0); 3] };
        Shift { r, p: minus(centre, turn.turn(centre)) }
    }
}

impl<S: TubeNumber> Placed<S> {
    pub(super) fn mass_matrix(&self) -> Vec<S> {
        let n = self.axes.len();
        let mut m = vec![S::default(); n * n];
        for j in 0..n {
            let momentum = self.composite[j].times(self.axes[j]);
            for i in 0..=j {
                m[i * n + j] = self.axes[i].power(momentum);
                m[j * n + i] = m[i * n + j];
            }
            m[j * n + j] = m[j * n + j] + S::exact(self.armature[j]);
        }
        m
    }

    /// (K3), entry `(k n + i) n + j`.
    pub(super) fn mass_matrix_slopes(&self) -> Vec<S> {
        let n = self.axes.len();
        let s = &self.axes;
        let mut out = vec![S::default(); n * n * n];
        for j in 0..n {
            let whole = self.composite[j].times(s[j]);
            for k in 0..n {
                let turned = if k <= j {
                    s[k].cross_wrench(whole)
                } else {
                    let late = &self.composite[k];
                    s[k].cross_wrench(late.times(s[j])).minus(late.times(s[k].cross(s[j])))
                };
                for i in 0..=j.min(k.saturating_sub(1)) {
                    if k == 0 {
                        break;
                    }
                    let slope = s[i].power(turned);
                    out[(k * n + i) * n + j] = slope;
                    out[(k * n + j) * n + i] = slope;
                }
            }
        }
        out
    }

    /// Velocity and acceleration screws of every body; gravity is an acceleration of the base.
    fn motions(&self, v: &[S], a: &[S]) -> (Vec<Screw<S>>, Vec<Screw<S>>) {
        let lift = exact(self.gravity.map(|g| -g));
        let mut velocity = Screw::zero();
        let mut acceleration = Screw { v: lift, ..Screw::zero() };
        let (mut vs, mut accs) = (Vec::new(), Vec::new());
        for (i, axis) in self.axes.iter().enumerate() {
            let turned = velocity.cross(*axis).times(v[i]);
            acceleration = acceleration.plus(axis.times(a[i])).plus(turned);
            velocity = velocity.plus(axis.times(v[i]));
            vs.push(velocity);
            accs.push(acceleration);
        }
        (vs, accs)
    }

    #[cfg(test)]
    pub(super) fn inverse_dynamics(&self, v: &[S], a: &[S]) -> Vec<S> {
        let n = self.axes.len();
        let (vs, accs) = self.motions(v, a);
        let mut wrench = Screw::zero();
        let mut tau = vec![S::default(); n];
        for b in (0..n).rev() {
            let body = &self.bodies[b];
            let own = body.times(accs[b]).plus(vs[b].cross_wrench(body.times(vs[b])));
            wrench = wrench.plus(own);
            tau[b] = self.axes[b].power(wrench) + S::exact(self.armature[b]) * a[b];
        }
        tau
    }

    /// `∂ID/∂q`, entry `i n + k`, at fixed `v, a`. Beyond joint `k` all turns with `S_k` but for the motion
    /// that comes from before it: with `u = S_k × V_k`, a body there takes
    ///
    /// ```text
    /// ∂_k f_b = S_k ×* f_b − I_b (S_k × A_k + u × (V_b − V_k)) − u ×* I_b V_b − V_b ×* I_b u          (K4)
    /// ```
    pub(super) fn inverse_dynamics_slopes(&self, v: &[S], a: &[S]) -> Vec<S> {
        let n = self.axes.len();
        let s = &self.axes;
        let (vs, accs) = self.motions(v, a);
        let momenta: Vec<_> = (0..n).map(|b| self.bodies[b].times(vs[b])).collect();
        let mut wrenches: Vec<_> = (0..n)
            .map(|b| self.bodies[b].times(accs[b]).plus(vs[b].cross_wrench(momenta[b])))
            .collect();
        for b in (1..n).rev() {
            wrenches[b - 1] = wrenches[b - 1].plus(wrenches[b]);
        }
        let mut out = vec![S::default(); n * n];
        for k in 0..n {
            let u = s[k].cross(vs[k]);
            let carried = s[k].cross(accs[k]);
            // What does not turn along, summed from the tip.
            let mut left = Screw::zero();
            for b in (0..n).rev() {
                if b >= k {
                    let body = &self.bodies[b];
                    let moved = carried.plus(u.cross(vs[b].minus(vs[k])));
                    left = left
                        .plus(body.times(moved))
                        .plus(u.cross_wrench(momenta[b]))
                        .plus(vs[b].cross_wrench(body.times(u)));
                }
                out[b * n + k] = if b > k {
                    -s[b].power(left)
                } else {
                    s[b].power(s[k].cross_wrench(wrenches[k]).minus(left))
                };
            }
        }
        out
    }

    /// Twist of the hand per joint rate, in its own axes: `Screw` per joint.
    pub(super) fn hand_twists(&self) -> Vec<Screw<S>> {
        let of = |(i, axis): (usize, &Screw<S>)| {
            if i > self.carrier {
                return Screw::zero();
            }
            self.in_hand(*axis)
        };
        self.axes.iter().enumerate().map(of).collect()
    }

    fn in_hand(&self, motion: Screw<S>) -> Screw<S> {
        let v = plus(motion.v, cross(motion.w, self.hand.p));
        Screw { w: self.hand.turn_back(motion.w), v: self.hand.turn_back(v) }
    }

    /// Motions of every body up to the hand's carrier, in the hand's axes.
    pub(super) fn motions_in_hand(&self, v: &[S], a: &[S]) -> (Vec<Screw<S>>, Vec<Screw<S>>) {
        let (vs, accs) = self.motions(v, a);
        let of = |all: Vec<Screw<S>>| {
            all.into_iter().take(self.carrier + 1).map(|x| self.in_hand(x)).collect()
        };
        (of(vs), of(accs))
    }

    /// Joint torques of a unit of each of the hand's ten moments, `m, h_x, h_y, h_z, Σ_xx, Σ_yy, Σ_zz, Σ_xy,
    /// Σ_xz, Σ_yz`: entry `c n + i`.
    pub(super) fn load_torques(&self, v: &[S], a: &[S]) -> Vec<S> {
        let n = self.axes.len();
        let (vs, accs) = self.motions(v, a);
        let velocity = self.in_hand(vs[self.carrier]);
        let acceleration = self.in_hand(accs[self.carrier]);
        let twists = self.hand_twists();
        let mut out = vec![S::default(); 10 * n];
        for c in 0..10 {
            let unit = |at: usize| S::exact(if at == c { 1.0 } else { 0.0 });
            let h = [unit(1), unit(2), unit(3)];
            let sigma = core::array::from_fn(|i| unit(4 + i));
            let body = Matter::of_moments(unit(0), h, sigma);
            let wrench = body.times(acceleration).plus(velocity.cross_wrench(body.times(velocity)));
            for i in 0..n {
                out[c * n + i] = twists[i].power(wrench);
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tube::number::Ball;
    use phihat_model::Body;

    const Q: [f64; 7] = [0.3, -0.7, 0.2, -2.1, 0.4, 1.4, 0.9];
    const V: [f64; 7] = [0.5, -0.3, 0.8, 0.2, -0.6, 0.7, -0.4];
    const A: [f64; 7] = [1.0, 2.0, -1.0, 0.5, -2.0, 1.5, 0.3];
    const COM: [f64; 3] = [0.01, -0.02, 0.05];

    fn close(a: &[f64], b: &[f64], tolerance: f64) {
        for (i, (a, b)) in a.iter().zip(b).enumerate() {
            assert!((a - b).abs() < tolerance, "entry {i}: {a} {b}");
        }
    }

    fn load<S: TubeNumber>(m: f64) -> Matter<S> {
        Matter::exact(m, [0.0; 3], [[0.0; 3]; 3])
    }

    #[test]
    fn screws_agree_with_the_recursions_and_slopes_with_differences() {
        let robot = Robot::named("panda").unwrap();
        let chain =
            TubeChain::new(&robot, phihat_model::GRAVITY, Some(("panda_link8", COM))).unwrap();
        let load = Matter::exact(0.8, [0.0; 3], [[0.0; 3]; 3]);
        let body = Body { mass: 0.8, com: COM, inertia: [0.0; 6] };
        let model = robot.plant_model().with_payload_on("panda_link8", &body).unwrap();
        let mut ws = Workspace::new(&model);
        let there = chain.place::<f64>(&Q, Some(&load));
        let (mut m, mut tau) = (vec![0.0; 49], vec![0.0; 7]);
        model.mass_matrix(&mut ws, &Q, &mut m);
        model.inverse_dynamics(&mut ws, &Q, &V, &A, &mut tau);
        close(&there.mass_matrix(), &m, 1e-12);
        close(&there.inverse_dynamics(&V, &A), &tau, 1e-11);
        let h = 1e-6;
        for k in 0..7 {
            let at = |step: f64| {
                let mut q = Q;
                q[k] += step;
                let placed = chain.place::<f64>(&q, Some(&load));
                (placed.mass_matrix(), placed.inverse_dynamics(&V, &A))
            };
            let (up, down) = (at(h), at(-h));
            let slopes = |a: &[f64], b: &[f64]| -> Vec<f64> {
                a.iter().zip(b).map(|(a, b)| (a - b) / (2.0 * h)).collect()
            };
            close(&there.mass_matrix_slopes()[k * 49..][..49], &slopes(&up.0, &down.0), 1e-7);
            let all = there.inverse_dynamics_slopes(&V, &A);
            let column: Vec<f64> = (0..7).map(|i| all[i * 7 + k]).collect();
            close(&column, &slopes(&up.1, &down.1), 1e-7);
        }
    }

    #[test]
    fn a_payload_s_share_is_the_difference_of_two_arms() {
        let robot = Robot::named("panda").unwrap();
        let chain =
            TubeChain::new(&robot, phihat_model::GRAVITY, Some(("panda_link8", COM))).unwrap();
        let slice = crate::tube::scope::PayloadSlice {
            frame: "panda_link8".to_owned(),
            mass: (0.5, 1.1),
            centre: COM,
            reach: [0.0; 3],
            gyration: 0.0,
        };
        let exact = |x: &[f64]| -> Vec<Ball> { x.iter().map(|x| Ball::exact(*x)).collect() };
        let placed = chain.place(&exact(&Q), Some(&load(0.8)));
        let carried =
            crate::tube::carried::CarriedLoad::new(&slice, &placed, &exact(&V), &exact(&A));
        let (low, high) =
            (chain.place::<f64>(&Q, Some(&load(0.5))), chain.place::<f64>(&Q, Some(&load(1.1))));
        let half = |a: &[f64], b: &[f64]| -> Vec<f64> {
            a.iter().zip(b).map(|(a, b)| 0.5 * (a - b).abs()).collect()
        };
        close(&carried.slopes, &half(&high.mass_matrix_slopes(), &low.mass_matrix_slopes()), 1e-12);
        let stiff = |p: &Placed<f64>| p.inverse_dynamics_slopes(&V, &A);
        close(&carried.k, &half(&stiff(&high), &stiff(&low)), 1e-11);
        let torques = chain.place::<f64>(&Q, None).load_torques(&V, &A);
        let tau = |p: &Placed<f64>| p.inverse_dynamics(&V, &A);
        let whole = half(&tau(&high), &tau(&low));
        close(&torques[..7].iter().map(|t| 0.3 * t.abs()).collect::<Vec<_>>(), &whole, 1e-11);
    }
}
