//! PD with a torque that is fed forward from the reference alone.

use crate::card::{Card, Grade};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::facts::Nothing;
use crate::measured::{Acceleration, MeasuredMotion, Velocity};
use crate::nominal::Nominal;
use crate::rival::Rival;
use crate::rivals::pd::Pd;
use crate::tuning::{Scalar, Tuning};

/// PD in the drives, torque of the reference from above.
///
/// # Law
///
/// ```text
/// τ = τ_ff − K_P e − K_D ė,     τ_ff = M̂(q_d) q̈_d + Ĉ(q_d, q̇_d) q̇_d + Ĝ(q_d) + F̂ q̇_d      (1)
/// ```
///
/// The model receives no measurement: the feed-forward is as smooth as the reference, and can be computed
/// before the run.
///
/// # Guarantee
///
/// For an exact model the reference itself is a solution. At rest `e ≈ −(load)/K_P`.
///
/// # Not claimed
///
/// Anything about what the model lacks: there is no integral action.
///
/// # References
///
/// B. Katz, "A low cost modular actuator for dynamic robots", MIT, 2018 (drives that take
/// `q_d, q̇_d, K_P, K_D, τ_ff`); feed-forward as in C. H. An, C. G. Atkeson, J. M. Hollerbach, "Model-Based
/// Control of a Robot Manipulator", 1988. Grade A.
#[derive(Debug)]
pub(crate) struct FeedforwardPd {
    feedback: Pd,
    model: Nominal,
    forward: Vec<f64>,
}

impl Rival for FeedforwardPd {
    const CARD: Card = Card {
        id: "feedforward-pd",
        title: "PD in the drives with feed-forward torque",
        reference: "",
        source: "Katz, MIT, 2018; An, Atkeson, Hollerbach, Model-Based Control, 1988",
        grade: Grade::A,
        caveat: "",
        law: "τ = M̂(q_d) q̈_d + Ĉ(q_d, q̇_d) q̇_d + Ĝ(q_d) + F̂ q̇_d − K_P e − K_D ė",
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
        self.model.torque(wants.q, wants.dq, wants.dq, wants.ddq, &mut self.forward);
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
