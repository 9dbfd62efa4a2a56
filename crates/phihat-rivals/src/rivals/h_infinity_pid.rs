//! The H-infinity inverse-optimal PID of Choi, Chung and Suh.

use crate::card::{Card, Grade, Tick, Ticks};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::facts::Nothing;
use crate::measured::{MeasuredMotion, Velocity};
use crate::rival::Rival;
use crate::tuning::{Scalar, Tuning};

/// Inverse-optimal PID.
///
/// # Law
///
/// ```text
/// s = ė + K_P e + K_I ∫e,     τ = −(K + 1/γ²) s                                        (1)
/// ```
///
/// `K` and `1/γ²` are per unit of the joint's inertia. The integral stands still while its joint's torque is
/// limited.
///
/// # Guarantee
///
/// With `K_P² > 2 K_I` (2), for the true `M(q)` and `C(q, q̇)`: with `x = (∫e, e, ė)`,
/// `V = ½ sᵀMs + ½ [∫e; e]ᵀ [K_I K_P K, K_I K; K_I K, K_P K] [∫e; e]`,
/// `Q = diag(K_I² K, (K_P² − 2 K_I) K, K)`, `R = (K + 1/γ²)⁻¹`
///
/// ```text
/// ∫(xᵀQx + τᵀRτ) dt ≤ γ² ∫|w|² dt + 2 V(0)                                            (3)
/// ```
///
/// where `w` is everything else that acts: gravity, friction, and the inertia that the reference has to move.
/// Sampled, `(K + 1/γ²) T < 2 λ_min(M)` as well.
///
/// As `V̇ ≤ −½ xᵀQ_γ x + ½ γ² |w|²`, `Q_γ = Q + (K + 1/γ²) ΠᵀΠ`, `s = Πx`, the error ends on the smallest level set
/// of `V` that holds the ellipsoid `xᵀQ_γ x ≤ γ² w²`. With `V ≤ ½ xᵀHx` for the largest inertia ratio
///
/// ```text
/// |e_j|² ≤ γ² tr(Q_γ⁻¹ H) K_P/(K (K_P² − K_I)) Σ_i w_i²/U_i / U_j                      (4)
/// ```
///
/// # Not claimed
///
/// (4) for a `w` beyond the declared one, which is the torque that the motion demands: what the error itself adds to
/// `w` (inertia and Coriolis times `K_P ė`, …) is left out.
///
/// # References
///
/// Y. Choi, W. K. Chung, I. H. Suh, "Performance and H-infinity optimality of PID trajectory tracking controller
/// for Lagrangian systems", IEEE Trans. Robotics and Automation 17(6), 2001. Grade A for the law.
#[derive(Debug)]
pub(crate) struct HInfinityPid {
    proportional: f64,
    integral: f64,
    gain: Vec<f64>,
    /// `∫e` \[rad·s\] per joint.
    sum: Vec<f64>,
    period: f64,
}

pub(crate) const PROPORTIONAL: Scalar = Scalar {
    name: "proportional",
    unit: "1/s",
    meaning: "K_P of the error's own dynamics",
    default: 40.0,
    low: 4.0,
    high: 400.0,
};
pub(crate) const INTEGRAL: Scalar = Scalar {
    name: "integral",
    unit: "1/s²",
    meaning: "K_I of the same",
    default: 200.0,
    low: 2.0,
    high: 2e4,
};
pub(crate) const GAIN: Scalar = Scalar {
    name: "gain",
    unit: "1/s",
    meaning: "K, what pays for the cost",
    default: 80.0,
    low: 4.0,
    high: 800.0,
};
pub(crate) const ATTENUATION: Scalar = Scalar {
    name: "attenuation",
    unit: "s^½",
    meaning: "γ, per unit of inertia",
    default: 0.15,
    low: 0.03,
    high: 3.0,
};

/// Condition (2) for `K_P, K_I`, which the proof of optimality requires.
pub(crate) fn proof([proportional, integral]: [f64; 2]) -> Condition {
    Condition::above("K_P² > 2 K_I", proportional * proportional, 2.0 * integral)
}

/// Condition that both (2) and the sampled condition hold for `K_P, K_I, K, γ`.
pub(crate) fn certificate(values: [f64; 4], period: f64, arm: &DeclaredArm) -> Condition {
    let [proportional, integral, gain, gamma] = values;
    let text = "K_P² > 2 K_I and (K + 1/γ²) T < cμ; c = 2, behind one sample of delay 1";
    let sampled = Condition::sampled(text, gain + 1.0 / (gamma * gamma), period, arm);
    sampled.and(&proof([proportional, integral]))
}

impl HInfinityPid {
    pub(crate) fn with(values: [f64; 4], tuning: &Tuning) -> Self {
        let [proportional, integral, gain, gamma] = values;
        let gain = tuning.per_joint(gain + 1.0 / (gamma * gamma));
        let (sum, period) = (vec![0.0; tuning.joints()], tuning.period());
        Self { proportional, integral, gain, sum, period }
    }

    /// `K_P, K_I`.
    pub(crate) fn error_gains(&self) -> [f64; 2] {
        [self.proportional, self.integral]
    }

    /// `K + 1/γ²` of a joint \[N·m·s/rad\].
    pub(crate) fn gain(&self, joint: usize) -> f64 {
        self.gain[joint]
    }

    /// (1) about a position and a velocity to follow.
    pub(crate) fn answer(
        &mut self,
        sees: MeasuredMotion<'_>,
        [q, dq]: [&[f64]; 2],
        clipped: &[bool],
        tau: &mut [f64],
    ) {
        for (i, tau) in tau.iter_mut().enumerate() {
            let (e, de) = (sees.q[i] - q[i], sees.dq[i] - dq[i]);
            if !clipped[i] {
                self.sum[i] += self.period * e;
            }
            *tau = -self.gain[i] * (de + self.proportional * e + self.integral * self.sum[i]);
        }
    }
}

/// Largest e, up to `Σ w²/U / U_j`, on the level set of `V` that holds all `x` with `V̇ ≥ 0`: (4).
fn ultimate_gain([kp, ki, k, gamma]: [f64; 4], ratio_max: f64) -> Option<f64> {
    if kp * kp <= 2.0 * ki {
        return None;
    }
    // Q_γ = diag(q) + r π πᵀ, π = (K_I, K_P, 1); its inverse by Sherman and Morrison.
    let (pi, r) = ([ki, kp, 1.0], k + 1.0 / (gamma * gamma));
    let q = [ki * ki * k, (kp * kp - 2.0 * ki) * k, k];
    let shrink = r / (1.0 + r * (0..3).map(|i| pi[i] * pi[i] / q[i]).sum::<f64>());
    let inverse = |i: usize, j: usize| {
        let own = if i == j { 1.0 / q[i] } else { 0.0 };
        own - shrink * pi[i] / q[i] * pi[j] / q[j]
    };
    let p = [[ki * kp * k, ki * k], [ki * k, kp * k]];
    let mut trace = 0.0;
    for i in 0..3 {
        for j in 0..3 {
            let rest = if i < 2 && j < 2 { p[i][j] } else { 0.0 };
            trace += inverse(i, j) * (ratio_max * pi[i] * pi[j] + rest);
        }
    }
    // e² ≤ 2 V (P⁻¹)_ee, 2 V ≤ trace γ² Σ w²/U.
    Some(gamma * (trace * kp / (k * (kp * kp - ki))).sqrt())
}

impl Rival for HInfinityPid {
    const CARD: Card = Card {
        id: "h-infinity-pid",
        title: "H∞ PID (Choi, Chung, Suh)",
        reference: "[12]",
        source: "Choi, Chung, Suh, IEEE T-RA 17(6), 2001",
        grade: Grade::A,
        caveat: "",
        law: "τ = −(K + 1/γ²)(ė + K_P e + K_I ∫e)",
        printed: Some(Ticks {
            quantitative: Tick::Yes,
            easy: Tick::No,
            optimal: Tick::Yes,
            model_free: Tick::Yes,
        }),
    };
    const SCALARS: &'static [Scalar] = &[PROPORTIONAL, INTEGRAL, GAIN, ATTENUATION];
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Velocity<'a>;
    type Knows = Nothing;

    fn new(tuning: &Tuning, _: Nothing) -> Result<Self, RivalRefusal> {
        Ok(Self::with(tuning.values()?, tuning))
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Velocity<'_>,
        clipped: &[bool],
        tau: &mut [f64],
    ) {
        self.answer(sees, [wants.q, wants.dq], clipped, tau);
    }

    fn states(&self) -> usize {
        self.sum.len()
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        Some(certificate(tuning.values().ok()?, tuning.period(), arm))
    }

    fn optimality(tuning: &Tuning) -> Option<Condition> {
        let [proportional, integral, ..] = tuning.values::<4>().ok()?;
        Some(proof([proportional, integral]))
    }

    fn bound(tuning: &Tuning, arm: &DeclaredArm) -> Option<Vec<f64>> {
        let gain = ultimate_gain(tuning.values().ok()?, arm.ratio[1])?;
        let acting = arm.demand_max.iter().zip(tuning.units()).map(|(w, unit)| w * w / unit);
        let acting = acting.sum::<f64>().sqrt();
        Some(tuning.units().iter().map(|unit| gain * acting / unit.sqrt()).collect())
    }
}
