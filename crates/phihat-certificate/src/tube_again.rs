//! The tube of a file, derived again from the study by the second method.

use phihat_study::{Spec, Study};
use serde::Serialize;

use crate::check::agree::agrees;
use crate::tube::{self, JointBeside, TubeInputs, TubeReference, TubeRefusal};
use crate::{Certificate, Gains, Refutation, Tube, TubePayloadSet};

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
    /// Clauses of the specification that the file's tube keeps and the second derivation does not: they rest on the
    /// first alone.
    pub first_only: Vec<String>,
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
                return Ok(Some(TubeAgain { on_trust, joints: vec![], first_only: vec![] }));
            }
        };
        let joints = tube::beside(claimed, &own)?;
        let first_only = first_only(&study.spec, claimed, &own);
        Ok(Some(TubeAgain { on_trust: None, joints, first_only }))
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
        Some(own.map(|own| own.steady_from(claimed.settle_s)))
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

/// Clauses that one tube keeps and the other does not.
fn first_only(spec: &Spec, claimed: &Tube, own: &Tube) -> Vec<String> {
    let integral = |tube: &Tube, i: usize| -> f64 {
        let joint = &tube.joints[i];
        let bins = joint.error_low_rad.iter().zip(&joint.error_high_rad);
        bins.map(|(low, high)| tube.bin_s * low.abs().max(high.abs())).sum()
    };
    let clauses: [BoundClause<'_>; 3] = [
        ("spec.error_bound_rad", &spec.error_bound, &|tube, i| tube.joints[i].error_bound_rad),
        ("spec.velocity_error_bound_rad_s", &spec.velocity_error_bound, &|tube, i| {
            tube.joints[i].velocity_error_bound_rad_s
        }),
        ("spec.error_integral_bound_rad_s", &spec.error_integral_bound, &integral),
    ];
    let mut list = Vec::new();
    for (key, limits, of) in clauses {
        for (i, limit) in limits.iter().flatten().enumerate() {
            let (first, second) = (of(claimed, i), of(own, i));
            if first <= *limit && (second.is_nan() || second > *limit) {
                let name = &claimed.joints[i].name;
                list.push(format!("{key} = {limit} on {name}: {second:.4e} is derived here"));
            }
        }
    }
    list
}

/// Key of a clause, its limits, and what a tube says of a joint.
type BoundClause<'a> = (&'static str, &'a Option<Vec<f64>>, &'a dyn Fn(&Tube, usize) -> f64);

#[cfg(test)]
mod tests {
    use phihat_study::Spec;

    use super::{Tube, first_only};
    use crate::{TubeJoint, TubePayloadSet};

    /// One joint, ten bins of 0.1 s, at this error throughout.
    fn tube(error_bound_rad: f64) -> Tube {
        let joint = TubeJoint {
            name: "joint1".to_owned(),
            error_low_rad: vec![-0.5 * error_bound_rad; 10],
            error_high_rad: vec![error_bound_rad; 10],
            velocity_low_rad_s: vec![0.0; 10],
            velocity_high_rad_s: vec![0.0; 10],
            error_bound_rad,
            velocity_error_bound_rad_s: 0.0,
            torque_max_nm: 1.0,
            torque_step_nm: vec![1.0; 10],
            torque_step_max_nm: 1.0,
            torque_step_steady_max_nm: 1.0,
        };
        let (frame, com_m) = ("tip".to_owned(), [(0.0, 0.0); 3]);
        Tube {
            bin_s: 0.1,
            duration_s: 1.0,
            settle_s: 0.0,
            slices: 1,
            payload: TubePayloadSet { frame, mass_kg: (0.0, 0.0), com_m, gyration_m: 0.0 },
            coulomb_nm: (vec![0.0], vec![0.0]),
            quantum_rad: vec![0.0],
            joints: vec![joint],
            limits_silent: true,
            tip: None,
        }
    }

    #[test]
    fn a_clause_rests_on_the_first_tube_where_that_alone_keeps_it() {
        let spec = Spec {
            error_bound: Some(vec![2.0]),
            velocity_error_bound: None,
            error_integral_bound: Some(vec![2.5]),
            tip_error_bound: None,
            settle: 0.0,
            settle_stated: true,
        };
        // The integral of |e| over a second is the error.
        for (claimed, derived, listed) in [
            (1.0, 1.5, 0),
            (1.0, 2.0, 0),
            (1.0, 2.1, 1),
            (2.0, 2.6, 2),
            (1.0, f64::NAN, 2),
            (2.1, 1.0, 0),
            (2.1, 2.2, 0),
            (2.6, 2.7, 0),
        ] {
            let list = first_only(&spec, &tube(claimed), &tube(derived));
            assert_eq!(list.len(), listed, "{claimed} {derived}: {list:?}");
            assert!(list.iter().all(|line| line.contains("joint1")), "{list:?}");
        }
    }
}
