//! Statement about the error of a drive before it begins: its bound, or the first clause that is not proved.

use phihat_design::{ClassBound, Gains};
use phihat_study::{ReferenceRequest, Study};
use serde::Serialize;

use crate::preflight::{Check, CheckName, State};

/// Checks that a bound rests on: where a person accepted one that failed, nothing is proved.
const RESTS_ON: [CheckName; 4] =
    [CheckName::Certificate, CheckName::Window, CheckName::Profile, CheckName::Description];

/// Bound on the error of a drive, or why there is none.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Proof {
    /// Largest bound on `|e|` of a joint \[rad\]; `None`: nothing is proved.
    pub error_bound_rad: Option<f64>,
    /// The statement in a sentence: "proved ≤ …" with its conditions, or "NOT PROVED: …" with the first clause that is
    /// not.
    pub sentence: String,
}

/// The first clause that is not proved.
#[derive(Debug)]
struct Unproved(String);

impl Unproved {
    fn of(why: &str) -> Self {
        Self(why.to_owned())
    }
}

/// Subject of a drive, as far as a bound depends on it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Subject<'a> {
    pub(crate) study: &'a Study,
    /// SHA-256 of the study before a motion from a file took the place of its own.
    pub(crate) sha256: &'a str,
    pub(crate) gains: &'a Gains,
    /// True if a first motion is driven.
    pub(crate) first: bool,
}

impl Proof {
    pub(crate) fn of(subject: Subject<'_>, checks: &[Check]) -> Self {
        let proved = bound(subject, checks);
        let (error_bound_rad, sentence) = match proved {
            Ok((error, scope)) => {
                (Some(error), format!("proved ≤ {:.3} mrad {scope}", 1e3 * error))
            }
            Err(Unproved(why)) => (None, format!("NOT PROVED: {why}")),
        };
        Self { error_bound_rad, sentence }
    }
}

/// The largest bound of a joint \[rad\], and its scope; else the first clause that is not proved.
fn bound(subject: Subject<'_>, checks: &[Check]) -> Result<(f64, String), Unproved> {
    let Subject { study, sha256, gains, first } = subject;
    if first {
        return Err(Unproved::of("a first motion, whose gains are cautious and not certified"));
    }
    let Some(certificate) = &gains.certificate else {
        return Err(Unproved::of("the gains carry no certificate"));
    };
    if let Some(why) = certificate.refused() {
        return Err(Unproved(why.to_string()));
    }
    if gains.study_sha256 != sha256 {
        return Err(Unproved::of("the certificate is about another study"));
    }
    let accepted =
        |check: &&Check| check.state == State::Accepted && RESTS_ON.contains(&check.name);
    if let Some(check) = checks.iter().find(accepted) {
        return Err(Unproved(format!("driven in spite of the check `{}`", check.name.word())));
    }
    if study.springs.stated().is_some() {
        return Err(Unproved::of(
            "joints bend as the study states: bounds are those of rigid joints",
        ));
    }
    if let Some(class) = &certificate.class {
        return within_class(study, class);
    }
    if let Some(tube) = certificate.tube.as_ref().filter(|_| study.sha256 == sha256) {
        let error = tube.joints.iter().map(|joint| joint.error_bound_rad).fold(0.0, f64::max);
        return Ok((error, "for this motion from its start, by the tube".to_owned()));
    }
    let why = certificate.class_refused.as_ref().or(certificate.tube_refused.as_ref());
    let none = || "no bound for this motion in the certificate".to_owned();
    Err(Unproved(why.cloned().unwrap_or_else(none)))
}

/// The bound for a class of motions, where the drive stays in it.
fn within_class(study: &Study, class: &ClassBound) -> Result<(f64, String), Unproved> {
    let (_, error) = class.worst().ok_or_else(|| Unproved::of("the class is that of no joint"))?;
    let kept = study.supervisor.as_deref().map(|own| {
        class.covers(own.reference_box.as_ref(), own.motion.as_ref()) && class.is_supervised()
    });
    let drawn = matches!(study.reference, ReferenceRequest::Any { .. });
    if !kept.unwrap_or(drawn && !class.is_supervised()) {
        return Err(Unproved::of("the references are not kept in the class of motions"));
    }
    let conditions = if kept.is_some() {
        "holding and tracking, as long as no limit acts, every sample comes in time and no fault is reported"
    } else {
        "as long as no limit acts"
    };
    Ok((error, format!("for any motion within {}; {conditions}", pace(class))))
}

/// Joint box, speed, acceleration and jerk of a class.
fn pace(class: &ClassBound) -> String {
    let (low, high) = &class.box_rad;
    let half: Vec<f64> = low.iter().zip(high).map(|(low, high)| 0.5 * (high - low)).collect();
    format!(
        "± {} rad, {} rad/s, {} rad/s², {} rad/s³",
        span(&half),
        span(&class.speed_max_rad_s),
        span(&class.acceleration_max_rad_s2),
        span(&class.jerk_max_rad_s3)
    )
}

/// One figure where all are the same, else the least and the largest.
fn span(values: &[f64]) -> String {
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = values.iter().copied().fold(0.0, f64::max);
    let shown = |x: f64| {
        let text = format!("{x:.4}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    };
    let (least, most) = (shown(least), shown(most));
    if least == most { most } else { format!("{least} … {most}") }
}

#[cfg(test)]
mod tests {
    use super::span;

    #[test]
    fn a_span_is_one_figure_where_all_are_the_same() {
        assert_eq!(span(&[0.3, 0.3, 0.300_000_01]), "0.3");
        assert_eq!(span(&[0.25, 1.0]), "0.25 … 1");
        assert_eq!(span(&[10.0, 20.0]), "10 … 20");
    }
}
