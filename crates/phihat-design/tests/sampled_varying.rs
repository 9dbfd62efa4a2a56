//! A range of varying inertia is certified up to the reference values and not beyond, and the proof does not
//! survive damage. Wrong if `P` were accepted without falling along the loop at both ends.

use crate::sampled_support::{Random, estimator, plain, record};
use phihat::{Form, VelocitySource};
use phihat_design::prelude::*;
use phihat_design::sampled::{LoopModel, SampledVarying, StateMatrix, VaryingWindow};

#[test]
fn reference_ranges() {
    let m1 = record(400.0, 40.0, &[69.6], 1.0);
    let m2 = record(400.0, 40.0, &[4844.0, 139.2], 1.0);
    for (gains, inside, outside) in [(&m1, 4.0, 6.0), (&m2, 3.0, 6.0)] {
        VaryingWindow::find(gains, (0.05, inside)).unwrap().verify(gains).unwrap();
        assert!(VaryingWindow::find(gains, (0.05, outside)).is_err());
        let widest = VaryingWindow::widest_from(gains, 0.05, 100.0).unwrap();
        let around = VaryingWindow::widest_around(gains, 1.0, 1e4).unwrap();
        println!(
            "m {}: 0.05 … {:.3}, around 1: {:.4} … {:.3}",
            gains.a.len(),
            widest.high,
            around.low,
            around.high
        );
        assert!(inside <= widest.high && widest.high < outside);
    }
}

#[test]
fn the_form_falls_along_switched_trajectories() {
    // x' = A(λ(t)) x with λ switched against V: the worst choice still has to lose.
    let gains = record(400.0, 40.0, &[4844.0, 139.2], 1.0);
    let window = VaryingWindow::find(&gains, (0.3, 2.5)).unwrap();
    let r = window.rate_per_s;
    let k = [
        4844.0 * 400.0 / r.powi(4),
        (139.2 * 400.0 + 4844.0 * 40.0) / r.powi(3),
        (400.0 + 139.2 * 40.0 + 4844.0) / r.powi(2),
        (40.0 + 139.2) / r,
    ];
    let value = |x: &[f64; 4]| -> f64 {
        (0..4)
            .flat_map(|i| (0..4).map(move |j| (i, j)))
            .map(|(i, j)| x[i] * window.p[i][j] * x[j])
            .sum()
    };
    let mut random = Random(5);
    for _ in 0..1000 {
        let x: [f64; 4] = std::array::from_fn(|_| random.between(-1.0, 1.0));
        for mu in [0.3, 0.31, 1.0, 2.4, 2.5] {
            let pull: f64 = -(0..4).map(|i| k[i] * x[i]).sum::<f64>() / mu;
            let h = 1e-7;
            let next = [x[0] + h * x[1], x[1] + h * x[2], x[2] + h * x[3], x[3] + h * pull];
            assert!(value(&next) < value(&x));
        }
    }
}

#[test]
fn orders_three_and_four_have_a_range_too() {
    for order in [3, 4] {
        let gains = record(400.0, 40.0, &estimator(order, 60.0, 1.0), 1.0);
        let found = VaryingWindow::widest_around(&gains, 1.0, 100.0).unwrap();
        println!("m {order}: {:.3} … {:.3}", found.low, found.high);
        found.verify(&gains).unwrap();
        assert!(found.high > 1.2);
    }
}

#[test]
fn damage_is_refused() {
    let gains = record(400.0, 40.0, &[4844.0, 139.2], 1.0);
    let found = VaryingWindow::widest_from(&gains, 0.05, 100.0).unwrap();
    found.verify(&gains).unwrap();
    let wider = VaryingWindow { high: found.high * 1.3, ..found.clone() };
    assert!(wider.verify(&gains).is_err());
    for i in 0..4 {
        for j in 0..=i {
            let mut bad = found.clone();
            bad.p[i][j] *= -1.0;
            bad.p[j][i] = bad.p[i][j];
            assert!(bad.verify(&gains).is_err(), "P[{i}][{j}]");
        }
    }
    let mut lopsided = found.clone();
    lopsided.p[0][1] *= 1.0 + 1e-9;
    assert!(lopsided.verify(&gains).is_err());
    let mut holed = found.clone();
    holed.p[2][2] = f64::NAN;
    assert!(holed.verify(&gains).is_err());
    let mut small = found.clone();
    small.p.pop();
    assert!(small.verify(&gains).is_err());
    let other = record(400.0, 20.0, &[4844.0, 139.2], 1.0);
    assert!(found.verify(&other).is_err());
}

/// A loop with everything in it: delay, differenced velocity, filter.
fn rough() -> LoopModel {
    LoopModel {
        form: Form::Observer,
        velocity: VelocitySource::Differenced,
        velocity_filter_hz: Some(100.0),
        ..plain(1)
    }
}

#[test]
fn the_sampled_form_falls_under_any_switching_of_the_inertia() {
    let gains = record(225.0, 30.0, &[2500.0, 100.0], 1.0);
    let model = rough();
    let found = SampledVarying::widest_within(&gains, &model, (0.3, 5.0)).unwrap();
    println!("sampled, m 2: {:.3} … {:.3}", found.low, found.high);
    assert!(found.high / found.low > 2.0);
    let n = found.p.len();
    let value = |x: &nalgebra::DVector<f64>| -> f64 {
        (0..n)
            .flat_map(|i| (0..n).map(move |j| (i, j)))
            .map(|(i, j)| x[i] * found.p[i][j] * x[j])
            .sum()
    };
    let inside = |share: f64| found.low * (found.high / found.low).powf(share);
    let ends: Vec<_> = [0.0, 0.1, 0.5, 0.9, 1.0]
        .map(|share| StateMatrix::new(&gains, &model, inside(share)).matrix().clone())
        .into();
    let mut random = Random(7);
    for _ in 0..200 {
        let mut x = nalgebra::DVector::from_fn(n, |_, _| random.between(-1.0, 1.0));
        for _ in 0..50 {
            // The inertia that is worst for the form, at every sample.
            let next = ends.iter().map(|a| a * &x).max_by(|a, b| value(a).total_cmp(&value(b)));
            let next = next.unwrap();
            assert!(value(&next) < value(&x));
            x = next;
        }
    }
}

#[test]
fn a_damaged_sampled_form_is_refused() {
    let gains = record(225.0, 30.0, &[2500.0, 100.0], 1.0);
    let model = rough();
    let found = SampledVarying::widest_within(&gains, &model, (0.3, 5.0)).unwrap();
    found.verify(&gains, &model).unwrap();
    assert!(SampledVarying::find(&gains, &model, (0.01, 100.0)).is_err());
    let wider = SampledVarying { high: found.high * 3.0, ..found.clone() };
    assert!(wider.verify(&gains, &model).is_err());
    for i in 0..found.p.len() {
        let mut bad = found.clone();
        bad.p[i][i] *= -1.0;
        assert!(bad.verify(&gains, &model).is_err(), "P[{i}][{i}]");
    }
    let mut holed = found.clone();
    holed.p[1][1] = f64::NAN;
    assert!(holed.verify(&gains, &model).is_err());
    let mut small = found.clone();
    small.p.pop();
    assert!(small.verify(&gains, &model).is_err());
    let late = LoopModel { delay_samples: 6, ..model };
    assert!(found.verify(&gains, &late).is_err());
}
