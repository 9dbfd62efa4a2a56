//! State of a study for a page that opens.

use phihat::Form;
use phihat_design::Gains;
use phihat_model::JointKind;
use phihat_sim::Motion;
use phihat_study::Study;
use serde_json::{Value, json};

use crate::beside::laws;
use crate::offer::OFFERS;
use crate::open::Open;

/// Postures of the motion that a page draws its path from.
const POSTURES: u32 = 400;
/// Of a motion that goes on for longer, so much is drawn \[s\].
const DRAWN: f64 = 60.0;

/// Everything that does not change while a run goes on.
pub(crate) fn state(open: &Open) -> Value {
    let Open { study, arm, gains, warnings, path: place, played } = open;
    let name = place.file_stem().unwrap_or_default().to_string_lossy();
    let joints = &study.robot.joints;
    let slides = joints.iter().map(|joint| joint.kind == JointKind::Prismatic);
    let slides: Vec<bool> = slides.collect();
    json!({
        "study": study.name,
        "title": study.title,
        "robot": study.robot.name,
        "name": name,
        "text": study.text,
        "joints": joints.iter().map(|joint| &joint.name).collect::<Vec<_>>(),
        "slides": slides,
        "torque_max": (0..joints.len()).map(|i| study.limits(i).0).collect::<Vec<_>>(),
        "bounds": study.spec.error_bound,
        "settle_s": study.spec.settle,
        "rate_hz": 1e9 / study.control.period_ns as f64,
        "scales": study.control.form != Form::Positions,
        "method": gains.as_ref().map_or("another controller's", |gains| gains.method.as_str()),
        "claims": gains.as_ref().and_then(|gains| claims(gains, study, &slides)),
        "supervised": study.supervisor.is_some(),
        "arm": arm,
        "path": played.as_ref().map_or_else(
            || path(study),
            |played| json!({ "t": played.path.0, "q": played.path.1 }),
        ),
        "record_s": played.as_ref().map(|played| played.length),
        "late": study.sensor.delay_samples,
        "laws": laws(),
        "offers": OFFERS,
        "warnings": warnings,
    })
}

/// Claims of gains about the error: bounds per joint \[rad\], and the assumptions; `None`: there is no certificate.
fn claims(gains: &Gains, study: &Study, slides: &[bool]) -> Option<Value> {
    let certificate = gains.certificate.as_ref()?;
    let other = (gains.study_sha256 != study.sha256)
        .then(|| "the gains were made for another study".to_owned());
    let any = certificate.class.as_ref().filter(|_| certificate.tube.is_none());
    let bounds = (0..gains.joints.len()).map(|i| certificate.error_bound(i));
    let bounds: Option<Vec<f64>> = bounds.map(|own| own.map(|own| own.error_bound_rad)).collect();
    let not_counted =
        certificate.not_counted.iter().map(|one| format!("{} = {}", one.key, one.value));
    Some(json!({
        "error_bound": bounds,
        "why": other.or_else(|| certificate.without_bound()),
        "assumptions": certificate.assumptions(),
        "not_counted": not_counted.collect::<Vec<_>>(),
        "motions": any.map(|class| class.limits_in_words(slides)),
    }))
}

/// Path of the motion: times and desired positions.
fn path(study: &Study) -> Value {
    let Ok(motion) = Motion::of(study) else { return Value::Null };
    let length = study.duration.min(DRAWN);
    let times = (0..POSTURES).map(|k| length * f64::from(k) / f64::from(POSTURES - 1));
    let times: Vec<f64> = times.collect();
    let at =
        |t: &f64| (0..study.robot.joints.len()).map(|i| motion.at(i, *t)[0]).collect::<Vec<_>>();
    json!({ "t": times, "q": times.iter().map(at).collect::<Vec<_>>() })
}
