//! A study designed for and verified, as a user does it.

use std::path::Path;

use phihat_design::claims::Refutation;
use phihat_design::{Clause, Gains, Outcome as Designed, requested_gains};
use phihat_session::designed;
use phihat_study::Study;

use crate::claim::{AttackClaim, claimed};
use crate::draft::DraftLaws;
use crate::filtered::filter;
use crate::typed::{Claims, sketched, typed};

/// The result of a design, and what its certificate says of it.
#[derive(Debug)]
pub enum DesignVerdict {
    /// No gains, with the clauses in the way.
    Infeasible(Vec<Clause>),
    /// No claim, and why.
    NotProved(String),
    /// Gains whose certificate does not verify, although it refuses nothing or something else.
    Refuted(Box<Gains>, Refutation),
    /// Gains with a certificate, verified where all is claimed, and what it claims.
    Certified(Box<Gains>, AttackClaim),
}

/// Designs for a study and verifies what was found, as a user does it: through the text of gains.json.
pub fn judged(study: &Study, path: &Path) -> DesignVerdict {
    judged_by(study, (&DraftLaws::Designed, Claims::All), path)
}

/// Likewise, of the laws that the study itself states: the tube alone is claimed of them.
pub fn judged_as_typed(study: &Study, path: &Path) -> DesignVerdict {
    judged_by(study, (&DraftLaws::Typed { gains: String::new(), filter: None }, Claims::Tube), path)
}

/// Likewise, with laws from elsewhere: they get the certificate that a design would give them, those that were typed no
/// more of it than is asked.
pub(crate) fn judged_by(
    study: &Study,
    (laws, claims): (&DraftLaws, Claims),
    path: &Path,
) -> DesignVerdict {
    let own = requested_gains(study);
    let whole =
        claims == Claims::All || !matches!((laws, &own), (DraftLaws::Typed { .. }, Some(_)));
    let found = match (laws, own) {
        (DraftLaws::Typed { filter: drawn, .. }, Some(mut own)) => {
            if let Some(seed) = drawn {
                filter(&mut own, study.control.period_ns as f64 * 1e-9, *seed);
            }
            typed(study, own, (claims, path)).map_err(|why| format!("typed: {why}"))
        }
        (DraftLaws::Sketched(shares), _) => {
            sketched(study, shares, path).map_err(|why| format!("sketched: {why}"))
        }
        _ => designed(study, path).map_err(|why| format!("design: {why}")),
    };
    let gains = match found {
        Ok(Designed::Designed(gains)) => gains,
        Ok(Designed::Infeasible(no)) => return DesignVerdict::Infeasible(no.clauses),
        Err(why) => return DesignVerdict::NotProved(why),
    };
    let read = gains.to_json().and_then(|text| Gains::from_json(&text));
    let gains = match read {
        Ok(gains) => gains,
        Err(why) => return DesignVerdict::NotProved(format!("gains.json: {why}")),
    };
    if whole
        && let Some(certificate) = &gains.certificate
        && let Err(why) = certificate.verify(&gains)
    {
        // What the document itself refuses it may refuse, in the same words.
        return if certificate.refused().is_some_and(|own| own.claim == why.claim) {
            DesignVerdict::NotProved(format!("verify: {why}"))
        } else {
            DesignVerdict::Refuted(Box::new(gains), why)
        };
    }
    match claimed(&gains, study) {
        Ok(claim) => DesignVerdict::Certified(Box::new(gains), claim),
        Err(why) => DesignVerdict::NotProved(why.to_string()),
    }
}
