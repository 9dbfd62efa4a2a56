//! Active disturbance rejection control: everything is estimated from the position.

use crate::card::{Card, Grade};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::facts::Inertia;
use crate::measured::{Acceleration, PositionsAndTorque};
use crate::rival::Rival;
use crate::rivals::proposed::{BANDWIDTH, DAMPING, outer_gains};
use crate::tuning::{Scalar, Tuning};

/// Linear active disturbance rejection control (ADRC), without a velocity measurement.
///
/// # Law
///
/// Every joint is `q̈ = f + b_0 τ` with `b_0 = 1/M̄`. An extended state observer has `z ≈ (q, q̇, f)`; at a sample
/// it predicts by (1) with the torque that acted, then corrects by (2), `β = e^{−ω_o T}`:
///
/// ```text
/// z ← (z_1 + T z_2 + T²/2 (z_3 + b_0 τ),  z_2 + T (z_3 + b_0 τ),  z_3)                 (1)
/// z ← z + (1 − β³,  3/(2T) (1 − β)²(1 + β),  (1 − β)³/T²) (q − z_1)                    (2)
/// τ = M̄ (q̈_d − K_d (z_2 − q̇_d) − K_p (z_1 − q_d) − z_3)                                (3)
/// ```
///
/// # Guarantee
///
/// Frozen inertia of ratio `μ` to `M̄`, in continuous time: with `A_2 = K_d + 3ω_o`,
/// `A_1 = K_p + 3ω_o K_d + 3ω_o²` the characteristic polynomial is
///
/// ```text
/// μ s² (s³ + A_2 s² + A_1 s) + c_2 s² + c_1 s + c_0,
/// c_2 = 3ω_o K_p + 3ω_o² K_d + ω_o³,  c_1 = 3ω_o² K_p + ω_o³ K_d,  c_0 = ω_o³ K_p      (4)
/// ```
///
/// and the condition is that it is Hurwitz over the arm's range. Too small a `μ` (`M̄` too large) is the
/// dangerous end.
///
/// # Not claimed
///
/// The reduction of the window by sampling and delay: (4) is without them.
///
/// # References
///
/// Z. Gao, "Scaling and bandwidth-parameterization based controller tuning", ACC 2003; R. Miklosovic, A. Radke,
/// Z. Gao, "Discrete implementation and generalization of the extended state observer", ACC 2006. Grade A.
#[derive(Debug)]
pub(crate) struct Adrc {
    kp: f64,
    kd: f64,
    correction: [f64; 3],
    inertia: Vec<f64>,
    states: Vec<[f64; 3]>,
    started: bool,
    period: f64,
}

impl Adrc {
    /// (1), (2) for a joint.
    fn observe(&self, z: [f64; 3], q: f64, pushed: f64) -> [f64; 3] {
        let (h, ddq) = (self.period, z[2] + pushed);
        let predicted = [z[0] + h * z[1] + 0.5 * h * h * ddq, z[1] + h * ddq, z[2]];
        let off = q - predicted[0];
        core::array::from_fn(|i| predicted[i] + self.correction[i] * off)
    }
}

impl Rival for Adrc {
    const CARD: Card = Card {
        id: "adrc",
        title: "ADRC, positions only",
        reference: "",
        source: "Gao, ACC 2003; Miklosovic, Radke, Gao, ACC 2006",
        grade: Grade::A,
        caveat: "",
        law: "τ = M̄ (q̈_d − K_d (z₂ − q̇_d) − K_p (z₁ − q_d) − z₃),  z observed from q",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[
        BANDWIDTH,
        DAMPING,
        Scalar {
            name: "observer_bandwidth",
            unit: "rad/s",
            meaning: "ω_o, a triple pole",
            default: 150.0,
            low: 15.0,
            high: 1000.0,
        },
    ];
    type Sees<'a> = PositionsAndTorque<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Inertia;

    fn new(tuning: &Tuning, inertia: Inertia) -> Result<Self, RivalRefusal> {
        let [omega, zeta, observer] = tuning.values()?;
        let [kp, kd] = outer_gains(omega, zeta);
        let h = tuning.period();
        let beta = (-observer * h).exp();
        let rest = 1.0 - beta;
        let correction = [
            1.0 - beta * beta * beta,
            1.5 / h * rest * rest * (1.0 + beta),
            rest * rest * rest / (h * h),
        ];
        let inertia = inertia.values().to_vec();
        let states = vec![[0.0; 3]; inertia.len()];
        Ok(Self { kp, kd, correction, inertia, states, started: false, period: h })
    }

    fn update(
        &mut self,
        sees: PositionsAndTorque<'_>,
        wants: Acceleration<'_>,
        _: &[bool],
        tau: &mut [f64],
    ) {
        for (i, tau) in tau.iter_mut().enumerate() {
            let m = self.inertia[i];
            let z = if self.started {
                self.observe(self.states[i], sees.q[i], sees.tau[i] / m)
            } else {
                [sees.q[i], 0.0, 0.0]
            };
            self.states[i] = z;
            let (e, de) = (z[0] - wants.q[i], z[1] - wants.dq[i]);
            *tau = m * (wants.ddq[i] - self.kd * de - self.kp * e - z[2]);
        }
        self.started = true;
    }

    fn states(&self) -> usize {
        3 * self.states.len()
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let [omega, zeta, w] = tuning.values().ok()?;
        let [kp, kd] = outer_gains(omega, zeta);
        let outer = [kp + 3.0 * w * kd + 3.0 * w * w, kd + 3.0 * w];
        let c = [w * w * w * kp, w * w * (3.0 * kp + w * kd), w * (3.0 * kp + w * (3.0 * kd + w))];
        let stable = |mu: f64| hurwitz(&[c[0] / mu, c[1] / mu, c[2] / mu, outer[0], outer[1], 1.0]);
        let text = "(4) Hurwitz for every inertia ratio of the arm";
        Some(Condition::inside(text, arm.ratio, [edge(&stable, 0.5), edge(&stable, 2.0)]))
    }
}

/// The first inertia ratio from 1 on, by factors below or above 1, at which the loop is no longer stable, to 10⁻⁶;
/// beyond 10⁻⁶ or 10⁶ where there is none before.
fn edge(stable: &impl Fn(f64) -> bool, factor: f64) -> f64 {
    let mut inside = 1.0;
    while stable(inside * factor) {
        inside *= factor;
        if !(1e-6..=1e6).contains(&inside) {
            return inside;
        }
    }
    let mut outside = inside * factor;
    for _ in 0..20 {
        let middle = (inside * outside).sqrt();
        if stable(middle) { inside = middle } else { outside = middle }
    }
    inside
}

/// Returns true if a polynomial of degree 5, from the coefficient of `s⁰`, has all roots in the left
/// half-plane: Routh.
fn hurwitz(c: &[f64; 6]) -> bool {
    let (mut above, mut row) = ([c[5], c[3], c[1]], [c[4], c[2], c[0]]);
    for _ in 0..4 {
        if row[0] <= 0.0 {
            return false;
        }
        let ratio = above[0] / row[0];
        let next = [above[1] - ratio * row[1], above[2] - ratio * row[2], 0.0];
        (above, row) = (row, next);
    }
    row[0] > 0.0
}

#[cfg(test)]
mod tests {
    use super::hurwitz;

    #[test]
    fn hurwitz_by_roots_that_are_known() {
        // (s+1)^5, and (s+1)^3 (s² ± 0.1 s + 1).
        assert!(hurwitz(&[1.0, 5.0, 10.0, 10.0, 5.0, 1.0]));
        let product = |d: f64| [1.0, 3.0 + d, 4.0 + 3.0 * d, 4.0 + 3.0 * d, 3.0 + d, 1.0];
        assert!(hurwitz(&product(0.1)) && !hurwitz(&product(-0.1)));
    }
}
