//! Computed torque: the nominal model cancels the arm's dynamics.

use crate::card::{Card, Grade};
use crate::error::RivalRefusal;
use crate::measured::{Acceleration, MeasuredMotion};
use crate::nominal::Nominal;
use crate::rival::Rival;
use crate::rivals::pd::Pd;
use crate::tuning::{Scalar, Tuning};

/// Computed torque (inverse dynamics).
///
/// # Law
///
/// ```text
/// τ = M̂(q) (q̈_d − K_d ė − K_p e) + Ĉ(q, q̇) q̇ + Ĝ(q) + F̂ q̇                              (1)
/// ```
///
/// With an exact model `ë + K_d ė + K_p e = 0`. Otherwise the right-hand side is
/// `(M⁻¹M̂ − 1)(q̈_d − K_d ė − K_p e) + M⁻¹(n̂ − n)`.
///
/// # Not claimed
///
/// Anything about what the model lacks: there is no integral action.
///
/// # References
///
/// J. J. Craig, "Introduction to Robotics", 2005; the paper's (2) to (4). Grade A.
#[derive(Debug)]
pub(crate) struct ComputedTorque {
    kp: f64,
    kd: f64,
    model: Nominal,
    wanted: Vec<f64>,
}

impl Rival for ComputedTorque {
    const CARD: Card = Card {
        id: "computed-torque",
        title: "Computed torque",
        reference: "[8]",
        source: "J. J. Craig, Introduction to Robotics, 2005",
        grade: Grade::A,
        caveat: "",
        law: "τ = M̂ (q̈_d − K_d ė − K_p e) + Ĉ q̇ + Ĝ + F̂ q̇",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = Pd::SCALARS;
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Nominal;

    fn new(tuning: &Tuning, model: Nominal) -> Result<Self, RivalRefusal> {
        let [omega, zeta] = tuning.values()?;
        let wanted = vec![0.0; model.joints()];
        Ok(Self { kp: omega * omega, kd: 2.0 * zeta * omega, model, wanted })
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Acceleration<'_>,
        _: &[bool],
        tau: &mut [f64],
    ) {
        for (i, wanted) in self.wanted.iter_mut().enumerate() {
            let (e, de) = (sees.q[i] - wants.q[i], sees.dq[i] - wants.dq[i]);
            *wanted = wants.ddq[i] - self.kd * de - self.kp * e;
        }
        self.model.torque(sees.q, sees.dq, sees.dq, &self.wanted, tau);
    }

    fn states(&self) -> usize {
        0
    }
}
