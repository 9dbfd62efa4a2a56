//! PD control of every joint with the nominal gravity torque.

use crate::card::{Card, Grade};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::facts::Nothing;
use crate::measured::{MeasuredMotion, Velocity};
use crate::nominal::Gravity;
use crate::rival::Rival;
use crate::rivals::pd::Pd;
use crate::tuning::{Scalar, Tuning};

/// PD with gravity compensation.
///
/// # Law
///
/// ```text
/// τ = −K_P e − K_D ė + Ĝ(q),     K_P = U ω²,  K_D = 2 ζ ω U                            (1)
/// ```
///
/// # Guarantee
///
/// With the true `G` every set-point is globally asymptotically stable:
/// `V = ½ q̇ᵀMq̇ + ½ eᵀK_P e`, `dV/dt = −q̇ᵀK_D q̇`.
///
/// # Not claimed
///
/// Tracking without error: inertia, friction and the error of `Ĝ` leave `e ≈ −(load)/K_P`.
///
/// # References
///
/// M. Takegaki, S. Arimoto, "A new feedback method for dynamic control of manipulators", ASME J. Dynamic Systems,
/// Measurement, and Control 103(2), 1981. Grade A.
#[derive(Debug)]
pub(crate) struct PdGravity {
    feedback: Pd,
    model: Gravity,
    gravity: Vec<f64>,
}

impl Rival for PdGravity {
    const CARD: Card = Card {
        id: "pd-gravity",
        title: "PD with gravity compensation",
        reference: "",
        source: "Takegaki, Arimoto, ASME J. DSMC 103(2), 1981",
        grade: Grade::A,
        caveat: "",
        law: "τ = −K_P e − K_D ė + Ĝ(q)",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = Pd::SCALARS;
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Velocity<'a>;
    type Knows = Gravity;

    fn new(tuning: &Tuning, model: Gravity) -> Result<Self, RivalRefusal> {
        let feedback = Pd::new(tuning, Nothing)?;
        Ok(Self { feedback, model, gravity: vec![0.0; tuning.joints()] })
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Velocity<'_>,
        clipped: &[bool],
        tau: &mut [f64],
    ) {
        self.feedback.update(sees, wants, clipped, tau);
        self.model.torque(sees.q, &mut self.gravity);
        tau.iter_mut().zip(&self.gravity).for_each(|(tau, gravity)| *tau += gravity);
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
