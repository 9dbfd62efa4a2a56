//! The sampled loop is stable for a joint inertia inside a window and unstable outside, at the reference
//! values (literal form, backward-difference integrals, exact velocity, 1 kHz). Wrong if the running law
//! were not the one those values were computed for by eigenvalues.

use crate::support::{Loop, gains};
use phihat::{Delay, Form, Reference};

/// Returns true if the response to a push has died down, false if it has grown.
fn settles(a: &[f64], inertia: f64, delay: usize) -> bool {
    let mut joint = Loop::new(gains(a, 1e-3, Form::Literal), inertia, 1e-3);
    joint.delay = Delay::new(delay).unwrap();
    joint.q = 1e-6;
    let size = |joint: &Loop| joint.q.abs() + joint.dq.abs() * 1e-3;
    let mut early = 0.0_f64;
    let mut late = 0.0_f64;
    for k in 0..40_000 {
        joint.step(&Reference::default(), 0.0);
        if (8_000..14_000).contains(&k) {
            early = early.max(size(&joint));
        } else if k >= 34_000 {
            late = late.max(size(&joint));
        }
        if size(&joint) > 1e6 {
            return false;
        }
    }
    late < 0.5 * early || late < 1e-12
}

#[test]
fn edges_are_the_reference_values() {
    let cases: [(&[f64], usize, f64, f64); 6] = [
        (&[68.9], 0, 0.0545, 12.32),
        (&[68.9], 1, 0.1107, 11.95),
        (&[69.6 * 68.9, 68.9], 0, 0.0545, 3.40),
        (&[69.6 * 68.9, 68.9], 1, 0.1138, 3.20),
        (&[69.6 * 69.6, 139.2], 0, 0.0897, 6.65),
        (&[69.6 * 69.6, 139.2], 1, 0.1854, 6.34),
    ];
    for (a, delay, low, high) in cases {
        for (inertia, stable) in
            [(low * 0.98, false), (low * 1.02, true), (high * 0.98, true), (high * 1.02, false)]
        {
            let found = settles(a, inertia, delay);
            assert_eq!(found, stable, "a = {a:?}, delay {delay}, inertia {inertia}");
        }
    }
}
