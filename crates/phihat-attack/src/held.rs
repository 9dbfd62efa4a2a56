//! Comparison of a run with the bounds that are claimed of it.

use phihat_sim::{JointTrace, SimulationOutcome};
use serde::{Deserialize, Serialize};

use crate::claim::{AttackClaim, JointClaim};

/// Rounding that no claim is broken by.
const ROUNDING: f64 = 1e-9;

/// One joint of one run against a claim.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointFound {
    /// Its name.
    pub name: String,
    /// Largest bound on |e| in the steady part \[rad\].
    #[serde(alias = "bound_rad")]
    pub error_bound_rad: f64,
    /// Largest |e| in the steady part \[rad\].
    #[serde(alias = "error_rad")]
    pub error_peak_rad: f64,
    /// Likewise |ė| \[rad/s\].
    #[serde(alias = "velocity_bound_rad_s")]
    pub velocity_error_bound_rad_s: f64,
    /// Likewise |ė| \[rad/s\].
    pub velocity_rad_s: f64,
    /// Largest bound on the change of the commanded torque per sample in the steady part \[N·m\]; 0: not claimed.
    pub step_bound_nm: f64,
    /// Largest such change \[N·m\].
    pub step_nm: f64,
}

/// A bound that was left.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Violation {
    /// Name of the run.
    pub run: String,
    /// Joint.
    pub joint: String,
    /// Signal that left its bound.
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
pub struct ClaimOutcome {
    /// Joints, in the robot's order.
    pub joints: Vec<JointFound>,
    /// Bounds that were left.
    pub violations: Vec<Violation>,
    /// True if a limit acted that the claim does not exclude: nothing is claimed of this run.
    pub outside: bool,
}

/// Holds a run against a claim.
pub fn held(claim: &AttackClaim, outcome: &SimulationOutcome, run: &str) -> ClaimOutcome {
    let mut found = ClaimOutcome::default();
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
        let before = core::iter::once(&claimed.held).chain(&joint.tau_command);
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
        found.joints.push(steady(claim, claimed, (joint, &step), &t));
    }
    found
}

/// Value of a signal that is furthest outside of its bounds, or closest to them.
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

fn steady(
    claim: &AttackClaim,
    claimed: &JointClaim,
    (joint, step): (&JointTrace, &[f64]),
    t: &[f64],
) -> JointFound {
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
        error_bound_rad: bound(&claimed.error),
        error_peak_rad: most(&joint.e),
        velocity_error_bound_rad_s: bound(&claimed.velocity),
        velocity_rad_s: most(&joint.de),
        step_bound_nm: claimed.step.iter().skip(first).fold(0.0_f64, |a, b| a.max(*b)),
        step_nm: most(step),
    }
}

#[cfg(test)]
mod tests {
    use super::held;
    use crate::claim::{AttackClaim, JointClaim};
    use phihat_sim::{JointTrace, SimulationOutcome, Trace};

    /// Ten samples at 1 kHz in bins of 5 ms; the error is 0.5, then 1.5.
    fn run(saturated: bool) -> SimulationOutcome {
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
        SimulationOutcome { trace, divergence, abort, told_max: vec![], told_step_max: vec![] }
    }

    fn claim(first: (f64, f64), second: (f64, f64)) -> AttackClaim {
        let joint = JointClaim {
            name: "j".to_owned(),
            from_s: 0.0,
            bin_s: Some(0.005),
            error: vec![first, second],
            velocity: vec![(-1.0, 1.0); 2],
            torque: vec![1.0; 2],
            step: vec![1.0; 2],
            held: 0.0,
        };
        AttackClaim { joints: vec![joint], settle_s: 0.0, limits_silent: true }
    }

    #[test]
    fn every_sample_is_held_against_its_own_bin() {
        let found = held(&claim((0.4, 0.6), (1.4, 1.6)), &run(false), "r");
        assert!(found.violations.is_empty(), "{:?}", found.violations);
        assert!((found.joints[0].error_bound_rad - 1.6).abs() < 1e-12);
        assert!((found.joints[0].error_peak_rad - 1.5).abs() < 1e-12);
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
