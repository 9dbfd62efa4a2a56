//! Second derivation, from the study, of the data that the clause of elastic joints rests on.

use phihat_study::Study;

use super::document::{ElasticJoint, ElasticJoints, EncoderSide};
use crate::{Certificate, Refutation};

const CLAIM: &str = "elastic joints";

impl Certificate {
    /// Checks that springs, rotors and encoder are the study's, and looks at the range of the links again; `None`: the
    /// certificate has no clause of elastic joints.
    pub(crate) fn derive_elastic(&self, study: &Study) -> Result<Option<String>, Refutation> {
        let stated = ElasticJoint::of(study);
        let Some(elastic) = &self.elastic else {
            let what = "the study states springs: stable with them, or refused";
            let said = stated.is_none() || self.elastic_refused.is_some();
            Refutation::unless(CLAIM, what, 0.0, 1.0, said)?;
            return Ok(None);
        };
        let what = "the study states the springs of the clause";
        Refutation::unless(CLAIM, what, 0.0, 1.0, stated.is_some())?;
        elastic.is_of(study, &stated.unwrap_or_default())?;
        let mut links = study.clone();
        links.robot = links.robot.links_alone();
        let range = elastic.links.derive_range(&links)?;
        Ok(Some(format!(
            "springs, rotors and encoder are the study's; range of the links: {range}"
        )))
    }
}

impl ElasticJoints {
    fn is_of(&self, study: &Study, stated: &[ElasticJoint]) -> Result<(), Refutation> {
        let same = self.encoder == EncoderSide::of(study);
        Refutation::unless(CLAIM, "the encoder's side is the study's", 0.0, 1.0, same)?;
        let (own, right) = (self.joints.len(), stated.len());
        Refutation::unless(CLAIM, "one entry per joint", own as f64, right as f64, own == right)?;
        for ((own, right), joint) in self.joints.iter().zip(stated).zip(&study.robot.joints) {
            let ends = |of: &ElasticJoint| {
                let stiffness = (of.stiffness_nm_rad.0, of.stiffest());
                [of.rotor_kg_m2, stiffness, of.damping_nm_s_rad]
            };
            let names = ["rotor", "stiffness", "damping"];
            for ((what, own), right) in names.iter().zip(ends(own)).zip(ends(right)) {
                let holds = own.0 <= right.0 && right.1 <= own.1;
                let what = format!("{what} holds the study's interval");
                Refutation::unless(CLAIM, &what, own.0, right.0, holds)
                    .map_err(|why| why.on(&joint.name))?;
            }
        }
        Ok(())
    }
}
