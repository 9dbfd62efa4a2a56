//! The H-infinity inverse-optimal PID of Choi, Chung and Suh.

use crate::card::{Card, Grade, Tick, Ticks};
use crate::claim::{Arm, Condition};
use crate::error::Refusal;
use crate::needs::{Motion, Nothing, Velocity};
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
    const SCALARS: &'static [Scalar] = &[
        Scalar {
            name: "proportional",
            unit: "1/s",
            meaning: "K_P of the error's own dynamics",
            default: 40.0,
            low: 4.0,
            high: 400.0,
        },
        Scalar {
            name: "integral",
            unit: "1/s²",
            meaning: "K_I of the same",
            default: 200.0,
            low: 2.0,
            high: 2e4,
        },
        Scalar {
            name: "gain",
            unit: "1/s",
            meaning: "K, what pays for the cost",
            default: 80.0,
            low: 4.0,
            high: 800.0,
        },
        Scalar {
            name: "attenuation",
            unit: "s^½",
            meaning: "γ, per unit of inertia",
            default: 0.15,
            low: 0.03,
            high: 3.0,
        },
    ];
    type Sees<'a> = Motion<'a>;
    type Wants<'a> = Velocity<'a>;
    type Knows = Nothing;

    fn new(tuning: &Tuning, _: Nothing) -> Result<Self, Refusal> {
        let [proportional, integral, gain, gamma] = tuning.values()?;
        let gain = tuning.per_joint(gain + 1.0 / (gamma * gamma));
        let (sum, period) = (vec![0.0; tuning.joints()], tuning.period());
        Ok(Self { proportional, integral, gain, sum, period })
    }

    fn update(&mut self, sees: Motion<'_>, wants: Velocity<'_>, clipped: &[bool], tau: &mut [f64]) {
        for (i, tau) in tau.iter_mut().enumerate() {
            let (e, de) = (sees.q[i] - wants.q[i], sees.dq[i] - wants.dq[i]);
            if !clipped[i] {
                self.sum[i] += self.period * e;
            }
            *tau = -self.gain[i] * (de + self.proportional * e + self.integral * self.sum[i]);
        }
    }

    fn states(&self) -> usize {
        self.sum.len()
    }

    fn condition(tuning: &Tuning, _: &Arm) -> Option<Condition> {
        let [proportional, integral, _, _] = tuning.values().ok()?;
        Some(Condition::above("K_P² > 2 K_I", proportional * proportional, 2.0 * integral))
    }
}
