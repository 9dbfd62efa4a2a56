//! The paper's second and third step: the outer loop from a time, the estimator from the outer loop (section VII).

use crate::claims::polynomial;

/// `K_p = ω²`, `K_d = 2ζω` for a settling time to 2 % \[s\].
pub fn from_settling_time(time_s: f64, damping: f64) -> (f64, f64) {
    let far = 100.0 / damping.min(1.0 / damping);
    let steps = 200_000;
    let outside = |k: &u32| {
        let t = far * f64::from(*k) / f64::from(steps);
        (step_response(damping, t) - 1.0).abs() > 0.02
    };
    let last = (0..steps).rev().find(outside).unwrap_or(0);
    outer_loop(far * f64::from(last + 1) / f64::from(steps) / time_s, damping)
}

/// `K_p = ω²`, `K_d = 2ζω` for a rise time from 10 % to 90 % \[s\].
pub fn from_rise_time(time_s: f64, damping: f64) -> (f64, f64) {
    let reaches = |level: f64| {
        // Rising until the first peak; without one, for ever.
        let peak = core::f64::consts::PI / (1.0 - damping * damping).max(1e-4).sqrt();
        let (mut low, mut high) = (0.0, peak.max(20.0 * damping));
        if damping < 1.0 {
            high = peak;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if step_response(damping, middle) < level { low = middle } else { high = middle }
        }
        low
    };
    outer_loop((reaches(0.9) - reaches(0.1)) / time_s, damping)
}

/// `a_0 … a_{m−1}` of `(s + factor·√K_p)^m`; the paper asks for a factor of 3 to 5.
pub fn estimator(order: usize, kp: f64, factor: f64) -> Vec<f64> {
    estimator_at(order, factor * kp.sqrt())
}

/// `a_0 … a_{m−1}` of `(s + w)^m`.
pub fn estimator_at(order: usize, w: f64) -> Vec<f64> {
    let pole = [w, 1.0];
    let mut a = (0..order).fold(vec![1.0], |p, _| polynomial::product(&p, &pole));
    a.pop();
    a
}

/// Answer of `1/(s² + 2ζs + 1)` to a unit step.
fn step_response(damping: f64, t: f64) -> f64 {
    let gap = (1.0 - damping * damping).abs().sqrt();
    let fade = libm::exp(-damping * t);
    if gap < 1e-6 {
        return 1.0 - fade * (1.0 + t);
    }
    if damping < 1.0 {
        return 1.0 - fade * (libm::cos(gap * t) + damping / gap * libm::sin(gap * t));
    }
    let (slow, fast) = (damping - gap, damping + gap);
    1.0 - (fast * libm::exp(-slow * t) - slow * libm::exp(-fast * t)) / (fast - slow)
}

fn outer_loop(omega: f64, damping: f64) -> (f64, f64) {
    (omega * omega, 2.0 * damping * omega)
}
