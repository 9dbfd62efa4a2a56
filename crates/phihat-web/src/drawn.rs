//! The part of a run that a page draws: bounded in size, however long the run is.

use phihat_design::Gains;
use phihat_model::JointKind;
use phihat_report::{DrawnArm, claimed_bound};
use phihat_session::{Done, SessionError, drawn_arm, sha256};
use phihat_sim::{JointTrace, Motion, Trace, samples};
use phihat_study::Study;
use serde_json::{Value, json};

/// Most points of a curve.
const POINTS: usize = 1000;

/// Points of a curve in one part of a run.
const POINTS_PER_PART: usize = 20;

/// Samples from one point of a curve to the next, of a run of so many.
pub(crate) fn stride(samples: usize) -> usize {
    samples.div_ceil(POINTS).max(1)
}

/// Number of samples that a run is planned to have.
fn planned(study: &Study) -> usize {
    let count = samples(study.duration, study.control.period_ns);
    usize::try_from(count).unwrap_or(usize::MAX)
}

/// Samples of one part of a run: what a page is handed at once.
pub(crate) fn part_samples(study: &Study) -> usize {
    stride(planned(study)).saturating_mul(POINTS_PER_PART)
}

/// Arm, desired motion and bounds: known of a run before its first sample.
pub(crate) fn beginning(study: &Study, gains: Option<&Gains>) -> Result<Value, SessionError> {
    let motion = Motion::of(study).map_err(SessionError::other)?;
    let count = planned(study);
    let times = (0..count).step_by(stride(count));
    let t: Vec<f64> = times.map(|k| (k as u64 * study.control.period_ns) as f64 * 1e-9).collect();
    let joint = |(j, joint): (usize, &phihat_model::Joint)| {
        let q_d: Vec<f64> = t.iter().map(|&t| motion.told(j, t)[0]).collect();
        let (bound, envelope) = bound_of(gains, j, study.duration);
        json!({
            "name": joint.name,
            "slides": joint.kind == JointKind::Prismatic,
            "accepted_rad": study.spec.error_bound.as_ref().and_then(|all| all.get(j)),
            "bound_rad": bound,
            "envelope": envelope,
            "q_d": q_d,
        })
    };
    let joints: Vec<Value> = study.robot.joints.iter().enumerate().map(joint).collect();
    Ok(json!({
        "title": study.title,
        "robot": study.robot.name,
        "settle_s": study.spec.settle,
        "duration_s": study.duration,
        "t": t,
        "joints": joints,
        "arm": drawn_arm(study, None),
    }))
}

/// Positions and errors of one part of a run, at the points of its curves.
pub(crate) fn part(trace: &Trace, planned_samples_per_part: usize) -> Value {
    let each = planned_samples_per_part / POINTS_PER_PART;
    let joint = |own: &JointTrace| json!({ "q": first(&own.q, each), "e": largest(&own.e, each) });
    let joints: Vec<Value> = trace.joints.iter().map(joint).collect();
    json!({ "t": trace.t_ns.first().map(|t| *t as f64 * 1e-9), "joints": joints })
}

/// Verdict, bound beside the measurement, curves and arm of a run.
pub(crate) fn drawn(done: &Done, trace: &Trace) -> Value {
    let each = stride(trace.len());
    let t: Vec<f64> = trace.t_ns.iter().step_by(each).map(|t| *t as f64 * 1e-9).collect();
    let gains = done.gains.as_ref();
    let claimed = claimed_bound(&done.record());
    let whole = claimed.as_ref().is_some_and(|own| own.motions.is_some());
    let joints: Vec<Value> = trace
        .joints
        .iter()
        .zip(&done.metrics.joints)
        .enumerate()
        .map(|(j, (joint, figures))| {
            let (bound, envelope) = bound_of(gains, j, done.metrics.duration_s);
            // The bound of a class is about the whole run.
            let measured =
                if whole { figures.error_peak_rad } else { figures.error_steady_max_rad };
            json!({
                "name": joint.name,
                "slides": figures.slides,
                "accepted_rad": figures.error_bound_rad,
                "bound_rad": bound,
                "measured_rad": measured,
                "torque_max_nm": figures.tau_max_nm,
                "torque_limit_nm": figures.tau_limit_nm,
                "q": first(&joint.q, each),
                "q_d": first(&joint.q_desired, each),
                "e": largest(&joint.e, each),
                "torque": largest(&joint.tau_applied, each),
                "envelope": envelope,
            })
        })
        .collect();
    let arm: DrawnArm = drawn_arm(&done.study, None);
    json!({
        "title": done.study.title,
        "robot": done.study.robot.name,
        "verdict": done.verdict(),
        "good": done.good(),
        "beside_bound": claimed.as_ref().map(|own| own.sentence.clone()),
        "motions": claimed.as_ref().and_then(|own| own.motions.clone()),
        "broken": claimed.as_ref().is_some_and(|own| own.broken),
        "promise": claimed.is_some_and(|own| own.promised),
        "settle_s": done.metrics.settle_s,
        "duration_s": done.metrics.duration_s,
        "samples": done.metrics.samples,
        "warnings": done.run.warnings,
        "t": t,
        "joints": joints,
        "arm": arm,
        "trace_sha256": trace_sha256(trace),
    })
}

/// Bound on the error of a joint \[rad, m\], and its envelope over a run of so many seconds: a tube's bins, or one bin.
fn bound_of(gains: Option<&Gains>, joint: usize, duration_s: f64) -> (Option<f64>, Option<Value>) {
    let bound = |gains: &Gains| {
        let certificate = gains.certificate.as_ref()?;
        let bound = certificate.error_bound(joint)?.error_bound_rad;
        let envelope = match &certificate.tube {
            Some(tube) => {
                let own = tube.joints.get(joint)?;
                json!({ "bin_s": tube.bin_s, "low": own.error_low_rad, "high": own.error_high_rad })
            }
            None => json!({ "bin_s": duration_s, "low": [-bound, -bound], "high": [bound, bound] }),
        };
        Some((bound, envelope))
    };
    gains.and_then(bound).unzip()
}

/// The first value in each stretch of so many samples.
fn first(all: &[f64], each: usize) -> Vec<f64> {
    all.iter().step_by(each).copied().collect()
}

/// The value of largest size in each stretch of so many samples; a value that is no number is the largest.
pub(crate) fn largest(all: &[f64], each: usize) -> Vec<Option<f64>> {
    let most = |part: &[f64]| {
        let beyond = part.iter().find(|value| !value.is_finite());
        let largest = part.iter().max_by(|a, b| a.abs().total_cmp(&b.abs()));
        beyond.or(largest).copied().filter(|value| value.is_finite())
    };
    all.chunks(each).map(most).collect()
}

/// SHA-256 of the bits of every signal of every joint, hexadecimal: equal for equal traces.
fn trace_sha256(trace: &Trace) -> String {
    let mut bytes = Vec::new();
    let signals = |joint: &JointTrace| -> [Vec<f64>; 6] {
        [&joint.q, &joint.dq, &joint.e, &joint.tau_command, &joint.tau_applied, &joint.phi_hat]
            .map(Clone::clone)
    };
    for signal in trace.joints.iter().flat_map(signals) {
        for value in signal {
            bytes.extend(value.to_bits().to_le_bytes());
        }
    }
    // Infallible: bytes at hand are read.
    sha256(&mut &bytes[..]).unwrap_or_default()
}
