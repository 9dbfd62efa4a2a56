//! The observer form and the literal form are one law: unsaturated, from the same φ̂(0), their torques
//! differ by O(T). Wrong if a coefficient of Lemma 1 or of (T4) were wrong, for any order.

use crate::support::{Loop, gains};
use phihat::{Form, Reference};

const ORDERS: [&[f64]; 4] =
    [&[68.9], &[4844.0, 139.2], &[64_000.0, 4800.0, 120.0], &[810_000.0, 108_000.0, 5400.0, 120.0]];

/// Largest |φ̂_literal − φ̂_observer| over a second. From the reference itself both start with φ̂ = 0;
/// from beside it, φ̂(0) of the observer is preset to the literal form's own.
fn largest_difference(a: &[f64], period: f64, beside: bool) -> f64 {
    let mut literal = Loop::new(gains(a, period, Form::Literal), 1.3, period);
    let mut observer = Loop::new(gains(a, period, Form::Observer), 1.3, period);
    let start = reference(0.0);
    for joint in [&mut literal, &mut observer] {
        joint.q = start.q + if beside { 0.01 } else { 0.0 };
        joint.dq = start.dq + if beside { 0.05 } else { 0.0 };
    }
    if beside {
        let measurement = literal.measurement();
        let mut probe = literal.state;
        let first = literal.gains.update(&mut probe, &measurement, &start);
        assert!(first.phi_hat.abs() > 0.1, "the start must excite the estimator");
        for joint in [&mut literal, &mut observer] {
            assert!(joint.gains.resume(&mut joint.state, &measurement, &start, first.tau));
            joint.apply(first.tau, disturbance(0.5 * period));
        }
    }
    let mut largest = 0.0_f64;
    for _ in 0..samples_of(1.0, period) {
        let t = literal.time();
        let one = literal.step(&reference(t), disturbance(t + 0.5 * period));
        let other = observer.step(&reference(t), disturbance(t + 0.5 * period));
        largest = largest.max((one.phi_hat - other.phi_hat).abs());
    }
    largest
}

fn samples_of(duration: f64, period: f64) -> u32 {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
    let samples = (duration / period).round() as u32;
    samples
}

fn reference(t: f64) -> Reference<f64> {
    let w = 3.0;
    Reference {
        q: 0.2 * (w * t).sin(),
        dq: 0.2 * w * (w * t).cos(),
        ddq: -0.2 * w * w * (w * t).sin(),
    }
}

fn disturbance(t: f64) -> f64 {
    3.0 + 2.0 * t + (4.0 * t).sin()
}

fn assert_first_order(a: &[f64], beside: bool) {
    let [coarse, fine, finest] = [1e-4, 5e-5, 2.5e-5].map(|t| largest_difference(a, t, beside));
    let (first, second) = (coarse / fine, fine / finest);
    println!(
        "m = {}: {coarse:.3e} {fine:.3e} {finest:.3e}  ratios {first:.3} {second:.3}",
        a.len()
    );
    assert!((first - 2.0).abs() < 0.1, "m = {}: ratio {first}", a.len());
    assert!((second - 2.0).abs() < 0.06, "m = {}: ratio {second}", a.len());
}

#[test]
fn difference_shrinks_with_the_period_at_first_order() {
    for a in ORDERS {
        assert_first_order(a, false);
    }
}

#[test]
fn so_it_does_from_beside_the_reference() {
    // For m = 1, φ̂(0) is all there is to agree on; higher orders have further initial values.
    assert_first_order(ORDERS[0], true);
}
