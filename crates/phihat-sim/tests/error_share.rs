//! Shares of a certified bound in a record. Wrong if a share is not the measured error over its bound where the bound
//! is claimed, if it is not 0 where it is not, or if another sample is called the largest.

use phihat::{Events, Mode};
use phihat_sim::{ErrorShares, JointTrace, Supervision, Trace};

/// Two joints whose measured errors are `0.01 k` and `-0.03`, on a true state that is elsewhere.
fn trace(first: u16) -> Trace {
    let samples = first..first + 4;
    let joint = |name: &str, error: fn(f64) -> f64| JointTrace {
        name: name.to_owned(),
        q: vec![7.0; 4],
        q_measured: samples.clone().map(|k| 1.0 + error(f64::from(k))).collect(),
        q_desired: vec![1.0; 4],
        ..JointTrace::default()
    };
    let joints = vec![joint("a", |k| 0.01 * k), joint("b", |_| -0.03)];
    let t_ns = samples.map(|k| 1_000_000 * u64::from(k)).collect();
    Trace { period_ns: 1_000_000, t_ns, joints, supervision: None }
}

fn near(found: &[f64], wanted: &[f64]) -> bool {
    found.len() == wanted.len() && found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-12)
}

#[test]
fn a_share_is_the_measured_error_over_its_bound_and_the_largest_stays_over_blocks() {
    let mut shares = ErrorShares::new(vec![0.1, 0.04]);
    let (mut one, mut two) = (trace(0), trace(4));
    assert!(!one.is_bounded());
    shares.fill(&mut one);
    shares.fill(&mut two);
    assert!(one.is_bounded() && near(&two.joints[0].error_share, &[0.4, 0.5, 0.6, 0.7]));
    assert!(near(&one.joints[1].error_share, &[0.75; 4]));
    let all: Vec<_> = shares.joints().map(|own| (own.joint.as_str(), own.at_s)).collect();
    assert_eq!(all[0], ("a", 0.007));
    let largest = shares.largest().unwrap();
    assert_eq!((largest.joint.as_str(), largest.bound_rad), ("b", 0.04));
    assert!((largest.error_rad - 0.03).abs() < 1e-12 && (largest.share - 0.75).abs() < 1e-12);
}

#[test]
fn nothing_is_compared_where_the_bound_is_not_claimed() {
    let mut own = trace(5);
    let mode = vec![Mode::Armed, Mode::Holding, Mode::Tracking, Mode::SafeStop];
    let events = vec![Events::NONE, Events::MISSED, Events::SHAPED, Events::NONE];
    let (fault, brake) = (vec![None; 4], vec![false; 4]);
    own.supervision = Some(Supervision { mode, events, fault, brake });
    let mut shares = ErrorShares::new(vec![0.1, 0.04]);
    shares.fill(&mut own);
    assert!(near(&own.joints[0].error_share, &[0.0, 0.0, 0.7, 0.0]));
    assert!(near(&own.joints[1].error_share, &[0.0, 0.0, 0.75, 0.0]));
    // Filled once more: the same, not twice as long.
    shares.fill(&mut own);
    assert_eq!(own.joints[1].error_share.len(), 4);
}
