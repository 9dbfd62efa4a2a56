//! Time per call of every algorithm on every built-in arm: one JSON line each on stdout.
//!
//! Median over blocks of about 0.4 ms, calls cycling over 64 random states that stay in cache.
//! `--quick` runs a few blocks only, to see that it runs.
#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "figures go to whoever runs the bench; it may stop at what should not happen"
)]

use std::hint::black_box;
use std::time::{Duration, Instant};

use phihat_model::{Body, Lanes, Lockstep, Model, Robot, Workspace};

const STATES: usize = 64;
const BLOCK: Duration = Duration::from_micros(400);

struct State {
    q: Vec<f64>,
    dq: Vec<f64>,
    ddq: Vec<f64>,
}

fn main() {
    let asked = |word: &str| std::env::args().any(|argument| argument == word);
    // `cargo bench` says `--bench`; run as a test it is brief.
    let quick = asked("--quick") || !asked("--bench");
    let blocks = if quick { 3 } else { 301 };
    for name in Robot::names() {
        let robot = Robot::named(name).unwrap();
        measure(&robot, blocks);
        measure_lanes(&robot, blocks);
    }
}

/// Forward dynamics of as many arms as there are lanes, each with a load of its own: time per arm.
fn measure_lanes(robot: &Robot, blocks: usize) {
    let Robot { name, model, tip, .. } = robot;
    let n = model.joint_count();
    let load = |k: usize| Body { mass: 0.1 * k as f64, com: [0.0, 0.0, 0.05], inertia: [0.0; 6] };
    let loaded = |k: usize| model.clone().with_payload_on(tip, &load(k)).unwrap();
    let models: Vec<Model> = (0..Lanes::COUNT).map(loaded).collect();
    let arms = Lockstep::new(&models.iter().collect::<Vec<_>>()).unwrap();
    let states = states(n);
    let lanes = |at: usize, what: usize| -> Vec<Lanes> {
        let lane = |k: usize, i: usize| {
            let State { q, dq, ddq } = &states[(at + 7 * k) % STATES];
            [q, dq, ddq][what][i]
        };
        (0..n).map(|i| Lanes::from(std::array::from_fn(|k| lane(k, i)))).collect()
    };
    let sides: Vec<[Vec<Lanes>; 3]> =
        (0..STATES).map(|at| [0, 1, 2].map(|what| lanes(at, what))).collect();
    let mut out = vec![Lanes::default(); n];
    let ns = median_ns(blocks, |at| {
        let [q, dq, tau] = &sides[at % STATES];
        arms.forward_dynamics(q, dq, tau, black_box(&mut out));
    });
    let ns = ns / Lanes::COUNT as f64;
    println!("{{\"robot\":\"{name}\",\"algorithm\":\"aba in lanes, per arm\",\"ns\":{ns:.1}}}");
}

fn measure(robot: &Robot, blocks: usize) {
    let Robot { name, model, .. } = robot;
    let n = model.joint_count();
    let states = states(n);
    let mut ws = Workspace::new(model);
    let mut out = vec![0.0; 10 * n * n];
    let tip = model.frame(&robot.tip).unwrap();
    let mut time = |algorithm: &str, call: &mut dyn FnMut(&State, &mut Workspace, &mut [f64])| {
        let ns = median_ns(blocks, |at| call(&states[at % STATES], &mut ws, black_box(&mut out)));
        println!("{{\"robot\":\"{name}\",\"algorithm\":\"{algorithm}\",\"ns\":{ns:.1}}}");
    };
    time("rnea", &mut |x, ws, out| {
        model.inverse_dynamics(ws, &x.q, &x.dq, &x.ddq, &mut out[..n]);
    });
    time("aba", &mut |x, ws, out| {
        model.forward_dynamics(ws, &x.q, &x.dq, &x.ddq, &mut out[..n]);
    });
    time("crba", &mut |x, ws, out| model.mass_matrix(ws, &x.q, &mut out[..n * n]));
    time("fk", &mut |x, ws, _| model.forward_kinematics(ws, &x.q));
    time("regressor", &mut |x, ws, out| model.regressor(ws, &x.q, &x.dq, &x.ddq, out));
    time("jacobian", &mut |x, ws, out| model.jacobian(ws, &x.q, tip, &mut out[..6 * n]));
    time("bias", &mut |x, ws, out| model.bias(ws, &x.q, &x.dq, &mut out[..n]));
    time("gravity", &mut |x, ws, out| model.gravity_torque(ws, &x.q, &mut out[..n]));
}

/// Median time of one call \[ns\].
fn median_ns(blocks: usize, mut call: impl FnMut(usize)) -> f64 {
    let mut calls = 64;
    while timed(calls, &mut call) < BLOCK {
        calls *= 2;
    }
    let per_call = |elapsed: Duration| elapsed.as_secs_f64() * 1e9 / calls as f64;
    let mut times: Vec<f64> = (0..blocks).map(|_| per_call(timed(calls, &mut call))).collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

#[allow(clippy::disallowed_methods, reason = "a bench reads the clock")]
fn timed(calls: usize, call: &mut impl FnMut(usize)) -> Duration {
    let start = Instant::now();
    (0..calls).for_each(|at| call(black_box(at)));
    start.elapsed()
}

/// Positions in ±3 rad, velocities and the rest in ±1, by a linear congruential generator.
fn states(n: usize) -> Vec<State> {
    let mut seed = 20_261_121_u64;
    let mut uniform = |size: f64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        size * (2.0 * (seed >> 11) as f64 / (1_u64 << 53) as f64 - 1.0)
    };
    let mut vector = |size: f64| (0..n).map(|_| uniform(size)).collect();
    (0..STATES).map(|_| State { q: vector(3.0), dq: vector(1.0), ddq: vector(1.0) }).collect()
}
