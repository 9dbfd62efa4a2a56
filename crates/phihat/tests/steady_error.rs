//! The loop is a type-m servo: constant, ramp and parabolic φ leave no steady error at m = 1, 2, 3.
//! Wrong if the sampled loop had fewer than m integrators; the order below must show an error.

use crate::support::{Loop, gains};
use phihat::{Form, Reference};

const ORDERS: [&[f64]; 4] =
    [&[70.0], &[4900.0, 140.0], &[64_000.0, 4800.0, 120.0], &[810_000.0, 108_000.0, 5400.0, 120.0]];

/// |e| after 4 s under a load that grows like `t^degree`, held over each sample.
fn error_after(a: &[f64], form: Form, degree: i32) -> f64 {
    let period = 1e-3;
    let mut joint = Loop::new(gains(a, period, form), 1.4, period);
    while joint.k < 4000 {
        let load = 5.0 * joint.time().powi(degree);
        joint.step(&Reference::default(), load);
    }
    joint.q.abs()
}

#[test]
fn polynomial_loads_up_to_the_order_leave_no_error() {
    for (order, a) in (1..).zip(ORDERS) {
        for form in [Form::Observer, Form::Literal] {
            for degree in 0..order {
                let e = error_after(a, form, degree);
                println!("{form:?} m = {order} degree {degree}: {e:.1e}");
                assert!(e < 1e-11, "{form:?} m = {order}, degree {degree}: e = {e:e}");
            }
            let beyond = error_after(a, form, order);
            println!("{form:?} m = {order} degree {order}: {beyond:.1e} (one too many)");
            assert!(
                beyond > 1e-8,
                "{form:?} m = {order} must not follow degree {order}: {beyond:e}"
            );
        }
    }
}

#[test]
fn estimate_finds_a_constant_load() {
    for a in ORDERS {
        let period = 1e-3;
        let mut joint = Loop::new(gains(a, period, Form::Observer), 1.0, period);
        let mut last = 0.0;
        for _ in 0..3000 {
            last = joint.step(&Reference::default(), 12.5).phi_hat;
        }
        assert!((last - 12.5).abs() < 1e-9, "m = {}: {last}", a.len());
    }
}
