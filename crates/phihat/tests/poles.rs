//! The sampled estimator has exactly the poles `e^{s_i T}` of its continuous design. Wrong if φ̂ did not
//! obey the linear recurrence that these poles, taken from closed forms, define.

use crate::support::{Loop, gains};
use phihat::{Form, Reference};

type Complex = (f64, f64);

fn exp(z: Complex) -> Complex {
    (z.0.exp() * z.1.cos(), z.0.exp() * z.1.sin())
}

/// Coefficients of `Π (x − root)`, lowest first, real parts; the roots come in conjugate pairs.
fn polynomial(roots: &[Complex]) -> Vec<f64> {
    let mut p: Vec<Complex> = vec![(1.0, 0.0)];
    for r in roots {
        let mut next = vec![(0.0, 0.0); p.len() + 1];
        for (i, c) in p.iter().enumerate() {
            next[i + 1].0 += c.0;
            next[i + 1].1 += c.1;
            next[i].0 -= c.0 * r.0 - c.1 * r.1;
            next[i].1 -= c.0 * r.1 + c.1 * r.0;
        }
        p = next;
    }
    assert!(p.iter().all(|c| c.1.abs() < 1e-9 * (1.0 + c.0.abs())), "roots must be conjugate");
    p.iter().map(|c| c.0).collect()
}

/// Largest residual of the recurrence `Σ c_j (φ̂_{k+j} − φ) = 0`, relative to the largest term.
fn residual(roots: &[Complex], period: f64) -> f64 {
    let m = roots.len();
    let a = polynomial(roots)[..m].to_vec();
    let images: Vec<Complex> = roots.iter().map(|r| exp((r.0 * period, r.1 * period))).collect();
    let c = polynomial(&images);
    let mut joint = Loop::new(gains(&a, period, Form::Observer), 1.0, period);
    let load = 2.0;
    let phi_hat: Vec<f64> =
        (0..60).map(|_| joint.step(&Reference::default(), load).phi_hat - load).collect();
    let largest = phi_hat.iter().fold(0.0_f64, |w, v| w.max(v.abs()));
    let recurrence =
        phi_hat.windows(m + 1).map(|w| w.iter().zip(&c).map(|(x, c)| x * c).sum::<f64>().abs());
    recurrence.fold(0.0, f64::max) / largest
}

#[test]
fn sampled_poles_are_the_exact_images() {
    let designs: [&[Complex]; 7] = [
        &[(-70.0, 0.0)],
        &[(-70.0, 0.0), (-70.0, 0.0)],
        &[(-69.6, 49.0), (-69.6, -49.0)],
        &[(-40.0, 0.0), (-60.0, 30.0), (-60.0, -30.0)],
        &[(-30.0, 0.0), (-30.0, 0.0), (-30.0, 0.0), (-30.0, 0.0)],
        &[(-50.0, 20.0), (-50.0, -20.0), (-80.0, 10.0), (-80.0, -10.0)],
        &[(-20.0, 0.0), (-20.0, 0.0), (-20.0, 0.0)],
    ];
    for roots in designs {
        // From a_{m−1}T = 0.01 to beyond 1, where plain forward differences are long unstable.
        for period in [1e-4, 1e-3, 5e-3, 1e-2, 2e-2] {
            let r = residual(roots, period);
            println!("m = {} T = {period}: residual {r:.1e}", roots.len());
            assert!(r < 1e-10, "m = {}, T = {period}: residual {r:e}", roots.len());
        }
    }
}

#[test]
fn a_wrong_pole_is_noticed() {
    // The oracle must be able to fail: claim poles 1 % away.
    let period = 1e-3;
    let mut joint = Loop::new(gains(&[70.0], period, Form::Observer), 1.0, period);
    let x: Vec<f64> =
        (0..5).map(|_| joint.step(&Reference::default(), 2.0).phi_hat - 2.0).collect();
    let wrong = (-70.7 * period).exp();
    assert!((x[1] - wrong * x[0]).abs() > 1e-4);
}
