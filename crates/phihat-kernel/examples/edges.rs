//! Edges of the kernel's claims on random laws, as JSON lines for another implementation to check.
//!
//! `cargo run --release -p phihat-kernel --example edges -- 1000 > edges.jsonl`: each line has a law, its setting, and
//! for each claim the last value that was proved and the first that was not, a relative 1e-7 apart.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "an example: its output is data")]

#[path = "../tests/random.rs"]
#[allow(dead_code, reason = "the tests use all of it")]
mod random;

use phihat_kernel::{
    DriveModel, JointLoop, Law, MovingInertia, Range, Reported, Setting, any_speed, delay, frozen,
    modulus, moving, phase,
};
use random::{Dice, law, setting};
use serde_json::{Value, json};

/// Relative distance of the two sides of an edge.
const APART: f64 = 1e-7;

fn main() {
    let count = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(1000);
    let (mut dice, mut written) = (Dice(44), 0);
    while written < count {
        let states = dice.below(4);
        let (law, mut setting) = (law(&mut dice, states), setting(&mut dice));
        if dice.roll() > 0.0 {
            setting.drive = None;
        }
        if let Some(edges) = edges(&law, &setting, &mut dice) {
            let line =
                json!({ "law": shown(&law), "setting": shown_setting(&setting), "claims": edges });
            println!("{line}");
            written += 1;
        }
    }
}

/// All claims of a law that is stable at `μ = 1`.
fn edges(law: &Law, setting: &Setting, dice: &mut Dice) -> Option<Vec<Value>> {
    let joint = JointLoop::new(law, setting).unwrap();
    let one = core::slice::from_ref(&joint);
    let range = |low: f64, high: f64| Range::new(low, high).unwrap();
    let frozen = |low: f64, high: f64| frozen(one, &range(low, high)).is_ok();
    if !frozen(1.0, 1.0) {
        return None;
    }
    let mut all = Vec::new();
    let low = edge((1.0, 1.0 / 64.0), |low| frozen(low, 1.0));
    let high = edge((1.0, 64.0), |high| frozen(1.0, high));
    all.push(json!({ "claim": "window_low", "edge": low }));
    all.push(json!({ "claim": "window_high", "edge": high }));
    let share = dice.between(0.1, 0.9);
    let (a, b) = (low[0].powf(share), high[0].powf(share));
    let inner = range(a, b);
    let mut claim = |name: &str, most: f64, holds: &dyn Fn(f64) -> bool| {
        if holds(0.0) {
            all.push(json!({ "claim": name, "range": [a, b], "edge": edge((0.0, most), holds) }));
        }
    };
    claim("modulus", 1.0, &|value| modulus(&joint, &inner, value).is_ok());
    claim("phase", core::f64::consts::PI, &|angle| phase(&joint, &inner, angle).is_ok());
    claim("delay", 0.99, &|samples| delay(&joint, &inner, samples).is_ok());
    if setting.drive.is_some() {
        return Some(all);
    }
    let fast = |r: f64| any_speed(one, &range(1.0 / r, r)).is_ok();
    if !fast(1.0) {
        return Some(all);
    }
    let most = (1.0 / low[0]).min(high[0]);
    let r = edge((1.0, 64.0), fast);
    all.push(json!({ "claim": "any_speed", "edge": r }));
    let r = r[0].powf(0.3) * most.max(r[0]).powf(0.3);
    let taps = [dice.between(-0.3, 0.3), dice.between(-0.3, 0.3)];
    let drift = dice.between(0.3, 3.0) * 3.0;
    let moves = |rate: f64| {
        let motion = MovingInertia {
            range: range(1.0 / r, r),
            rate,
            period: setting.period,
            drift,
            taps: &taps,
        };
        moving(one, &motion).is_ok()
    };
    if moves(0.0) {
        all.push(json!({ "claim": "moving", "range": [1.0 / r, r], "taps": taps, "drift": drift,
            "edge": edge((0.0, 100.0), moves) }));
    }
    Some(all)
}

/// The last value from `from` towards `to` that holds, and the first that does not; `to` twice where all hold.
fn edge((from, to): (f64, f64), holds: impl Fn(f64) -> bool) -> [f64; 2] {
    if holds(to) {
        return [to, to];
    }
    let (mut good, mut bad) = (from, to);
    for _ in 0..200 {
        if (good - bad).abs() <= APART * good.abs().max(bad.abs()) {
            break;
        }
        let middle = 0.5 * (good + bad);
        if holds(middle) { good = middle } else { bad = middle }
    }
    [good, bad]
}

fn shown(law: &Law) -> Value {
    let Law { state, input, output, direct } = law;
    json!({ "state": state, "input": input, "output": output, "direct": direct })
}

fn shown_setting(setting: &Setting) -> Value {
    let Setting { period, inertia, late, velocity, drive, reported } = setting;
    let velocity = [velocity.last, velocity.velocity, velocity.position, velocity.before];
    let drive = drive.map(|DriveModel { lost, mean, double }| [lost, mean, double]);
    let applied = *reported == Reported::Applied;
    json!({ "period": period, "inertia": inertia, "late": late, "velocity": velocity, "drive": drive,
        "applied": applied })
}
