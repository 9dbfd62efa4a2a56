//! The inertia window against published reference values, eigenvalues and the running core. Wrong if the
//! loop lost stability anywhere but where `−L` crosses the real axis next to 1.

use crate::sampled_support::{Random, Rig, estimator, plain, record};
use phihat::{Form, VelocitySource};
use phihat_design::prelude::*;
use phihat_design::sampled::{InertiaWindow, LoopModel, StateMatrix};

fn differenced(delay: u32, form: Form, filter: Option<f64>) -> LoopModel {
    LoopModel {
        velocity: VelocitySource::Differenced,
        form,
        velocity_filter_hz: filter,
        ..plain(delay)
    }
}

#[test]
fn reference_values() {
    let mut cases: Vec<(Vec<f64>, LoopModel, f64, f64)> = vec![
        (vec![68.9], plain(0), 0.0545, 12.32),
        (vec![68.9], plain(1), 0.1107, 11.95),
        (vec![69.6 * 68.9, 68.9], plain(0), 0.0545, 3.40),
        (vec![69.6 * 68.9, 68.9], plain(1), 0.1138, 3.20),
        (vec![69.6 * 69.6, 139.2], plain(0), 0.0897, 6.65),
        (vec![69.6 * 69.6, 139.2], plain(1), 0.1854, 6.34),
    ];
    let literal = differenced(1, Form::Literal, None);
    // An earlier prototype, whose integrals were summed otherwise, had 11.9 and 3.18 here.
    cases.push((vec![68.9], literal, 0.137, 12.03));
    cases.push((vec![69.6 * 68.9, 68.9], literal, 0.146, 3.25));
    let observer = |filter| differenced(1, Form::Observer, filter);
    cases.push((vec![4900.0, 140.0], observer(None), 0.186, 5.92));
    cases.push((vec![4900.0, 140.0], observer(Some(100.0)), 0.218, 5.57));
    cases.push((vec![2500.0, 100.0], observer(Some(50.0)), 0.202, 4.67));
    for (a, model, low, high) in cases {
        let gains = record(400.0, 40.0, &a, 1.0);
        let found = InertiaWindow::find(&gains, &model).unwrap();
        println!("{a:?} {:?} delay {}: {found:?}", model.form, model.delay_samples);
        assert!((found.low / low - 1.0).abs() < 0.01, "{a:?} {model:?}: {found:?} {low}");
        assert!((found.high / high - 1.0).abs() < 0.01, "{a:?} {model:?}: {found:?} {high}");
        found.verify(&gains, &model).unwrap();
    }
}

/// A random joint and loop whose window contains 1.
pub(crate) fn draw(random: &mut Random) -> (phihat_design::JointRecord, LoopModel, InertiaWindow) {
    loop {
        let order = 1 + random.below(4) as usize;
        let w = random.around(5.0, 40.0);
        let kd = 2.0 * random.between(0.6, 1.2) * w;
        let a = estimator(order, random.around(10.0, 120.0), random.between(0.7, 1.1));
        let gains = record(w * w, kd, &a, random.around(0.01, 5.0));
        let some = |yes: bool, value: f64| yes.then_some(value);
        let filter = random.around(30.0, 300.0);
        let drive = random.around(40.0, 400.0);
        let model = LoopModel {
            period_s: 1e-3 / f64::from(1 + random.below(3)),
            delay_samples: random.below(4),
            velocity: [VelocitySource::Measured, VelocitySource::Differenced]
                [random.below(2) as usize],
            form: [Form::Observer, Form::Literal][random.below(2) as usize],
            velocity_filter_hz: some(random.unit() < 0.5, filter),
            torque_filter_hz: None,
            drive_bandwidth_hz: some(random.unit() < 0.5, drive),
            sample_delay_samples: 0,
            torque: phihat::TorqueSource::Applied,
        };
        if let Ok(window) = InertiaWindow::find(&gains, &model)
            && window.low < 0.95
            && window.high > 1.05
        {
            return (gains, model, window);
        }
    }
}

#[test]
fn f11_edges_are_where_the_running_core_loses_stability() {
    let mut random = Random(3);
    let (mut up, mut down) = (0, 0);
    let cases = if std::env::var_os("PHIHAT_ALL").is_some() { 200 } else { 60 };
    for case in 0..cases {
        let (gains, model, window) = draw(&mut random);
        window.verify(&gains, &model).unwrap();
        let radius = |mu: f64| StateMatrix::new(&gains, &model, mu).spectral_radius();
        let settles = |mu: f64| {
            // As long as the eigenvalues need to show a growth or decay by e^3.
            let rate = radius(mu).ln().abs().max(1e-7);
            let wanted = |samples: &usize| *samples as f64 > 3.0 / rate;
            let samples = (12..21).map(|k| 1_usize << k).find(wanted).unwrap_or(1 << 21);
            Rig::new(&gains, &model, mu).settles(samples)
        };
        let context = format!("case {case}: {gains:?} {model:?} {window:?}");
        assert!(radius(1.0) < 1.0, "{context}");
        for mu in [window.low * 1.02, window.high.min(1e4) * 0.98] {
            assert!(radius(mu) < 1.0 && settles(mu), "unstable at {mu}: {context}");
        }
        if window.low > 1e-6 {
            down += 1;
            let mu = window.low * 0.98;
            assert!(radius(mu) > 1.0 && !settles(mu), "stable at {mu}: {context}");
        }
        if window.high < 1e6 {
            up += 1;
            let mu = window.high * 1.02;
            assert!(radius(mu) > 1.0 && !settles(mu), "stable at {mu}: {context}");
        }
    }
    println!("{cases} draws, {down} with a lower, {up} with an upper edge");
}

#[test]
fn a_wider_window_is_refused() {
    let mut random = Random(4);
    for _ in 0..100 {
        let (gains, model, window) = draw(&mut random);
        let wider = InertiaWindow { low: window.low * 0.98, ..window };
        let higher = InertiaWindow { high: window.high * 1.02, ..window };
        assert!(wider.verify(&gains, &model).is_err());
        assert!(higher.verify(&gains, &model).is_err(), "{window:?}");
    }
}

#[test]
fn an_unstable_loop_has_no_window() {
    let gains = record(400.0, 4000.0, &[68.9], 1.0);
    assert!(InertiaWindow::find(&gains, &plain(1)).is_err());
    let claimed = InertiaWindow { low: 0.9, high: 1.1, low_hz: 1.0, high_hz: 1.0 };
    assert!(claimed.verify(&gains, &plain(1)).is_err());
}

#[test]
fn decay_is_that_of_the_slowest_eigenvalue() {
    let gains = record(400.0, 40.0, &[4900.0, 140.0], 1.0);
    let model = differenced(1, Form::Observer, Some(100.0));
    let window = InertiaWindow::find(&gains, &model).unwrap();
    let narrow = InertiaWindow { low: 0.5, high: 2.0, ..window };
    let slowest = (0..=60)
        .map(|k| StateMatrix::new(&gains, &model, 0.5 * 4.0_f64.powf(f64::from(k) / 60.0)))
        .map(|matrix| matrix.decay_rate())
        .fold(f64::INFINITY, f64::min);
    assert!(slowest > 0.0);
    narrow.verify_decay(&gains, &model, slowest * 0.99).unwrap();
    assert!(narrow.verify_decay(&gains, &model, slowest * 1.02).is_err());
}

#[test]
fn implausible_gains_and_loops_are_refused_by_name() {
    let good = record(400.0, 40.0, &[68.9], 1.0);
    let window = InertiaWindow::find(&good, &plain(1)).unwrap();
    for bad in [
        record(400.0, 40.0, &[], 1.0),
        record(400.0, 40.0, &[1.0; 5], 1.0),
        record(f64::NAN, 40.0, &[68.9], 1.0),
        record(400.0, -40.0, &[68.9], 1.0),
        record(400.0, 40.0, &[f64::INFINITY], 1.0),
    ] {
        assert!(InertiaWindow::find(&bad, &plain(1)).is_err());
        assert!(window.verify(&bad, &plain(1)).is_err());
    }
    let models = [
        LoopModel { period_s: 0.0, ..plain(1) },
        LoopModel { velocity_filter_hz: Some(-1.0), ..plain(1) },
        LoopModel { drive_bandwidth_hz: Some(f64::NAN), ..plain(1) },
        plain(9),
    ];
    for model in models {
        assert!(window.verify(&good, &model).is_err(), "{model:?}");
    }
    for (low, high) in [(0.0, 1.0), (-1.0, 1.0), (f64::NAN, 1.0), (2.0, 1.0), (0.5, f64::INFINITY)]
    {
        let claim = InertiaWindow { low, high, ..window };
        assert!(claim.verify(&good, &plain(1)).is_err(), "{low} {high}");
    }
}
