//! `N/Δ` and `K/Δ` of laws from positions against the core's own law, cut open where its torque meets the
//! inertia. Wrong if a kick or an acceleration of one sample were answered by another torque than the proofs
//! count.

use phihat::{Form, JointState, Measurement, Reference, TorqueSource, VelocitySource};

use phihat_kernel::{Number, Polynomial};

use super::complex::Complex;
use super::filter_tests::core;
use super::linear;
use crate::{FilterSection, JointRecord, LoopModel, PositionObserver};

/// The torques that act, in units of `M̄`, where the joint is at `q`.
fn answer(record: &JointRecord, model: &LoopModel, q: impl Fn(u32) -> f64) -> Option<Vec<f64>> {
    let law = core(record)?;
    let mut state = JointState::new();
    let mut line = vec![0.0; (model.delay_samples + model.sample_delay_samples) as usize];
    let mut acted = Vec::new();
    let mut last = 0.0;
    let zero = Reference { q: 0.0, dq: 0.0, ddq: 0.0 };
    // The first sample tells the law where it is.
    for k in 0..160_u32 {
        let at = if k == 0 { 0.0 } else { q(k - 1) };
        let seen = Measurement { q: at, dq: 0.0, tau_applied: last };
        line.push(law.update(&mut state, &seen, &zero).tau);
        last = line.remove(0);
        acted.push(last / record.inertia_kg_m2);
    }
    Some(acted.split_off(1))
}

#[test]
fn the_loop_answers_an_acceleration_and_a_kick_as_the_core_does() {
    let t = 1e-3;
    let cases =
        [(0, 0, 0, 1), (1, 1, 0, 1), (2, 1, 1, 2), (3, 2, 1, 2), (1, 4, 0, 3), (4, 1, 0, 1)];
    let sections = [([0.03, 0.2], [-90.0, 4000.0]), ([1.1, 1.6], [800.0, -300.0])]
        .map(|(rates, weights_per_s2)| FilterSection { rates, weights_per_s2 });
    for (case, count) in cases.into_iter().flat_map(|case| [0, 1, 2].map(|count| (case, count))) {
        let (delay_samples, late, sampled, order) = case;
        let record = JointRecord {
            name: "joint".into(),
            inertia_kg_m2: 0.7,
            kp_per_s2: 600.0,
            kd_per_s: 50.0,
            a: vec![],
            observer: Some(PositionObserver {
                correction: [0.4, 110.0, -9e3, -3e5, -5e6][..order + 2].to_vec(),
                share: 0.3,
                delay_samples,
                innovation_filter: sections[..count].to_vec(),
            }),
        };
        let model = LoopModel {
            period_s: t,
            delay_samples: late,
            sample_delay_samples: sampled,
            torque: TorqueSource::Applied,
            velocity: VelocitySource::Measured,
            velocity_filter_hz: None,
            torque_filter_hz: None,
            form: Form::Positions,
            drive_bandwidth_hz: None,
        };
        let half = 0.5 * t * t;
        let pushed = |k: u32| if k == 0 { 0.0 } else { half + t * t * f64::from(k - 1) };
        let kicked = |k: u32| if k == 0 { 0.0 } else { half };
        let joint = linear::joint("", &record, &model).unwrap();
        for turn in [0.0_f64, 0.3, 1.4, 2.9] {
            let z = Complex::new(2.0 * turn.cos(), 2.0 * turn.sin());
            let value = |p: &Polynomial| {
                let none = Complex::new(0.0, 0.0);
                let c = p.coefficients().iter().map(Number::near);
                c.rev().fold(none, |sum, c| sum * z + Complex::new(c, 0.0))
            };
            for (seen, back) in [
                (answer(&record, &model, pushed), &joint.back),
                (answer(&record, &model, kicked), joint.kick.as_ref().unwrap()),
            ] {
                let mut sum = Complex::new(0.0, 0.0);
                for torque in seen.unwrap_or_default().iter().rev() {
                    sum = sum.over(z) + Complex::new(*torque, 0.0);
                }
                let wanted = -value(back).over(value(&joint.open));
                let off = (sum - wanted).size() / wanted.size();
                assert!(off < 1e-9, "{off} {turn} {order} {delay_samples} {late} {count}");
            }
        }
    }
}
