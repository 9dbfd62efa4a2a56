//! A billion samples, and every pattern of bits: what is too long for a test. `cargo xtask soak [SAMPLES]`; run as a
//! test it is brief.
#![allow(clippy::print_stdout, reason = "a benchmark prints its figures")]
#![allow(clippy::unwrap_used, reason = "a benchmark stops on a bad set-up")]

use phihat::{Form, JointDesign, JointGains, JointState, Limits, Measurement, Real, Reference};

fn law<R: Real>(form: Form, a: &[f64]) -> JointGains<R> {
    let design = JointDesign { inertia: 1.0, kp: 1.0, kd: 1.0, a, period: 1e-3, form };
    JointGains::new(&design).unwrap()
}

/// Relative error of `∫e` of the literal form, whose errors are binary fractions with an exact sum.
fn drift(samples: u64) -> f64 {
    let law = law::<f64>(Form::Literal, &[1.0]);
    let mut state = JointState::new();
    let (even, odd) = (3.0 * 2.0_f64.powi(-20), -(2.0_f64.powi(-21)));
    let mut last = 0.0;
    for k in 0..samples {
        let q = if k.is_multiple_of(2) { even } else { odd };
        let m = Measurement { q, dq: 0.0, tau_applied: 0.0 };
        last = law.update(&mut state, &m, &Reference::default()).phi_hat;
    }
    let e = if samples.is_multiple_of(2) { odd } else { even };
    let exact = 1e-3 * ((samples / 2) as f64 * odd + ((samples - 1) / 2) as f64 * even);
    ((-(last + e) - exact) / exact).abs()
}

/// Every `stride`-th pattern of 32 bits as each measurement: how many answers were not finite or over a limit.
fn patterns(stride: u32) -> u64 {
    let limits = Limits::new(Some(30.0), Some(1000.0), 1e-3).unwrap();
    let law = law::<f32>(Form::Observer, &[70.0]).with_limits(limits);
    let mut state = JointState::new();
    let good = Measurement { q: 0.01_f32, dq: 0.1, tau_applied: 1.0 };
    law.update(&mut state, &good, &Reference::default());
    let mut wrong = 0;
    for k in 0..=(u32::MAX / stride) {
        let x = f32::from_bits(k * stride);
        for m in [
            Measurement { q: x, ..good },
            Measurement { dq: x, ..good },
            Measurement { tau_applied: x, ..good },
        ] {
            let mut next = state;
            let tau = law.update(&mut next, &m, &Reference::default()).tau;
            wrong += u64::from(!(tau.is_finite() && tau.abs() <= 30.0));
        }
    }
    wrong
}

fn main() {
    let asked: Option<u64> = std::env::args().skip(1).find_map(|word| word.parse().ok());
    let samples = asked.unwrap_or(1_000_000);
    let error = drift(samples);
    println!("{samples} samples: relative error of the integral {error:.1e}, at most 1e-9");
    let wrong = patterns(if asked.is_some() { 1 } else { 65_537 });
    println!("bit patterns of three measurements: {wrong} answers not finite or over the limit");
    assert!(error <= 1e-9 && wrong == 0);
}
