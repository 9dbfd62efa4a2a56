//! The joint that `docs/theory/example.md` works by hand: window (BH2), ramp (BH3), jump (BH4). Wrong if the
//! running law were not the one of (T1), (T4), (T5), or if a number of that page were wrong.

use crate::support::{KD, KP, Loop, gains};
use phihat::{Form, Reference};

const A_0: f64 = 68.9;
const T: f64 = 1e-3;

fn joint(inertia: f64, period: f64) -> Loop {
    Loop::new(gains(&[A_0], period, Form::Observer), inertia, period)
}

/// `α_0 T` of (T5).
fn alpha_t() -> f64 {
    1.0 - (-A_0 * T).exp()
}

/// Edges of the window, by (BH1) and (BH2).
fn window() -> (f64, f64) {
    let alpha = alpha_t();
    let a = KD * T + 0.5 * KP * T * T + alpha;
    let b = KD * T * alpha + KP * T * T * (1.0 + 0.5 * alpha);
    let c = KP * T * T * alpha;
    let high = (4.0 * a - 4.0 * b + 3.0 * c) * (2.0 * b - 3.0 * c) / c + 4.0 * a - 2.0 * b + c;
    (a / 2.0 - b / 4.0 + c / 8.0, high / 8.0)
}

/// Returns true if an offset of 1 µrad dies out.
fn settles(inertia: f64) -> bool {
    let mut joint = joint(inertia, T);
    joint.q = 1e-6;
    let mut peaks = [0.0_f64; 2];
    for k in 0..40_000 {
        joint.step(&Reference::default(), 0.0);
        let peak = &mut peaks[usize::from(k >= 20_000)];
        *peak = peak.max(joint.q.abs());
        if *peak > 1.0 {
            return false;
        }
    }
    peaks[1] < 0.5 * peaks[0]
}

#[test]
fn window_of_the_page() {
    let (low, high) = window();
    assert!((low - 0.05262).abs() < 5e-6 && (high - 11.88).abs() < 5e-3, "{low}, {high}");
    for (inertia, stable) in
        [(low * 0.98, false), (low * 1.02, true), (high * 0.98, true), (high * 1.02, false)]
    {
        assert_eq!(settles(inertia), stable, "inertia {inertia}");
    }
}

#[test]
fn ramp_of_the_page() {
    let mut joint = joint(1.0, T);
    for k in 0..4000 {
        joint.step(&Reference::default(), 10.0 * T * f64::from(k));
    }
    let by_hand = 10.0 * T / (alpha_t() * KP);
    assert!((by_hand - 3.755e-4).abs() < 5e-8, "{by_hand}");
    assert!((joint.q.abs() - by_hand).abs() < 1e-9, "{} against {by_hand}", joint.q);
}

#[test]
fn jump_of_the_page() {
    // Sampled finely, since the page's number is that of continuous time.
    let fine = 1e-5;
    let peak = |flip: f64| {
        let mut joint = joint(1.0, fine);
        let mut peak = 0.0_f64;
        for k in 0..60_000 {
            let push = if f64::from(k) * fine < flip { -1.0 } else { 1.0 };
            joint.step(&Reference::default(), push);
            peak = peak.max(joint.q.abs());
        }
        peak
    };
    let (step, worst) = (peak(0.0), peak(0.3));
    assert!((step - 2.534e-4).abs() < 2e-7, "{step}");
    // A push that turns when the first has all but died out adds twice the step, less what is left.
    assert!(worst < 5.069e-4 && worst > 4.9e-4, "{worst}");
}
