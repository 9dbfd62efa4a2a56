//! The paper's law with the gains that this project's design gives: nothing is left to tune.

use crate::card::{Card, Grade};
use crate::error::RivalRefusal;
use crate::facts::Designed;
use crate::measured::{Acceleration, MotionAndTorque};
use crate::rival::Rival;
use crate::rivals::proposed::{PRINTED, ProposedLaw};
use crate::tuning::{Scalar, Tuning};

/// The law of [`ProposedFirst`](super::proposed::ProposedFirst) and [`Second`](super::proposed::Second) with gains that
/// a design found for a specification: what a user gets who states the error to live with and runs no tuner.
///
/// # Law
///
/// ```text
/// τ = M̄ (q̈_d − K_d ė − K_p e) + φ̂,     Φ̂(s) = Φ(s) Σ_{i<m} a_i s^i/(s^m + Σ_{i<m} a_i s^i)          (1)
/// ```
///
/// with `M̄, K_p, K_d, a_i` per joint as they were designed; `m` is the design's choice.
///
/// # Guarantee
///
/// The certificate that comes with the gains; whoever hands them over has it.
///
/// # Not claimed
///
/// That they are the gains of least error: the design looks for the least torque noise that keeps the specification.
///
/// # References
///
/// Hayat, Leibold, Buss (2018), (6), (8); observer form and design are this project's.
#[derive(Debug)]
pub(crate) struct ProposedDesigned {
    law: ProposedLaw,
    states: usize,
}

impl Rival for ProposedDesigned {
    const CARD: Card = Card {
        id: "proposed-designed",
        title: "Proposed, gains by design (this project)",
        reference: "proposed",
        source: "Hayat, Leibold, Buss, 2018, in observer form with M̄; `phihat design`",
        grade: Grade::A,
        caveat: "",
        law: "τ = M̄ (q̈_d − K_d ė − K_p e) + φ̂,  all gains from `phihat design` for the specification",
        printed: Some(PRINTED),
    };
    const SCALARS: &'static [Scalar] = &[];
    type Sees<'a> = MotionAndTorque<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Designed;

    fn new(tuning: &Tuning, designed: Designed) -> Result<Self, RivalRefusal> {
        let joints = designed.joints();
        let law = ProposedLaw::of(joints, tuning.period())?;
        Ok(Self { law, states: joints.iter().map(|joint| joint.a.len()).sum() })
    }

    fn update(
        &mut self,
        sees: MotionAndTorque<'_>,
        wants: Acceleration<'_>,
        _: &[bool],
        tau: &mut [f64],
    ) {
        self.law.update(sees, wants, tau);
    }

    fn states(&self) -> usize {
        self.states
    }
}
