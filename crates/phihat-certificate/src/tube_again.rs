//! The tube of a file, derived again from the study by the second method.

use phihat_study::Study;
use serde::Serialize;

use crate::check::agree::agrees;
use crate::clauses::tube_clauses;
use crate::extremes::smaller;
use crate::tube::{self, JointBeside, TubeInputs, TubeReference, TubeRefusal};
use crate::{Certificate, Gains, Refutation, Settle, Tube, TubePayloadSet};

const CLAIM: &str = "tube";

/// Two ways to compute the same number.
const SAME: f64 = 1e-9;

/// Result of a second derivation of a file's tube.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TubeAgain {
    /// Why it could not be derived: the tube is on trust. `None`: it was.
    pub on_trust: Option<String>,
    /// Claimed beside derived, joint by joint; empty where it is on trust.
    pub joints: Vec<JointBeside>,
    /// Clauses of the study's specification that the wider of both tubes does not keep, but for those that the file
    /// lists itself.
    pub unkept: Vec<String>,
    /// The wider of both tubes, bin by bin; `None`: the file's is on trust.
    #[serde(skip)]
    pub wider: Option<Box<Tube>>,
}

impl Certificate {
    /// Derives the tube again, and holds the file's against it. `None`: the file has none.
    ///
    /// # Not claimed
    ///
    /// That the file's tube is true where it is tighter than the derived one: [`JointBeside::tighter`] says
    /// by how much.
    ///
    /// # Errors
    ///
    /// [`Refutation`]: it is about another study, or claims more than is derived here.
    pub fn derive_tube(
        &self,
        gains: &Gains,
        (study, reference): (&Study, &TubeReference),
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Option<TubeAgain>, Refutation> {
        let Some(claimed) = &self.tube else { return Ok(None) };
        self.tube_is_of(study)?;
        self.tip_is_of(study, reference)?;
        let own = match self.tube_again(gains, (study, reference), progress) {
            None => return Ok(None),
            Some(Ok(own)) => own,
            Some(Err(why)) => {
                let on_trust = Some(why.to_string());
                return Ok(Some(TubeAgain {
                    on_trust,
                    joints: vec![],
                    unkept: vec![],
                    wider: None,
                }));
            }
        };
        let joints = tube::beside(claimed, &own)?;
        let unkept = tube_clauses(study, (claimed, &own), &self.unproved);
        let wider = Some(Box::new(claimed.clone().widened_to(&own)));
        Ok(Some(TubeAgain { on_trust: None, joints, unkept, wider }))
    }

    /// The tube that the second method derives for these gains, with the file's bins and settling time.
    /// `None`: the file has none.
    pub fn tube_again(
        &self,
        gains: &Gains,
        (study, reference): (&Study, &TubeReference),
        progress: &(dyn Fn(f64) + Sync),
    ) -> Option<Result<Tube, TubeRefusal>> {
        let claimed = self.tube.as_ref()?;
        let (low, high) = &study.design.coulomb;
        let inputs = TubeInputs {
            study,
            joints: &gains.joints,
            velocity_filter_hz: self.joints.first().and_then(|j| j.model.velocity_filter_hz),
            reference,
            payload: Some(&study.design.payload),
            slices: claimed.slices,
            coulomb: (low, high),
            bin_s: claimed.bin_s,
        };
        let own = tube::derive(&inputs, progress);
        // A file may claim that the steady part begins later than the derived tube has it, and so leave errors out.
        let steady = |own: Tube| {
            let latest = Settle::of(study, Some(&own)).settle_s;
            own.steady_from(smaller(claimed.settle_s, latest))
        };
        Some(own.map(steady))
    }

    /// Checks that what the tube says of the tip is of the study's arm along its motion; see [`crate::TubeTip::is_of`].
    ///
    /// # Errors
    ///
    /// The first [`Refutation`].
    pub fn tip_is_of(&self, study: &Study, reference: &TubeReference) -> Result<(), Refutation> {
        let Some(tube) = &self.tube else { return Ok(()) };
        tube.tip.as_ref().map_or(Ok(()), |tip| tip.is_of(study, reference, tube))
    }

    /// Checks that the tube is about what the study says: payloads, friction, encoders, settling time.
    ///
    /// # Errors
    ///
    /// The first [`Refutation`].
    pub fn tube_is_of(&self, study: &Study) -> Result<(), Refutation> {
        let Some(claimed) = &self.tube else { return Ok(()) };
        let same = |what: &str, truth| Refutation::unless(CLAIM, what, 0.0, 1.0, truth);
        let payload = TubePayloadSet::from(&study.design.payload);
        same("payloads are the study's", claimed.payload == payload)?;
        let levels = claimed.coulomb_nm == study.design.coulomb;
        same("levels of dry friction are the study's", levels)?;
        let bits = study.sensor.encoder_bits.as_ref();
        for (i, own) in claimed.quantum_rad.iter().enumerate() {
            let bits = bits.and_then(|bits| bits.get(i));
            let quantum = bits.map_or(0.0, |bits| crate::TorqueNoise::quantum(*bits));
            agrees(CLAIM, "quantum is the encoder's", (own + 1.0, quantum + 1.0), 1e-12)?;
        }
        if study.spec.settle_stated {
            let sides = (claimed.settle_s + 1.0, study.spec.settle + 1.0);
            agrees(CLAIM, "settling time is the study's", sides, SAME)?;
        }
        Ok(())
    }
}
