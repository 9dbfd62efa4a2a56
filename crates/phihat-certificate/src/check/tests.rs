//! The arithmetic of the checks against closed forms and sums. Wrong if a polynomial below zero counted as one above,
//! or a matrix that is not definite passed.

use core::f64::consts::PI;
use phihat::{Form, TorqueSource, VelocitySource};

use super::agree::agrees;
use super::complex::Complex;
use super::definite::{definite, definite_within};
use super::drive::drive;
use super::integral::{of_line, of_parabola};
use super::plausible::{at_most, enough, gains, model, ratios};
use super::polynomial::{not_negative, product, squared, value};
use crate::dice::CheckDice;
use crate::{FilterSection, JointRecord, LoopModel, PositionObserver};

#[test]
fn complex_numbers_are_what_they_are() {
    let one = Complex::new(3.0, 4.0);
    let same = |x: Complex, re: f64, im: f64| (x - Complex::new(re, im)).size() < 1e-14;
    assert!(same(one * Complex::new(2.0, -1.0), 10.0, 5.0) && same(one.conjugate(), 3.0, -4.0));
    assert!(same(one.over(Complex::new(0.0, 2.0)), 2.0, -1.5) && same(-one, -3.0, -4.0));
    assert!(same(one + one.times(-0.5), 1.5, 2.0));
    // Neither overflows nor is lost.
    for scale in [1e-200, 1.0, 1e200] {
        assert!((one.times(scale).size() / scale - 5.0).abs() < 1e-14);
    }
}

#[test]
fn a_polynomial_above_zero_is_told_from_one_below() {
    // (w − a)² + e, times w, times (w + 1)², scaled in w and in size.
    for a in [1e-6, 0.3, 1.0, 7.0, 1e6] {
        for scale in [1e-9, 1.0, 1e9] {
            for room in [1e-2, 1e-6] {
                let square = |e: f64| vec![a * a * (1.0 + e), -2.0 * a, 1.0];
                let others = [
                    vec![scale],
                    vec![0.0, 0.0, scale],
                    product(&[1.0, 1.0 / a], &[scale, 0.5 * scale / a]),
                ];
                for other in others {
                    assert!(not_negative(&product(&square(room), &other)), "{a} {scale} {room}");
                    assert!(!not_negative(&product(&square(-room), &other)), "{a} {scale} {room}");
                }
            }
        }
    }
    // Of degree 6, with three valleys at different depths.
    let valleys = |depth: f64| {
        let p = [1.0, 2.0, 3.0].map(|r| vec![r * r + 1e-4, -2.0 * r, 1.0]);
        let mut all = product(&product(&p[0], &p[1]), &p[2]);
        all[0] -= depth;
        all
    };
    assert!(not_negative(&valleys(0.0)));
    // At 2 the product is 1e-4 (1 + 1e-4)², at 1 and 3 about 4e-4: less by 2e-4 it is below zero in the middle only.
    assert!(not_negative(&valleys(0.9e-4)) && !not_negative(&valleys(1.1e-4)));
    assert!(not_negative(&[]) && not_negative(&[0.0, 0.0]) && not_negative(&[0.0, 2.0]));
    assert!(!not_negative(&[-1e-30, 1.0]) && !not_negative(&[1.0, 0.0, -1e-30]));
    assert!(!not_negative(&[0.0, -1.0, 1.0]) && not_negative(&[1.0, -1.0, 1.0]));
    for bad in [f64::NAN, f64::INFINITY] {
        assert!(!not_negative(&[1.0, bad]) && !not_negative(&[bad, 1.0]));
    }
}

#[test]
fn squares_of_magnitudes_are_those_of_the_response() {
    let mut dice = CheckDice(5);
    for length in 1..=7_usize {
        let p: Vec<f64> = (0..length).map(|_| dice.roll()).collect();
        for w in [0.0, 0.4, 1.0, 2.5] {
            let jw = Complex::new(0.0, w);
            let none = Complex::new(0.0, 0.0);
            let size = p.iter().rev().fold(none, |sum, c| sum * jw + Complex::new(*c, 0.0)).size();
            assert!((value(&squared(&p), w * w) - size * size).abs() < 1e-12 * (1.0 + size * size));
        }
    }
    assert_eq!(product(&[1.0, 1.0], &[-1.0, 1.0]), [-1.0, 0.0, 1.0]);
}

#[test]
fn a_matrix_is_definite_up_to_its_edge() {
    let checked = |x: &[&[f64]]| {
        let x = x.iter().map(|row| row.to_vec()).collect();
        definite("claim", "X ≻ 0", &x).is_ok()
    };
    for (a, b) in [(1.0, 1.0), (4.0, 1e-6), (1e8, 3.0)] {
        let edge = f64::sqrt(a * b);
        for sign in [1.0, -1.0] {
            let [inside, outside] = [1.0 - 1e-9, 1.0 + 1e-9].map(|share| sign * edge * share);
            assert!(checked(&[&[a, inside], &[inside, b]]), "{a} {b}");
            assert!(!checked(&[&[a, outside], &[outside, b]]), "{a} {b}");
        }
    }
    // 2 − 1 1 … : the last pivot is t − 2/3.
    let chain = |t: f64| checked(&[&[2.0, -1.0, 0.0], &[-1.0, 2.0, -1.0], &[0.0, -1.0, t]]);
    assert!(chain(2.0 / 3.0 + 1e-9) && !chain(2.0 / 3.0 - 1e-9));
    // Full: 1 on the diagonal, c beside it, definite for −1/2 < c < 1.
    let full = |c: f64| checked(&[&[1.0, c, c], &[c, 1.0, c], &[c, c, 1.0]]);
    assert!(full(-0.5 + 1e-9) && !full(-0.5 - 1e-9) && full(1.0 - 1e-9) && !full(1.0));
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(!checked(&[&[bad, 0.0], &[0.0, 1.0]]) && !checked(&[&[1.0, 0.0], &[0.0, bad]]));
    }
    assert!(!checked(&[&[1.0, f64::NAN], &[f64::NAN, 1.0]]));
    // Room is taken off a diagonal of ones.
    let within = |c: f64, room: f64| {
        definite_within("claim", "X ≻ 0", &vec![vec![9.0, 9.0 * c], vec![9.0 * c, 9.0]], room)
            .is_ok()
    };
    assert!(within(0.89, 0.1) && !within(0.91, 0.1) && within(0.91, 0.05));
}

/// `∫_0^1 |p|` by many middles.
fn area(p: impl Fn(f64) -> f64) -> f64 {
    let n = 20_000_u32;
    (0..n).map(|k| p((f64::from(k) + 0.5) / f64::from(n)).abs()).sum::<f64>() / f64::from(n)
}

#[test]
fn mean_sizes_are_areas() {
    let mut dice = CheckDice(9);
    for _ in 0..200 {
        let [a, m, b] = [0; 3].map(|_| dice.roll());
        let own = of_line(a, b);
        assert!((own - area(|u| a + (b - a) * u)).abs() < 1e-6, "{a} {b}");
        let parabola = |u: f64| {
            a * (1.0 - u) * (1.0 - 2.0 * u) + 4.0 * m * u * (1.0 - u) + b * u * (2.0 * u - 1.0)
        };
        let own = of_parabola(a, m, b);
        assert!((own - area(parabola)).abs() < 1e-6, "{a} {m} {b}");
    }
    let same = |own: f64, want: f64| (own - want).abs() < 1e-14;
    assert!(same(of_line(3.0, -1.0), 1.25) && same(of_line(-1.0, -2.0), 1.5));
    assert!(same(of_line(0.0, 0.0), 0.0) && same(of_line(0.0, -4.0), 2.0));
    // A line, a parabola that touches zero, one with both zeros inside: u² − u + 3/16 from 1/4 to 3/4.
    assert!(
        same(of_parabola(3.0, 1.0, -1.0), 1.25) && same(of_parabola(0.25, 0.0, 0.25), 1.0 / 12.0)
    );
    assert!(same(of_parabola(0.1875, -0.0625, 0.1875), 1.0 / 16.0));
    assert!(same(of_parabola(0.0, 0.0, 0.0), 0.0) && same(of_parabola(2.0, 2.0, 2.0), 2.0));
}

/// A loop without delay, filter or drive.
pub(crate) fn plain() -> LoopModel {
    LoopModel {
        period_s: 1e-3,
        delay_samples: 0,
        sample_delay_samples: 0,
        torque: TorqueSource::Applied,
        velocity: VelocitySource::Measured,
        velocity_filter_hz: None,
        torque_filter_hz: None,
        form: Form::Observer,
        drive_bandwidth_hz: None,
    }
}

#[test]
fn a_drive_is_the_integral_of_its_decay() -> Result<(), &'static str> {
    // On both sides of where the series ends, and far beyond.
    for hz in [0.1, 4.0, 4.7, 4.8, 5.0, 150.0, 800.0] {
        for period in [1e-3, 4e-3] {
            let model = LoopModel { period_s: period, drive_bandwidth_hz: Some(hz), ..plain() };
            let own = drive(&model).ok_or("a drive")?;
            let w = 2.0 * PI * hz;
            // Simpson, fine.
            let n = 2000_u32;
            let simpson = |f: &dyn Fn(f64) -> f64| {
                let at = |k: u32| f(period * f64::from(k) / f64::from(n));
                let inner: f64 = (1..n).map(|k| if k % 2 == 0 { 2.0 } else { 4.0 } * at(k)).sum();
                (at(0) + inner + at(n)) * period / f64::from(3 * n)
            };
            let near = |own: f64, want: f64| (own - want).abs() < 1e-8 * want.abs();
            assert!(near(own.lost, 1.0 - (-w * period).exp()), "{hz}");
            assert!(near(own.mean, simpson(&|t| (-w * t).exp()) / period), "{hz}");
            assert!(near(own.double, simpson(&|t| (period - t) * (-w * t).exp())), "{hz}");
        }
    }
    assert!(drive(&plain()).is_none());
    Ok(())
}

/// Gains of a law that is fed with velocity.
fn fed() -> JointRecord {
    JointRecord {
        name: String::new(),
        inertia_kg_m2: 1.0,
        kp_per_s2: 5.0,
        kd_per_s: 3.0,
        a: vec![7.0; 4],
        observer: None,
    }
}

#[test]
fn what_is_no_filter_is_refused() {
    let fine = FilterSection { rates: [0.02, 0.3], weights_per_s2: [300.0, -50.0] };
    let of = |innovation_filter: Vec<FilterSection>| {
        let own = PositionObserver {
            correction: vec![0.271, 28.5, -1000.0],
            share: 0.6,
            delay_samples: 1,
            innovation_filter,
        };
        let record = JointRecord { a: vec![], observer: Some(own), ..fed() };
        gains("claim", &record).map_err(|why| why.inequality)
    };
    assert!(of(vec![]).is_ok() && of(vec![fine]).is_ok() && of(vec![fine; 2]).is_ok());
    let many = of(vec![fine; 3]).unwrap_err();
    assert_eq!(many, "sections of the innovation filter ≤ 2");
    // On the circle at 1, inside it, a pair on it, outside, and at −1 and beyond.
    let edges = [
        ([0.0, 0.5], "0 < c_0"),
        ([1e-9, 0.5], ""),
        ([-1e-9, 0.5], "0 < c_0"),
        ([0.3, 0.3], "c_0 < c_1"),
        ([0.3, 0.3 + 1e-9], ""),
        ([0.3, 0.3 - 1e-9], "c_0 < c_1"),
        ([1.0, 2.5], "2 c_1 < 4 + c_0"),
        ([1.0, 2.5 - 1e-9], ""),
        ([1.0, 2.5 + 1e-9], "2 c_1 < 4 + c_0"),
        ([4.0, 4.0 - 1e-9], "c_0 < c_1"),
    ];
    for (rates, why) in edges {
        let told = of(vec![fine, FilterSection { rates, ..fine }]).err().unwrap_or_default();
        let wanted = if why.is_empty() {
            String::new()
        } else {
            format!("a filter's section settles: {why}")
        };
        assert_eq!(told, wanted, "{rates:?}");
    }
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for at in 0..4 {
            let mut own = fine;
            let numbers = own.rates.iter_mut().chain(&mut own.weights_per_s2);
            numbers.skip(at).take(1).for_each(|value| *value = bad);
            let told = of(vec![own]).unwrap_err();
            assert_eq!(told, "|number of a filter's section| < ∞", "{bad} {at}");
        }
    }
}

#[test]
fn numbers_that_make_no_sense_are_refused() {
    assert!(at_most("", "", 1.0, 1.0).is_ok() && at_most("", "", 1.0, 0.9).is_err());
    assert!(at_most("", "", f64::NAN, 1.0).is_err() && at_most("", "", 1.0, f64::NAN).is_err());
    assert!(enough("", "", 1.0, 1.0 - 9e-9).is_ok() && enough("", "", 1.0, 1.0 - 2e-8).is_err());
    let agree = |a: f64, b: f64| agrees("", "", (a, b), 1e-3).is_ok();
    assert!(agree(1000.0, 1001.0) && agree(1001.0, 1000.0) && !agree(1000.0, 1001.1));
    assert!(!agree(1.0, -1.0) && agree(0.0, 0.0) && agree(-2.0, -2.0) && !agree(0.0, 1e-9));
    assert!(!agree(f64::NAN, 1.0) && !agree(f64::INFINITY, f64::INFINITY));

    let mu = |list: &[f64]| ratios("", list).is_ok();
    assert!(mu(&[1.0]) && mu(&vec![1.0; 1000]) && !mu(&[]) && !mu(&vec![1.0; 1001]));
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(!mu(&[1.0, bad]), "{bad}");
    }
    let runs = |change: &dyn Fn(&mut LoopModel)| {
        let mut own = plain();
        change(&mut own);
        model("", &fed(), &own).is_ok()
    };
    assert_eq!(phihat::DELAY_MAX, 8);
    let most = 8;
    assert!(
        runs(&|_| ())
            && runs(&|m| m.delay_samples = most)
            && !runs(&|m| m.delay_samples = most + 1)
    );
    assert!(
        runs(&|m| m.sample_delay_samples = most) && !runs(&|m| m.sample_delay_samples = most + 1)
    );
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(!runs(&|m| m.period_s = bad) && !runs(&|m| m.velocity_filter_hz = Some(bad)));
        assert!(!runs(&|m| m.drive_bandwidth_hz = Some(bad)));
    }
    let of = |change: &dyn Fn(&mut JointRecord)| {
        let mut own = fed();
        change(&mut own);
        gains("", &own).is_ok()
    };
    assert!(of(&|_| ()) && of(&|r| r.a = vec![1.0]) && !of(&|r| r.a = vec![]));
    assert!(!of(&|r| r.a = vec![1.0; 5]));
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(!of(&|r| r.inertia_kg_m2 = bad) && !of(&|r| r.kp_per_s2 = bad));
        assert!(!of(&|r| r.kd_per_s = bad) && !of(&|r| r.a[2] = bad));
    }
}
