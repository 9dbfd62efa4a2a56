//! Torque noise from an encoder is what the running core shows on a moving joint, to 30 %; the bound on the
//! change is reached by the worst sequence of errors. Wrong if quantisation were not white there, or the
//! path from encoder to torque differed from the code.

use crate::sampled_support::{Outside, Random, Rig, plain, record};
use phihat::{Form, Reference, VelocitySource};
use phihat_design::prelude::*;
use phihat_design::sampled::{LargestStep, LoopModel, StateMatrix, TorqueNoise};

fn differenced(filter: Option<f64>, form: Form) -> LoopModel {
    LoopModel {
        velocity: VelocitySource::Differenced,
        velocity_filter_hz: filter,
        form,
        ..plain(1)
    }
}

/// rms of the torque's high frequencies and of its change, on a slow sweep, against the same without quantum.
fn simulated(gains: &phihat_design::JointRecord, model: &LoopModel, quantum: f64) -> (f64, f64) {
    let mut rough = Rig::new(gains, model, 1.0);
    let mut smooth = Rig::new(gains, model, 1.0);
    rough.quantum = quantum;
    let (mut sum, mut changes, mut last, mut count) = (0.0, 0.0, 0.0, 0.0);
    for k in 0..60_000 {
        // 1.5 rad/s with a slow swing on top: hundreds of quanta per sample at 22 bits, a few at 14.
        let t = f64::from(k) * 1e-3;
        let reference = Reference {
            q: 1.5 * t + 0.5 * (0.7 * t).sin(),
            dq: 1.5 + 0.35 * (0.7 * t).cos(),
            ddq: -0.245 * (0.7 * t).sin(),
        };
        let outside = Outside { reference, ..Outside::default() };
        let difference = rough.step(&outside).tau - smooth.step(&outside).tau;
        if k > 5_000 {
            sum += difference * difference;
            changes += (difference - last) * (difference - last);
            count += 1.0;
        }
        last = difference;
    }
    ((sum / count).sqrt(), (changes / count).sqrt())
}

#[test]
fn f03_prediction_is_what_the_core_shows() {
    let mut worst = 0.0_f64;
    for (a, filter, form) in [
        (vec![68.9], None, Form::Literal),
        (vec![4900.0, 140.0], None, Form::Observer),
        (vec![4900.0, 140.0], Some(100.0), Form::Observer),
    ] {
        let gains = record(400.0, 40.0, &a, 0.8);
        let model = differenced(filter, form);
        for bits in [10, 12, 14, 16, 18, 20, 22, 24] {
            let quantum = TorqueNoise::quantum(bits);
            let claim = TorqueNoise::find(&gains, &model, quantum, (1.0, 1.0), 1).unwrap();
            claim.verify(&gains, &model).unwrap();
            let (rms, change) = simulated(&gains, &model, quantum);
            println!(
                "m {} filter {filter:?} {bits} bit: rms {:.3e} (core {rms:.3e}), change {:.3e} (core {change:.3e}), at \
                    most {:.3e} N m",
                a.len(),
                claim.rms_nm,
                claim.change_rms_nm,
                claim.change_max_nm
            );
            for (found, wanted) in [(claim.rms_nm, rms), (claim.change_rms_nm, change)] {
                worst = worst.max((found / wanted - 1.0).abs());
                assert!((found / wanted - 1.0).abs() < 0.3, "{bits} bit: {found} {wanted}");
            }
        }
    }
    println!("worst deviation {:.1} %", worst * 100.0);
}

#[test]
fn the_bound_on_the_change_is_reached() {
    let gains = record(400.0, 40.0, &[4900.0, 140.0], 0.8);
    let model = differenced(Some(100.0), Form::Observer);
    let claim = TorqueNoise::find(&gains, &model, 1e-4, (1.0, 1.0), 1).unwrap();
    let matrix = StateMatrix::new(&gains, &model, 1.0);
    // Impulse response of the change, from the matrix; the worst sequence is its sign, backwards in time.
    let n = 2_000;
    let reaction = matrix.encoder();
    let mut h = vec![reaction.direct];
    let mut x = reaction.drives.clone();
    for _ in 1..n {
        h.push((&reaction.state * &x)[0]);
        x = matrix.matrix() * x;
    }
    let change: Vec<f64> = (0..n).map(|k| h[k] - if k > 0 { h[k - 1] } else { 0.0 }).collect();
    let mut rig = Rig::new(&gains, &model, 1.0);
    let (mut last, mut reached) = (0.0, 0.0_f64);
    for k in 0..n {
        let encoder = 0.5e-4 * change[n - 1 - k].signum();
        let tau = rig.step(&Outside { encoder, ..Outside::default() }).tau;
        reached = reached.max((tau - last).abs());
        last = tau;
    }
    println!("bound {:.6}, reached {reached:.6}", claim.change_max_nm);
    assert!(reached <= claim.change_max_nm * (1.0 + 1e-9));
    assert!(reached > 0.95 * claim.change_max_nm);
}

#[test]
fn the_largest_step_stays_within_the_limits_and_more_does_not() {
    let mut random = Random(8);
    for case in 0..60 {
        let w = random.around(8.0, 25.0);
        let a =
            [vec![60.0], vec![4900.0, 140.0], vec![1600.0, 80.0]][random.below(3) as usize].clone();
        let gains = record(w * w, 2.0 * w, &a, random.around(0.1, 3.0));
        let form = [Form::Observer, Form::Literal][random.below(2) as usize];
        let model = differenced(Some(100.0), form);
        let limits = (Some(20.0), (random.unit() < 0.5).then_some(1000.0));
        let Ok(found) = LargestStep::find(&gains, &model, limits, (0.6, 2.0), 5) else { continue };
        found.verify(&gains, &model, limits).unwrap();
        let step = found.step_rad.unwrap();
        let worst = |step: f64| {
            let mut limited = 0;
            for mu in &found.mu {
                let mut rig = Rig::new(&gains, &model, *mu).limited(limits.0, limits.1);
                let reference = Reference { q: step, ..Reference::default() };
                for _ in 0..3000 {
                    let status = rig.step(&Outside { reference, ..Outside::default() }).status;
                    limited += i32::from(status.saturated || status.rate_limited);
                }
            }
            limited
        };
        assert_eq!(worst(step * 0.999), 0, "case {case}");
        assert!(worst(step * 1.001) > 0, "case {case}");
        let more = LargestStep { step_rad: Some(step * 1.01), ..found };
        assert!(more.verify(&gains, &model, limits).is_err());
    }
}
