//! PD+: PD control and the torque of the reference motion.

use crate::card::{Card, Grade};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::facts::Nothing;
use crate::measured::{Acceleration, MeasuredMotion, Velocity};
use crate::nominal::Nominal;
use crate::rival::Rival;
use crate::rivals::pd::Pd;
use crate::tuning::{Scalar, Tuning};

/// PD+.
///
/// # Law
///
/// ```text
/// τ = M̂(q) q̈_d + Ĉ(q, q̇) q̇_d + Ĝ(q) + F̂ q̇_d − K_P e − K_D ė                             (1)
/// ```
///
/// # Guarantee
///
/// With the true model the error goes to zero from anywhere: `V = ½ ėᵀMė + ½ eᵀK_P e`,
/// `dV/dt = −ėᵀ(K_D + F)ė`.
///
/// # Not claimed
///
/// Anything about what the model lacks: there is no integral action.
///
/// # References
///
/// B. Paden, R. Panja, "Globally asymptotically stable 'PD+' controller for robot manipulators", Int. J. Control
/// 47(6), 1988. Grade A.
#[derive(Debug)]
pub(crate) struct PdPlus {
    feedback: Pd,
    model: Nominal,
    forward: Vec<f64>,
}

impl Rival for PdPlus {
    const CARD: Card = Card {
        id: "pd-plus",
        title: "PD+",
        reference: "",
        source: "Paden, Panja, Int. J. Control 47(6), 1988",
        grade: Grade::A,
        caveat: "",
        law: "τ = M̂ q̈_d + Ĉ q̇_d + Ĝ + F̂ q̇_d − K_P e − K_D ė",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = Pd::SCALARS;
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Nominal;

    fn new(tuning: &Tuning, model: Nominal) -> Result<Self, RivalRefusal> {
        let feedback = Pd::new(tuning, Nothing)?;
        Ok(Self { feedback, model, forward: vec![0.0; tuning.joints()] })
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Acceleration<'_>,
        clipped: &[bool],
        tau: &mut [f64],
    ) {
        self.feedback.update(sees, Velocity { q: wants.q, dq: wants.dq }, clipped, tau);
        self.model.torque(sees.q, sees.dq, wants.dq, wants.ddq, &mut self.forward);
        tau.iter_mut().zip(&self.forward).for_each(|(tau, forward)| *tau += forward);
    }

    fn states(&self) -> usize {
        0
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let [omega, zeta] = tuning.values().ok()?;
        let (gain, period) = (2.0 * zeta * omega, tuning.period());
        Some(Condition::sampled("K_D T below the smallest inertia's limit", gain, period, arm))
    }
}
