//! Proportional-derivative control of every joint.

use crate::card::{Card, Grade};
use crate::error::RivalRefusal;
use crate::facts::Nothing;
use crate::measured::{MeasuredMotion, Velocity};
use crate::rival::Rival;
use crate::tuning::{Scalar, Tuning};

/// PD.
///
/// # Law
///
/// ```text
/// τ = −K_P e − K_D ė,     K_P = U ω²,  K_D = 2 ζ ω U                                   (1)
/// ```
///
/// `U` is the unit of the joint \[kg·m²\], `e = q − q_d`.
///
/// # Not claimed
///
/// Tracking without error: gravity, inertia and friction leave `e ≈ −(load)/K_P`.
///
/// # References
///
/// Textbook; grade A.
#[derive(Debug)]
pub(crate) struct Pd {
    stiffness: Vec<f64>,
    damping: Vec<f64>,
}

impl Rival for Pd {
    const CARD: Card = Card {
        id: "pd",
        title: "PD",
        reference: "",
        source: "textbook",
        grade: Grade::A,
        caveat: "",
        law: "τ = −K_P e − K_D ė",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[
        Scalar {
            name: "bandwidth",
            unit: "rad/s",
            meaning: "ω of the error with the joint's nominal inertia",
            default: 20.0,
            low: 2.0,
            high: 200.0,
        },
        Scalar {
            name: "damping",
            unit: "",
            meaning: "ζ of the same",
            default: 1.0,
            low: 0.3,
            high: 3.0,
        },
    ];
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Velocity<'a>;
    type Knows = Nothing;

    fn new(tuning: &Tuning, _: Nothing) -> Result<Self, RivalRefusal> {
        let [omega, zeta] = tuning.values()?;
        let (stiffness, damping) = (omega * omega, 2.0 * zeta * omega);
        Ok(Self { stiffness: tuning.per_joint(stiffness), damping: tuning.per_joint(damping) })
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Velocity<'_>,
        _: &[bool],
        tau: &mut [f64],
    ) {
        for (i, tau) in tau.iter_mut().enumerate() {
            let (e, de) = (sees.q[i] - wants.q[i], sees.dq[i] - wants.dq[i]);
            *tau = -self.stiffness[i] * e - self.damping[i] * de;
        }
    }

    fn states(&self) -> usize {
        0
    }
}
