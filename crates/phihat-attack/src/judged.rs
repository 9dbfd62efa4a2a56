//! A study designed for and verified, as a user does it.

use std::path::Path;

use phihat_design::claims::Refutation;
use phihat_design::{Clause, Gains, Outcome as Designed, requested_gains};
use phihat_session::designed;
use phihat_study::Study;

use crate::claim::{Claim, claimed};
use crate::draft::Laws;
use crate::filtered::filter;
use crate::typed::{Claims, sketched, typed};

/// The result of a design, and what its certificate says of it.
#[derive(Debug)]
pub enum Verdict {
    /// No gains, with the clauses in the way.
    Infeasible(Vec<Clause>),
    /// No claim, and why.
    NotProved(String),
    /// Gains whose certificate does not verify, although it refuses nothing or something else.
    Refuted(Box<Gains>, Refutation),
    /// Gains with a certificate, verified where all is claimed, and what it claims.
    Certified(Box<Gains>, Claim),
}

/// Designs for a study and verifies what was found, as a user does it: through the text of gains.json.
pub fn judged(study: &Study, path: &Path) -> Verdict {
    judged_by(study, (&Laws::Designed, Claims::All), path)
}

/// Likewise, of the laws that the study itself states: the tube alone is claimed of them.
pub fn judged_as_typed(study: &Study, path: &Path) -> Verdict {
    judged_by(study, (&Laws::Typed { gains: String::new(), filter: None }, Claims::Tube), path)
}

/// Likewise, with laws from elsewhere: they get the certificate that a design would give them, those that were typed no
/// more of it than is asked.
pub(crate) fn judged_by(study: &Study, (laws, claims): (&Laws, Claims), path: &Path) -> Verdict {
    let own = requested_gains(study);
    let whole = claims == Claims::All || !matches!((laws, &own), (Laws::Typed { .. }, Some(_)));
    let found = match (laws, own) {
        (Laws::Typed { filter: drawn, .. }, Some(mut own)) => {
            if let Some(seed) = drawn {
                filter(&mut own, study.control.period_ns as f64 * 1e-9, *seed);
            }
            typed(study, own, (claims, path)).map_err(|why| format!("typed: {why}"))
        }
        (Laws::Sketched(shares), _) => {
            sketched(study, shares, path).map_err(|why| format!("sketched: {why}"))
        }
        _ => designed(study, path).map_err(|why| format!("design: {why}")),
    };
    let gains = match found {
        Ok(Designed::Designed(gains)) => gains,
        Ok(Designed::Infeasible(no)) => return Verdict::Infeasible(no.clauses),
        Err(why) => return Verdict::NotProved(why),
    };
    let read = gains.to_json().and_then(|text| Gains::from_json(&text));
    let gains = match read {
        Ok(gains) => gains,
        Err(why) => return Verdict::NotProved(format!("gains.json: {why}")),
    };
    if whole
        && let Some(certificate) = &gains.certificate
        && let Err(why) = certificate.verify(&gains)
    {
        // What the document itself refuses it may refuse, in the same words.
        return if certificate.refused().is_some_and(|own| own.claim == why.claim) {
            Verdict::NotProved(format!("verify: {why}"))
        } else {
            Verdict::Refuted(Box::new(gains), why)
        };
    }
    match claimed(&gains, study) {
        Ok(claim) => Verdict::Certified(Box::new(gains), claim),
        Err(why) => Verdict::NotProved(why.to_string()),
    }
}
