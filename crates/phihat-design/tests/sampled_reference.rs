//! Error from the reference's own motion, against the worst motions played through the core. Wrong if a
//! delay, a filter or the feed-forward were counted wrongly: the worst motion would leave the bound, or stay
//! far inside.

use crate::sampled_support::{Outside, Rig, record};
use phihat::{Form, Reference, VelocitySource};
use phihat_design::JointRecord;
use phihat_design::prelude::*;
use phihat_design::sampled::{LoopModel, ReferenceError};

/// Samples after which the slowest loop here has forgotten.
const LONG: usize = 1500;

/// Motion of the reference in one interval.
#[derive(Clone, Copy)]
enum Motion {
    /// `q̈_d` held \[rad/s²\].
    Acceleration,
    /// `q⃛_d` held \[rad/s³\].
    Jerk,
}

struct Case {
    record: JointRecord,
    model: LoopModel,
    feed_forward: bool,
    mu: f64,
}

impl Case {
    /// `e` at every sample for a sequence of held accelerations or jerks; `φ` has the share of `(M − M̄) q̈_d`.
    fn errors(&self, motion: Motion, values: &[f64]) -> Vec<f64> {
        let mut rig = Rig::new(&self.record, &self.model, self.mu);
        let t = self.model.period_s;
        let (mut q, mut dq, mut ddq) = (0.0, 0.0, 0.0);
        let borne = (1.0 - self.mu) * self.record.inertia_kg_m2;
        let mut errors = Vec::new();
        for value in values {
            let (start, slope) = match motion {
                Motion::Acceleration => (*value, 0.0),
                Motion::Jerk => (ddq, *value),
            };
            errors.push(rig.q - q);
            let forward = if self.feed_forward { start } else { 0.0 };
            let reference = Reference { q, dq, ddq: forward };
            let (phi, phi_slope) = (borne * start, borne * slope);
            rig.step(&Outside { phi, phi_slope, encoder: 0.0, reference });
            q += t * dq + t * t * (start / 2.0 + t * slope / 6.0);
            dq += t * (start + t * slope / 2.0);
            ddq = start + t * slope;
        }
        errors.push(rig.q - q);
        errors
    }

    /// The largest error that values within ±1 can cause, by the sign of the response to one of them.
    fn worst(&self, motion: Motion) -> f64 {
        let mut pulse = vec![0.0; LONG];
        pulse[0] = 1.0;
        let mut values: Vec<f64> =
            self.errors(motion, &pulse).iter().skip(1).map(|h| h.signum()).collect();
        values.reverse();
        self.errors(motion, &values).last().unwrap().abs()
    }
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for form in [Form::Literal, Form::Observer] {
        for (delay_samples, drive_bandwidth_hz) in [(0, None), (1, None), (2, Some(150.0))] {
            for (velocity, velocity_filter_hz) in
                [(VelocitySource::Measured, None), (VelocitySource::Differenced, Some(100.0))]
            {
                for (mu, a, feed_forward) in [
                    (0.6, &[60.0][..], true),
                    (1.0, &[60.0], false),
                    (1.7, &[1600.0, 80.0], true),
                    (1.2, &[1600.0, 80.0], false),
                ] {
                    let model = LoopModel {
                        period_s: 1e-3,
                        delay_samples,
                        velocity,
                        velocity_filter_hz,
                        torque_filter_hz: None,
                        form,
                        drive_bandwidth_hz,
                        sample_delay_samples: 0,
                        torque: phihat::TorqueSource::Applied,
                    };
                    let record = record(900.0, 60.0, a, 0.7);
                    cases.push(Case { record, model, feed_forward, mu });
                }
            }
        }
    }
    cases
}

#[test]
fn the_worst_motion_reaches_the_bound_and_does_not_pass_it() {
    for case in cases() {
        let Case { record, model, feed_forward, mu } = &case;
        let claim = ReferenceError::find(record, model, *feed_forward, (*mu, *mu), 2).unwrap();
        claim.verify(record, model).unwrap();
        let worst = case.worst(Motion::Acceleration);
        let tiny = 1e-11;
        println!(
            "{model:?} m {} forward {feed_forward} μ {mu}: {worst:e} of {claim:?}",
            record.a.len()
        );
        assert!(worst <= claim.acceleration * 1.001 + tiny, "acceleration");
        assert!(worst >= claim.acceleration * 0.98 - tiny, "acceleration: far inside");
        let Some(jerk) = claim.jerk else {
            // An error stays under constant acceleration.
            let errors = case.errors(Motion::Acceleration, &[1.0; LONG]);
            let last = errors[LONG];
            assert!(last.abs() > 1e-9 && (last - errors[LONG - 200]).abs() < 1e-3 * last.abs());
            continue;
        };
        let worst = case.worst(Motion::Jerk);
        assert!(worst <= jerk * 1.001 + tiny, "jerk: {worst:e} {jerk:e}");
        // A jerk that changes within an interval, which is not tried here, can do some T² more.
        let between = model.period_s * model.period_s;
        assert!(worst >= jerk * 0.95 - between, "jerk: far inside, {worst:e} {jerk:e}");
    }
}

#[test]
fn a_smaller_claim_is_refuted() {
    let case = cases().into_iter().nth(6).unwrap();
    let range = (0.5, 2.0);
    let mut claim = ReferenceError::find(&case.record, &case.model, false, range, 5).unwrap();
    claim.acceleration *= 0.99;
    let why = claim.verify(&case.record, &case.model).unwrap_err();
    assert!(why.inequality.contains("q̈_d"), "{why}");
}
