//! Nonlinear H-infinity control of Chen, Lee and Feng, in the coordinates of Johansson.

use crate::card::{Card, Grade};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::measured::{Acceleration, MeasuredMotion};
use crate::nominal::Nominal;
use crate::rival::Rival;
use crate::tuning::{Scalar, Tuning};

/// Min-max optimal tracking by an algebraic solution of the game.
///
/// # Law
///
/// In print: weights `Q_1` on `ė`, `Q_2` on `e`, `R = β`, level `γ`, `(R⁻¹ − γ⁻²) R_1² = 1`, `T_{11} = R_1 Q_1`,
/// `T_{12} = R_1 Q_2`, `τ = M̂ (q̈_d − T_{11}⁻¹ T_{12} ė) − T_{11}⁻¹ (Ĉ s − u) + Ĉ q̇ + Ĝ`, `s = T_{11} ė + T_{12} e`,
/// `u = −R⁻¹ s`. For weights that are numbers `R_1` cancels:
///
/// ```text
/// s = ė + Λ e,   Λ = Q_2/Q_1,     τ = M̂ (q̈_d − Λ ė) + Ĉ(q, q̇)(q̇ − s) + Ĝ + F̂ (q̇ − s) − U s/β   (1)
/// ```
///
/// So neither `γ` nor the size of the weights is in the torque: two scalars are free. Friction is this file's, along
/// `q̇ − s`.
///
/// # Guarantee
///
/// Gain at most `γ` from mismatch to the cost for every `γ > √β`: the condition `β < γ²` of the source is met
/// by the choice of a level, so that gains fail it nowhere. With an exact model `V = ½ sᵀMs + Λ eᵀUe/β` has
/// `V̇ = −(ėᵀUė + Λ² eᵀUe)/β`.
///
/// # Not claimed
///
/// A bound on the error. The condition is the sampled one of the damping `1/β`.
///
/// # References
///
/// B.-S. Chen, T.-S. Lee, J.-H. Feng, "A nonlinear H-infinity control design in robotic systems under parameter
/// perturbation and external disturbance", Int. J. Control 59(2), 1994; R. Johansson, "Quadratic optimization of
/// motion coordination and control", IEEE T-AC 35(11), 1990. Grade A: public code read.
#[derive(Debug)]
pub(crate) struct ChenLeeFeng {
    crossover: f64,
    damping: Vec<f64>,
    model: Nominal,
    ddq_r: Vec<f64>,
    dq_r: Vec<f64>,
}

impl Rival for ChenLeeFeng {
    const CARD: Card = Card {
        id: "chen-lee-feng",
        title: "Nonlinear H∞ (Chen, Lee, Feng)",
        reference: "[37]",
        source: "Chen, Lee, Feng, Int. J. Control 59(2), 1994",
        grade: Grade::A,
        caveat: "",
        law: "τ = M̂ (q̈_d − Λ ė) + Ĉ q̇_r + Ĝ + F̂ q̇_r − U s/β,  s = ė + Λ e,  q̇_r = q̇ − s",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[
        Scalar {
            name: "crossover",
            unit: "1/s",
            meaning: "Λ, the ratio of the weights",
            default: 20.0,
            low: 2.0,
            high: 200.0,
        },
        Scalar {
            name: "damping",
            unit: "1/s",
            meaning: "1/β, the inverse weight of the torque",
            default: 200.0,
            low: 10.0,
            high: 1000.0,
        },
    ];
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Nominal;

    fn new(tuning: &Tuning, model: Nominal) -> Result<Self, RivalRefusal> {
        let [crossover, damping] = tuning.values()?;
        let zero = vec![0.0; model.joints()];
        let damping = tuning.per_joint(damping);
        Ok(Self { crossover, damping, model, ddq_r: zero.clone(), dq_r: zero })
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Acceleration<'_>,
        _: &[bool],
        tau: &mut [f64],
    ) {
        for i in 0..tau.len() {
            let (e, de) = (sees.q[i] - wants.q[i], sees.dq[i] - wants.dq[i]);
            self.ddq_r[i] = wants.ddq[i] - self.crossover * de;
            self.dq_r[i] = wants.dq[i] - self.crossover * e;
        }
        self.model.torque(sees.q, sees.dq, &self.dq_r, &self.ddq_r, tau);
        for (i, tau) in tau.iter_mut().enumerate() {
            *tau -= self.damping[i] * (sees.dq[i] - self.dq_r[i]);
        }
    }

    fn states(&self) -> usize {
        0
    }

    fn optimality(_: &Tuning) -> Option<Condition> {
        let text = "β < γ² for some level γ, which is free";
        Some(Condition { text, holds: true, margin: f64::INFINITY })
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let [_, damping] = tuning.values().ok()?;
        let floor = arm.ratio_min(damping, tuning.period());
        Some(Condition::above("T/β < cμ; c = 2, behind one sample of delay 1", arm.ratio[0], floor))
    }
}
