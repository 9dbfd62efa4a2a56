//! Statement about the error of a drive before it begins: its bound with its standing, or the first clause in its way.

use phihat_design::{ClassBound, Gains, Verdict};
use phihat_model::JointKind;
use phihat_session::{BoundStanding, RecordedBound, SessionError, class_standing, tube_standing};
use phihat_study::{ReferenceRequest, Study};
use serde::Serialize;

use crate::preflight::{Check, CheckName, State};

/// Checks that a bound rests on: where a person accepted one that failed, there is none.
const RESTS_ON: [CheckName; 4] =
    [CheckName::Certificate, CheckName::Window, CheckName::Profile, CheckName::Description];

/// Bound on the error of a drive with its standing, or why there is none.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DriveBound {
    /// Largest bound on `|e|` of a joint \[rad\]; `None`: there is none.
    pub error_bound_rad: Option<f64>,
    /// Standing of that bound, as `phihat verify` has it; `None`: there is none.
    pub standing: Option<BoundStanding>,
    /// The statement in a sentence: the bound with its standing and its conditions, `DERIVED TWICE ≤ 0.264 mrad for …`,
    /// or `NOT PROVED: …` with the first clause that is in the way.
    pub sentence: String,
}

impl DriveBound {
    /// The same for the record of the run.
    pub(crate) fn recorded(&self) -> RecordedBound {
        let words = self.sentence.strip_prefix("NOT PROVED: ").unwrap_or(&self.sentence).to_owned();
        let own = self.standing.as_ref();
        let verdict = own.map_or(Verdict::NotProved, |standing| standing.verdict);
        let error_bound_rad = own.map(|standing| standing.each_rad.clone()).unwrap_or_default();
        RecordedBound { verdict, error_bound_rad, words }
    }
}

/// The first clause that is in the way of a bound.
#[derive(Debug)]
struct Unbounded(String);

impl Unbounded {
    fn of(why: &str) -> Self {
        Self(why.to_owned())
    }
}

/// Subject of a drive, as far as a bound depends on it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Subject<'a> {
    pub(crate) study: &'a Study,
    /// The study before a motion from a file took the place of its own; `None`: a first motion is driven.
    pub(crate) own: Option<&'a Study>,
    pub(crate) gains: &'a Gains,
}

impl DriveBound {
    /// Checks the claim that a drive rests on once more, as `phihat verify --study` does; that of a class takes
    /// seconds.
    pub(crate) fn of(subject: Subject<'_>, checks: &[Check]) -> Result<Self, SessionError> {
        Ok(match bound(subject, checks)? {
            Ok((standing, scope)) => Self {
                error_bound_rad: Some(standing.error_bound_rad),
                sentence: format!("{} {scope}", standing.words),
                standing: Some(standing),
            },
            Err(Unbounded(why)) => Self {
                error_bound_rad: None,
                standing: None,
                sentence: format!("NOT PROVED: {why}"),
            },
        })
    }
}

/// The largest bound of a joint, and its scope; else the first clause that is in the way.
type FoundBound = Result<(BoundStanding, String), Unbounded>;

fn bound(subject: Subject<'_>, checks: &[Check]) -> Result<FoundBound, SessionError> {
    let Subject { study, own, gains } = subject;
    let Some(own) = own else {
        let why = "a first motion, whose gains are cautious and not certified";
        return Ok(Err(Unbounded::of(why)));
    };
    let Some(certificate) = &gains.certificate else {
        return Ok(Err(Unbounded::of("the gains carry no certificate")));
    };
    if let Some(why) = certificate.refused() {
        return Ok(Err(Unbounded(why.to_string())));
    }
    if gains.study_sha256 != own.sha256 {
        return Ok(Err(Unbounded::of("the certificate is about another study")));
    }
    let accepted =
        |check: &&Check| check.state == State::Accepted && RESTS_ON.contains(&check.name);
    if let Some(check) = checks.iter().find(accepted) {
        let why = format!("driven in spite of the check `{}`", check.name.word());
        return Ok(Err(Unbounded(why)));
    }
    if study.springs.stated().is_some() {
        let why = "joints bend as the study states: bounds are those of rigid joints";
        return Ok(Err(Unbounded::of(why)));
    }
    if let Some(class) = &certificate.class {
        let scope = match within_class(study, class) {
            Ok(scope) => scope,
            Err(why) => return Ok(Err(why)),
        };
        return Ok(match class_standing(gains, own)? {
            Ok(Some(standing)) => Ok((standing, scope)),
            Ok(None) => Err(Unbounded::of("the class is that of no joint")),
            Err(why) => Err(Unbounded(why.to_string())),
        });
    }
    let tube = tube_standing(gains).filter(|_| study.sha256 == own.sha256);
    Ok(tube
        .map(|tube| (tube, "for this motion from its start, by the tube".to_owned()))
        .ok_or_else(|| {
            let why = certificate.class_refused.as_ref().or(certificate.tube_refused.as_ref());
            let none = || "no bound for this motion in the certificate".to_owned();
            Unbounded(why.cloned().unwrap_or_else(none))
        }))
}

/// Scope of the bound for a class of motions, where the drive stays in it.
fn within_class(study: &Study, class: &ClassBound) -> Result<String, Unbounded> {
    let kept = study.supervisor.as_deref().map(|own| {
        class.covers(own.reference_box.as_ref(), own.motion.as_ref()) && class.is_supervised()
    });
    let drawn = matches!(study.reference, ReferenceRequest::Any { .. });
    if !kept.unwrap_or(drawn && !class.is_supervised()) {
        return Err(Unbounded::of("the references are not kept in the class of motions"));
    }
    let conditions = if kept.is_some() {
        "holding and tracking, as long as no limit acts, every sample comes in time and no fault is reported"
    } else {
        "as long as no limit acts"
    };
    let slides: Vec<bool> =
        study.robot.joints.iter().map(|joint| joint.kind == JointKind::Prismatic).collect();
    Ok(format!(
        "for any motion within {}; {conditions}; maxima are those of two searches, assumption C8",
        class.limits_in_words(&slides)
    ))
}
