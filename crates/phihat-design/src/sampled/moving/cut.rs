//! A loop that may have a moving inertia in it, cut where its torque meets that.

use crate::JointRecord;
use crate::claims::{Refutation, UnitLaw};
use crate::sampled::model::LoopModel;
use crate::sampled::open_loop::OpenLoop;
use crate::sampled::polynomial::SampledPolynomial;
use crate::sampled::refutation::{plausible, plausible_loop, refuse};

/// Claim that a refusal is about.
pub(super) const CLAIM: &str = "stability while moving";

/// One joint's loop, cut where its torque meets the inertia.
#[derive(Debug)]
pub(super) struct LoopCut<'a> {
    pub(super) gains: &'a JointRecord,
    pub(super) model: &'a LoopModel,
    pub(super) open: OpenLoop,
    /// `K`.
    pub(super) kick: SampledPolynomial,
}

impl<'a> LoopCut<'a> {
    /// Cuts a loop whose torque acts at once.
    pub(super) fn of(gains: &'a JointRecord, model: &'a LoopModel) -> Result<Self, Refutation> {
        plausible(CLAIM, gains)?;
        plausible_loop(CLAIM, model)?;
        if let Some(hz) = model.drive_bandwidth_hz {
            let inequality = "the torque acts at once: a drive's lag is not in the proof";
            return Err(refuse(CLAIM, inequality, hz, f64::MAX));
        }
        let (open, kick) = OpenLoop::with_kick(gains, model);
        Ok(Self { gains, model, open, kick })
    }

    /// Returns true if another joint's loop is this one, except for its name and `M̄`.
    pub(super) fn is_of(&self, gains: &JointRecord, model: &LoopModel) -> bool {
        let alike = UnitLaw::from(gains) == UnitLaw::from(self.gains);
        alike && gains.observer == self.gains.observer && model == self.model
    }
}
