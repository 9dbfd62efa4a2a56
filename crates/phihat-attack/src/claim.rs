//! What a certificate claims of a run, as bounds for every joint and time, and whether a run keeps them.

use phihat_certificate::{NotCounted, Tube, TubeJoint};
use phihat_design::Gains;
use phihat_sim::{JointTrace, Outcome};
use phihat_study::Study;
use serde::{Deserialize, Serialize};

/// Rounding that no claim is broken by.
const ROUNDING: f64 = 1e-9;

/// Bounds on error and velocity error of every joint, until the end of the run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Claim {
    /// Joints, in the robot's order.
    pub joints: Vec<JointClaim>,
    /// When the steady part begins \[s\].
    pub settle_s: f64,
    /// Whether it is claimed that no torque or rate limit acts. If not, a run in which one does is outside of the claim.
    pub limits_silent: bool,
}

/// Bounds of one joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointClaim {
    /// Its name.
    pub name: String,
    /// When the first bin begins \[s\].
    pub from_s: f64,
    /// Length of a bin \[s\]; infinite: one bin.
    pub bin_s: Option<f64>,
    /// Least and largest error of each bin \[rad\].
    pub error: Vec<(f64, f64)>,
    /// Least and largest velocity error \[rad/s\].
    pub velocity: Vec<(f64, f64)>,
    /// Largest torque commanded \[N·m\]; empty: not claimed.
    pub torque: Vec<f64>,
    /// Largest change of it from one sample to the next \[N·m\].
    pub step: Vec<f64>,
}

/// What gains claim about the study that they were designed for; else why they claim nothing.
///
/// # Errors
///
/// The reason, as the certificate has it.
pub fn claimed(gains: &Gains, study: &Study) -> Result<Claim, String> {
    let certificate = gains.certificate.as_ref().ok_or("no certificate")?;
    if let Some(refused) = certificate.refused() {
        return Err(format!("refused: {refused}"));
    }
    if let Some(why) = &certificate.tube_refused {
        return Err(format!("tube: {why}"));
    }
    let tube = certificate.tube.as_ref();
    let counted = |left_out: &&NotCounted| tube.is_some() && left_out.in_tube();
    if let Some(left_out) = certificate.not_counted.iter().find(|left_out| !counted(left_out)) {
        return Err(format!("not counted: {}", left_out.key));
    }
    if let Some(tube) = tube {
        return Ok(documented(tube));
    }
    // Without a tube: bounds on the steady error of each joint by itself.
    let joints = certificate.joints.iter().map(|joint| {
        let bounds = joint.bounds.as_ref().ok_or("no bounds")?;
        let (e, v) = (bounds.error_rad, bounds.velocity_error_rad_s);
        Ok(JointClaim {
            name: joint.name.clone(),
            from_s: study.spec.settle,
            bin_s: None,
            error: vec![(-e, e)],
            velocity: vec![(-v, v)],
            torque: Vec::new(),
            step: Vec::new(),
        })
    });
    let joints = joints.collect::<Result<_, String>>()?;
    Ok(Claim { joints, settle_s: study.spec.settle, limits_silent: false })
}

/// What a tube in a certificate says.
fn documented(tube: &Tube) -> Claim {
    let zip = |low: &[f64], high: &[f64]| low.iter().copied().zip(high.iter().copied()).collect();
    let joint = |joint: &TubeJoint| JointClaim {
        name: joint.name.clone(),
        from_s: 0.0,
        bin_s: Some(tube.bin_s),
        error: zip(&joint.error_low_rad, &joint.error_high_rad),
        velocity: zip(&joint.velocity_low_rad_s, &joint.velocity_high_rad_s),
        torque: vec![joint.torque_max_nm; joint.error_low_rad.len()],
        step: vec![joint.torque_step_max_nm; joint.error_low_rad.len()],
    };
    Claim {
        joints: tube.joints.iter().map(joint).collect(),
        settle_s: tube.settle_s,
        limits_silent: tube.limits_silent,
    }
}

/// One joint of one run against a claim.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointFound {
    /// Its name.
    pub name: String,
    /// Largest bound on |e| in the steady part \[rad\].
    pub bound_rad: f64,
    /// Largest |e| in the steady part \[rad\].
    pub error_rad: f64,
    /// Likewise |ė| \[rad/s\].
    pub velocity_bound_rad_s: f64,
    /// Likewise |ė| \[rad/s\].
    pub velocity_rad_s: f64,
}

/// A bound that was left.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Violation {
    /// Which run.
    pub run: String,
    /// Joint.
    pub joint: String,
    /// What left its bound.
    pub signal: String,
    /// When it was furthest out, as a ratio \[s\].
    pub t_s: f64,
    /// Measured then.
    pub measured: f64,
    /// Least and largest value claimed then.
    pub claimed: (f64, f64),
    /// Measured over claimed.
    pub ratio: f64,
}

/// One run against a claim.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Found {
    /// Joints, in the robot's order.
    pub joints: Vec<JointFound>,
    /// Bounds that were left.
    pub violations: Vec<Violation>,
    /// Whether a limit acted although none was claimed to be silent: nothing is claimed of this run.
    pub outside: bool,
}

/// Holds a run against a claim.
pub fn held(claim: &Claim, outcome: &Outcome, run: &str) -> Found {
    let mut found = Found::default();
    let trace = &outcome.trace;
    let limited = |joint: &JointTrace| {
        joint.saturated.iter().chain(&joint.rate_limited).any(|limited| *limited)
    };
    let acted = trace.joints.iter().any(limited);
    let violation = |joint: &str, signal: &str, t_s: f64| Violation {
        run: run.to_owned(),
        joint: joint.to_owned(),
        signal: signal.to_owned(),
        t_s,
        measured: f64::MAX,
        claimed: (0.0, 0.0),
        ratio: f64::MAX,
    };
    if acted && !claim.limits_silent {
        found.outside = true;
    } else if acted {
        found.violations.push(violation("", "a limit acted", 0.0));
    }
    if let Some(divergence) = outcome.divergence.as_ref().filter(|_| !found.outside) {
        found.violations.push(violation(&divergence.joint, "diverged", divergence.t));
    }
    if let Some(abort) = outcome.abort.as_ref().filter(|_| !found.outside) {
        found.violations.push(violation("", &format!("the robot stopped: {abort:?}"), 0.0));
    }
    let t: Vec<f64> = trace.t_ns.iter().map(|t| *t as f64 * 1e-9).collect();
    for (joint, claimed) in trace.joints.iter().zip(&claim.joints) {
        let around = |sizes: &[f64]| sizes.iter().map(|x| (-x, *x)).collect::<Vec<_>>();
        let before = core::iter::once(&0.0).chain(&joint.tau_command);
        let step: Vec<f64> = joint.tau_command.iter().zip(before).map(|(a, b)| a - b).collect();
        let signals = [
            ("e", &joint.e, claimed.error.clone()),
            ("de", &joint.de, claimed.velocity.clone()),
            ("torque", &joint.tau_command, around(&claimed.torque)),
            ("torque step", &step, around(&claimed.step)),
        ];
        for (signal, values, bounds) in &signals {
            let Some(worst) = furthest(&t, values, claimed, bounds) else { continue };
            if worst.ratio > 1.0 + ROUNDING && !found.outside {
                let named = violation(&joint.name, signal, worst.t_s);
                found.violations.push(Violation { run: named.run, joint: named.joint, ..worst });
                if let Some(last) = found.violations.last_mut() {
                    (*signal).clone_into(&mut last.signal);
                }
            }
        }
        found.joints.push(steady(claim, claimed, joint, &t));
    }
    found
}

/// Where a signal is furthest out of its bounds, or closest to them.
fn furthest(
    t: &[f64],
    values: &[f64],
    claimed: &JointClaim,
    bounds: &[(f64, f64)],
) -> Option<Violation> {
    let ratio = |value: f64, (low, high): (f64, f64)| {
        // Beyond the middle of the bin, in half-widths.
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        (value - middle).abs() / (half + 1e-12)
    };
    let at = |(t, value): (&f64, &f64)| {
        let bin = bin(claimed, *t, bounds.len())?;
        Some((*t, *value, bounds[bin], ratio(*value, bounds[bin])))
    };
    let all = t.iter().zip(values).filter_map(at);
    let worst = all.max_by(|a, b| a.3.total_cmp(&b.3))?;
    let (t_s, measured, claimed, ratio) = worst;
    Some(Violation {
        run: String::new(),
        joint: String::new(),
        signal: String::new(),
        t_s,
        measured,
        claimed,
        ratio,
    })
}

/// The bin of a time; `None` before the first. What comes after the last one counts to it.
fn bin(claimed: &JointClaim, t: f64, bins: usize) -> Option<usize> {
    let since = t - claimed.from_s;
    if since < -1e-12 || bins == 0 {
        return None;
    }
    let Some(length) = claimed.bin_s else { return Some(0) };
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a time of the run over a length of a bin: a small number, not negative"
    )]
    let place = ((since / length + 1e-9).max(0.0)) as usize;
    Some(place.min(bins - 1))
}

fn steady(claim: &Claim, claimed: &JointClaim, joint: &JointTrace, t: &[f64]) -> JointFound {
    let from = t.partition_point(|t| *t < claim.settle_s - 1e-12);
    let first = bin(claimed, claim.settle_s.max(claimed.from_s), claimed.error.len()).unwrap_or(0);
    let most = |values: &[f64]| {
        values[from.min(values.len())..].iter().fold(0.0_f64, |a, b| a.max(b.abs()))
    };
    let bound = |bins: &[(f64, f64)]| {
        bins.iter().skip(first).fold(0.0_f64, |a, (low, high)| a.max(low.abs()).max(high.abs()))
    };
    JointFound {
        name: joint.name.clone(),
        bound_rad: bound(&claimed.error),
        error_rad: most(&joint.e),
        velocity_bound_rad_s: bound(&claimed.velocity),
        velocity_rad_s: most(&joint.de),
    }
}

#[cfg(test)]
mod tests {
    use super::{Claim, JointClaim, held};
    use phihat_sim::{JointTrace, Outcome, Trace};

    /// Ten samples at 1 kHz in bins of 5 ms; the error is 0.5, then 1.5.
    fn run(saturated: bool) -> Outcome {
        let mut joint = JointTrace { name: "j".to_owned(), ..JointTrace::default() };
        for k in 0..10 {
            joint.e.push(if k < 5 { 0.5 } else { 1.5 });
            joint.de.push(0.0);
            joint.tau_command.push(1.0);
            joint.saturated.push(saturated && k == 3);
            joint.rate_limited.push(false);
        }
        let t_ns = (0..10).map(|k| k * 1_000_000).collect();
        let trace = Trace { period_ns: 1_000_000, t_ns, joints: vec![joint], supervision: None };
        let (divergence, abort) = (None, None);
        Outcome { trace, divergence, abort, told_max: vec![], told_step_max: vec![] }
    }

    fn claim(first: (f64, f64), second: (f64, f64)) -> Claim {
        let joint = JointClaim {
            name: "j".to_owned(),
            from_s: 0.0,
            bin_s: Some(0.005),
            error: vec![first, second],
            velocity: vec![(-1.0, 1.0); 2],
            torque: vec![1.0; 2],
            step: vec![1.0; 2],
        };
        Claim { joints: vec![joint], settle_s: 0.0, limits_silent: true }
    }

    #[test]
    fn every_sample_is_held_against_its_own_bin() {
        let found = held(&claim((0.4, 0.6), (1.4, 1.6)), &run(false), "r");
        assert!(found.violations.is_empty(), "{:?}", found.violations);
        assert!((found.joints[0].bound_rad - 1.6).abs() < 1e-12);
        assert!((found.joints[0].error_rad - 1.5).abs() < 1e-12);
        let found = held(&claim((0.4, 0.6), (1.6, 1.8)), &run(false), "r");
        assert_eq!(found.violations.len(), 1);
        let left = &found.violations[0];
        assert_eq!((left.signal.as_str(), left.joint.as_str()), ("e", "j"));
        assert!(left.t_s >= 0.005 - 1e-12, "{left:?}");
        assert_eq!(held(&claim((0.0, 0.1), (0.0, 0.1)), &run(false), "r").violations.len(), 1);
    }

    #[test]
    fn torque_and_its_step_are_claims_too() {
        let mut tight = claim((0.0, 2.0), (0.0, 2.0));
        tight.joints[0].torque = vec![0.9; 2];
        tight.joints[0].step = vec![0.9; 2];
        let found = held(&tight, &run(false), "r");
        let signals: Vec<_> = found.violations.iter().map(|v| v.signal.as_str()).collect();
        assert_eq!(signals, ["torque", "torque step"]);
    }

    #[test]
    fn a_limit_that_acts_breaks_a_silent_claim_and_is_outside_of_any_other() {
        let mut wide = claim((0.0, 2.0), (0.0, 2.0));
        assert_eq!(held(&wide, &run(true), "r").violations[0].signal, "a limit acted");
        wide.limits_silent = false;
        let found = held(&wide, &run(true), "r");
        assert!(found.outside && found.violations.is_empty());
    }
}
