//! Peak gains are reached, to 5 %, by the worst `φ` on the running core, and never exceeded. Wrong if the loop
//! answered `φ` otherwise than its matrix, or the sums missed a tail.

use crate::sampled_support::{Outside, Random, Rig, plain, record};
use nalgebra::DVector;
use phihat::{Form, VelocitySource};
use phihat_design::prelude::*;
use phihat_design::sampled::{LoopModel, SampledPeaks, StateMatrix};

const SAMPLES: usize = 4_000;

fn loops() -> Vec<(phihat_design::JointRecord, LoopModel, f64)> {
    let observer = LoopModel { form: Form::Observer, ..plain(1) };
    let rough = LoopModel {
        velocity: VelocitySource::Differenced,
        velocity_filter_hz: Some(100.0),
        drive_bandwidth_hz: Some(200.0),
        ..observer
    };
    vec![
        (record(400.0, 40.0, &[68.9], 1.0), plain(0), 1.0),
        (record(400.0, 40.0, &[4844.0, 139.2], 0.6), plain(1), 2.0),
        (
            record(400.0, 40.0, &[4900.0, 140.0], 0.6),
            LoopModel { delay_samples: 0, ..observer },
            0.5,
        ),
        (record(400.0, 40.0, &[4900.0, 140.0], 1.3), observer, 2.0),
        (record(225.0, 30.0, &[2500.0, 100.0], 0.2), rough, 0.8),
    ]
}

/// Lag by lag, what a unit of `φ/M̄` held (or of `φ̇/M̄`, ramped) over one interval leaves in `∫e, e, ė`.
fn kernel(matrix: &StateMatrix, shape: Shape) -> Vec<[f64; 3]> {
    let (t, w, mu) = (matrix.period(), matrix.unit(), matrix.mu());
    let ramp = shape != Shape::Held;
    let mut slope = t;
    let mut x = if shape == Shape::Stairs {
        matrix.disturbance() * t
    } else if shape == Shape::Parabola {
        matrix.disturbance() * (t * t)
    } else if ramp {
        let mut x = DVector::zeros(matrix.matrix().nrows());
        (x[0], x[1]) = (-t * t * t / (6.0 * mu), -t * t / (2.0 * mu * w));
        x
    } else {
        matrix.disturbance().clone()
    };
    let mut sum = 0.0;
    (0..SAMPLES)
        .map(|_| {
            sum += t * x[0];
            let now = [sum, x[0], w * x[1]];
            x = matrix.matrix() * &x;
            if shape == Shape::Parabola {
                slope += t;
                x += matrix.disturbance() * (t * slope);
            } else if ramp {
                x += matrix.disturbance() * t;
            }
            now
        })
        .collect()
}

/// `φ` over the intervals: held, ramped, a staircase of the ramp's slope (what `∫e` is claimed for), or one whose
/// steps grow (what `φ̈` is claimed for).
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    Held,
    Ramp,
    Stairs,
    Parabola,
}

/// Largest `(∫e, e, ė)` of the running core under `signs`, oldest first.
fn reached(rig: &mut Rig, signs: &[f64], shape: Shape) -> [f64; 3] {
    let unit = rig.gains.inertia();
    let t = rig.model.period_s;
    let (mut phi, mut sum, mut slope) = (0.0, 0.0, 0.0);
    let mut worst = [0.0_f64; 3];
    for sign in signs {
        slope += sign * unit * t;
        let step = if shape == Shape::Parabola { slope * t } else { sign * unit * t };
        let outside = match shape {
            Shape::Held => Outside { phi: sign * unit, ..Outside::default() },
            Shape::Ramp => Outside { phi, phi_slope: sign * unit, ..Outside::default() },
            Shape::Stairs | Shape::Parabola => Outside { phi: phi + step, ..Outside::default() },
        };
        phi += step;
        let _ = rig.step(&outside);
        sum += t * rig.q;
        for (worst, now) in worst.iter_mut().zip([sum, rig.q, rig.dq]) {
            *worst = worst.max(now.abs());
        }
    }
    worst
}

/// Pairs of output and shape for which a gain is claimed.
const PAIRS: [(usize, Shape); 9] = [
    (0, Shape::Held),
    (1, Shape::Held),
    (2, Shape::Held),
    (0, Shape::Stairs),
    (1, Shape::Ramp),
    (2, Shape::Ramp),
    (0, Shape::Parabola),
    (1, Shape::Parabola),
    (2, Shape::Parabola),
];

fn bound(claim: &SampledPeaks, i: usize, shape: Shape) -> Option<f64> {
    match shape {
        Shape::Held => Some(claim.jump[i]),
        Shape::Parabola => claim.bend[i],
        _ => claim.ramp[i],
    }
}

#[test]
fn worst_disturbances_reach_the_gains() {
    for (gains, model, mu) in loops() {
        let claim = SampledPeaks::at(&gains, &model, mu).unwrap();
        claim.verify(&gains, &model).unwrap();
        println!("{:?} delay {} μ {mu}: {claim:?}", model.form, model.delay_samples);
        let matrix = StateMatrix::new(&gains, &model, mu);
        for (i, shape) in PAIRS {
            let Some(bound) = bound(&claim, i, shape) else { continue };
            let kernel = kernel(&matrix, shape);
            let signs: Vec<f64> = kernel.iter().rev().map(|k| k[i].signum()).collect();
            let found = reached(&mut Rig::new(&gains, &model, mu), &signs, shape)[i];
            assert!(found <= bound * (1.0 + 1e-6), "{shape:?} {i}: {found} {bound} {model:?}");
            assert!(found > 0.95 * bound, "{shape:?} {i}: {found} {bound} {model:?}");
        }
    }
}

#[test]
fn random_disturbances_stay_below() {
    let mut random = Random(9);
    for (gains, model, mu) in loops() {
        let claim = SampledPeaks::at(&gains, &model, mu).unwrap();
        for (i, shape) in PAIRS {
            let mut sign = 1.0;
            let mut flip = |_| {
                sign = if random.unit() < 0.02 { -sign } else { sign };
                sign
            };
            let signs: Vec<f64> = (0..20_000).map(&mut flip).collect();
            let found = reached(&mut Rig::new(&gains, &model, mu), &signs, shape)[i];
            assert!(bound(&claim, i, shape).is_none_or(|bound| found <= bound));
        }
    }
}

#[test]
fn a_late_observer_grows_under_a_ramp_and_smaller_gains_are_refused() {
    let gains = record(400.0, 40.0, &[4900.0, 140.0], 1.0);
    let late = LoopModel { form: Form::Observer, ..plain(1) };
    let at = |model: &LoopModel| SampledPeaks::at(&gains, model, 1.0).unwrap();
    assert!(at(&late).ramp[0].is_none());
    assert!(at(&LoopModel { delay_samples: 0, ..late }).ramp[0].is_some());
    assert!(at(&plain(1)).ramp[0].is_some());
    // The lag of a ramp, less what the shift of the sampled velocity gives back.
    let lag = 1e-3 / 400.0 - 40.0 / 400.0 * 1e-6 / 12.0;
    let steady = {
        let mut rig = Rig::new(&gains, &late, 1.0);
        let steady = vec![1.0; 4000];
        let _ = reached(&mut rig, &steady, Shape::Ramp);
        -rig.q
    };
    assert!((steady / lag - 1.0).abs() < 1e-3, "{steady} {lag}");
    let worst = SampledPeaks::find(&gains, &late, (0.4, 3.0), 9).unwrap();
    worst.verify(&gains, &late).unwrap();
    for i in 0..3 {
        let mut bad = worst.clone();
        bad.jump[i] *= 0.99;
        assert!(bad.verify(&gains, &late).is_err());
    }
    let mut bad = worst.clone();
    bad.ramp[1] = bad.ramp[1].map(|r| r * 0.99);
    assert!(bad.verify(&gains, &late).is_err());
}
