//! Cost of one update of a 7-joint arm: `cargo bench -p phihat --bench update` prints one JSON line per
//! order and scalar. Time is read here only.
#![allow(clippy::print_stdout, reason = "a benchmark prints its figures")]
#![allow(clippy::disallowed_methods, reason = "a benchmark reads the clock")]
#![allow(clippy::unwrap_used, reason = "a benchmark stops on a bad set-up")]

use std::hint::black_box;
use std::time::Instant;

use phihat::{
    Controller, Form, JointDesign, JointGains, JointState, Limits, Measurement, Real, Reference,
};

const ORDERS: [&[f64]; 4] =
    [&[70.0], &[4900.0, 140.0], &[64_000.0, 4800.0, 120.0], &[810_000.0, 108_000.0, 5400.0, 120.0]];

fn nanoseconds<R: Real>(a: &[f64], blocks: usize) -> f64 {
    let period = 1e-3;
    let design = JointDesign { inertia: 0.8, kp: 400.0, kd: 40.0, a, period, form: Form::Observer };
    let limits = Limits::new(Some(87.0), Some(1000.0), period).unwrap();
    let controller =
        Controller::<R, 7>::new([JointGains::new(&design).unwrap().with_limits(limits); 7]);
    let mut states = [JointState::new(); 7];
    let samples: Vec<_> = (0..64)
        .map(|k| {
            let x =
                |i: usize, s: f64| R::from_f64(0.01 * (f64::from(k) * 0.1 + i as f64 + s).sin());
            let m = core::array::from_fn(|i| Measurement {
                q: x(i, 0.0),
                dq: x(i, 1.0),
                tau_applied: x(i, 2.0),
            });
            let r =
                core::array::from_fn(|i| Reference { q: x(i, 3.0), dq: x(i, 4.0), ddq: x(i, 5.0) });
            (m, r)
        })
        .collect();
    let repeats = 100;
    let mut times: Vec<f64> = (0..blocks)
        .map(|_| {
            let start = Instant::now();
            for _ in 0..repeats {
                for (m, r) in &samples {
                    black_box(controller.update(&mut states, black_box(m), black_box(r)));
                }
            }
            start.elapsed().as_secs_f64() * 1e9 / f64::from(repeats) / samples.len() as f64
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn main() {
    let asked = |word: &str| std::env::args().any(|a| a == word);
    // `cargo bench` says `--bench`; run as a test it is brief.
    let blocks = if asked("--quick") || !asked("--bench") { 5 } else { 301 };
    for a in ORDERS {
        let (double, single) = (nanoseconds::<f64>(a, blocks), nanoseconds::<f32>(a, blocks));
        let m = a.len();
        println!(
            r#"{{"algorithm":"update_7_joints","order":{m},"scalar":"f64","ns":{double:.1}}}"#
        );
        println!(
            r#"{{"algorithm":"update_7_joints","order":{m},"scalar":"f32","ns":{single:.1}}}"#
        );
    }
}
