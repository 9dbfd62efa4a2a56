//! On the coupled arm: Lyapunov functions of laws that know the model, and identities between laws.

use crate::support::{Bench, PERIOD, Run};
use phihat_model::Workspace;
use phihat_rivals::{Tuning, rival};

/// The planar arm with its exact model and a start off the reference.
fn displaced() -> Bench {
    let mut bench = Bench::arm("planar3r").exact();
    for (start, offset) in bench.start.iter_mut().zip([-0.3, 0.3, -0.2]) {
        *start += offset;
    }
    bench.duration = 1.0;
    bench
}

/// `sᵀ M(q) s` at a sample, `s` per joint.
fn kinetic(bench: &Bench, ws: &mut Workspace<f64>, q: &[f64], s: &[f64]) -> f64 {
    let n = q.len();
    let mut m = vec![0.0; n * n];
    bench.plant.mass_matrix(ws, q, &mut m);
    (0..n).map(|i| (0..n).map(|j| s[i] * m[i * n + j] * s[j]).sum::<f64>()).sum()
}

/// `e, ė` of a joint at a sample.
fn error(bench: &Bench, run: &Run, step: usize, joint: usize) -> [f64; 2] {
    let wanted = bench.reference(joint, run.t[step]);
    [run.e[step][joint], run.dq[step][joint] - wanted[1]]
}

/// Asserts that values fall from sample to sample, but for what holding the torque adds.
fn falls(values: &[f64], id: &str) {
    for (k, pair) in values.windows(2).enumerate() {
        assert!(pair[1] < pair[0] + 2e-4 * values[0], "{id} at sample {k}: {pair:?}");
    }
    let end = values.last().unwrap();
    assert!(*end < 1e-2 * values[0], "{id}: {end} of {}", values[0]);
}

#[test]
fn park_chung_with_the_true_model_loses_the_functional_of_the_pid() {
    let bench = displaced();
    let entry = rival("park-chung").unwrap();
    let tuning = bench.published(entry);
    let [kp, ki, k, _] = tuning.values().unwrap();
    let run = bench.run(entry, &tuning);
    let mut ws = Workspace::new(&bench.plant);
    let mut sum = [0.0; 3];
    let values: Vec<_> = (0..run.t.len())
        .map(|step| {
            let (mut s, mut rest) = ([0.0; 3], 0.0);
            for i in 0..3 {
                let [e, de] = error(&bench, &run, step, i);
                sum[i] += PERIOD * e;
                s[i] = de + kp * e + ki * sum[i];
                let unit = k * bench.supply.inertia[i];
                rest += unit * (ki * kp * sum[i] * sum[i] + 2.0 * ki * sum[i] * e + kp * e * e);
            }
            kinetic(&bench, &mut ws, &run.q[step], &s) + rest
        })
        .collect();
    falls(&values, "park-chung");
}

#[test]
fn chen_lee_feng_with_the_true_model_loses_its_functional() {
    let bench = displaced();
    let entry = rival("chen-lee-feng").unwrap();
    let tuning = bench.published(entry);
    let [lambda, damping] = tuning.values().unwrap();
    let run = bench.run(entry, &tuning);
    let mut ws = Workspace::new(&bench.plant);
    let values: Vec<_> = (0..run.t.len())
        .map(|step| {
            let (mut s, mut rest) = ([0.0; 3], 0.0);
            for i in 0..3 {
                let [e, de] = error(&bench, &run, step, i);
                s[i] = de + lambda * e;
                rest += 2.0 * lambda * damping * bench.supply.inertia[i] * e * e;
            }
            kinetic(&bench, &mut ws, &run.q[step], &s) + rest
        })
        .collect();
    falls(&values, "chen-lee-feng");
}

/// With the true model nothing but the transient is left, from the start: `ė + λ e = s(0) (1 + 2x)(1 − x)²`.
#[test]
fn integral_suboptimal_with_the_true_model_is_on_its_transient_from_the_start() {
    let bench = displaced();
    let entry = rival("integral-suboptimal").unwrap();
    let tuning = bench.published(entry);
    let [lambda, _, transient] = tuning.values().unwrap();
    let run = bench.run(entry, &tuning);
    let s = |step: usize, joint: usize| {
        let [e, de] = error(&bench, &run, step, joint);
        de + lambda * e
    };
    for (step, t) in run.t.iter().enumerate() {
        let x = (t / transient).min(1.0);
        for joint in 0..3 {
            let exact = s(0, joint) * (1.0 + 2.0 * x) * (1.0 - x).powi(2);
            let found = s(step, joint);
            assert!((found - exact).abs() < 0.1, "joint {joint} at {t}: {found}, {exact}");
        }
    }
}

#[test]
fn nric_with_the_true_model_is_computed_torque() {
    let mut bench = displaced();
    bench.supply.torque_max = None;
    let entry = rival("nric").unwrap();
    let run = bench.run(entry, &bench.published(entry));
    for (step, t) in run.t.iter().enumerate() {
        for (i, offset) in [-0.3, 0.3, -0.2].into_iter().enumerate() {
            let exact = offset * (1.0 + 20.0 * t) * (-20.0 * t).exp();
            let off = run.e[step][i] - exact;
            assert!(off.abs() < 3e-3, "joint {i} at {t}: {off}");
        }
    }
}

/// With a model 20 % too light the arm follows the nominal one, not its own: the compensator's share.
#[test]
fn nric_makes_a_wrong_model_nearly_right() {
    let bench = Bench::arm("planar3r");
    let rms = |id: &str| {
        let entry = rival(id).unwrap();
        bench.run(entry, &bench.published(entry)).rms_worst(4.0)
    };
    assert!(rms("nric") < 0.05 * rms("computed-torque"), "{}", rms("nric"));
}

/// If the nominal torque is limited, the nominal arm moves no faster than that torque can move it.
#[test]
fn nric_limits_the_nominal_arm_by_the_drives() {
    let mut bench = displaced();
    let (entry, free) = (rival("nric").unwrap(), bench.clone());
    bench.supply.torque_max = Some(vec![60.0, 40.0, 5.0]);
    let most = |bench: &Bench| {
        let run = bench.run(entry, &bench.published(entry));
        run.tau.iter().map(|tau| tau[2].abs()).fold(0.0, f64::max)
    };
    let mut unlimited = free;
    unlimited.supply.torque_max = None;
    let (limited, unlimited) = (most(&bench), most(&unlimited));
    assert!(limited < 1.1 * 5.0 && unlimited > 1.2 * limited, "{limited} {unlimited}");
}

fn same(one: (&str, &[f64]), other: (&str, &[f64]), tolerance: f64) {
    let mut bench = Bench::arm("planar3r");
    bench.duration = 3.0;
    let run = |(id, values): (&str, &[f64])| {
        let tuning = Tuning::new(values, &bench.supply.inertia, PERIOD).unwrap();
        bench.run(rival(id).unwrap(), &tuning)
    };
    let (first, second) = (run(one), run(other));
    let errors = first.e.iter().flatten().zip(second.e.iter().flatten());
    let apart = errors.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart <= tolerance, "{} and {}: {apart}", one.0, other.0);
    assert!(first.error_peak(0.0) > 1e3 * apart.max(1e-12));
}

/// Identities between laws, on the coupled arm with dry friction.
#[test]
fn time_delay_control_is_the_first_order_law_with_an_estimator_of_one_sample() {
    same(("time-delay", &[20.0, 1.0, 1.0]), ("proposed-1", &[20.0, 1.0, 1e5]), 1e-9);
}

/// With a filter that lets everything through, and the first-order law as its estimator's pole goes: what is
/// filtered twice alike is one disturbance observer.
#[test]
fn incremental_inversion_without_its_filter_is_time_delay_control() {
    same(("indi", &[20.0, 1.0, 1e6, 1.0, 1.0]), ("time-delay", &[20.0, 1.0, 1.0]), 1e-9);
    // Damping 50: one pole at ω/(2 ζ), the other far beyond the sample.
    let first = [20.0, 1.0, 69.6];
    same(("indi", &[20.0, 1.0, 69.6 * 1e5, 0.5e5, 1.0]), ("proposed-1", &first), 2e-5);
}

#[test]
fn the_earlier_law_without_its_correction_is_the_first_order_law() {
    same(("hayat-buss-2016", &[20.0, 1.0, 69.6, 1e-12]), ("proposed-1", &[20.0, 1.0, 69.6]), 1e-9);
}

#[test]
fn a_rate_per_unit_is_one_rate_where_all_are_alike() {
    let units = [10.0, 80.0, 5.0, 5.0, 5.0, 5.0, 0.01];
    same(("slotine-li-units", &units), ("slotine-li", &[10.0, 80.0, 5.0, 0.01]), 1e-12);
}

#[test]
fn designed_gains_run_the_law_they_were_designed_for() {
    same(("proposed-designed", &[]), ("proposed-1", &[20.0, 1.0, 69.6]), 1e-12);
}

#[test]
fn adaptive_robust_dob_without_its_terms_is_the_first_order_law() {
    // (s + 20)² = s² + (λ + k) s + λ k.
    let bare = [20.0, 20.0, 1e-12, 50.0, 1e-12, 1.0, 0.1];
    same(("adaptive-robust-dob", &bare), ("proposed-1", &[20.0, 1.0, 50.0]), 1e-9);
}

/// The observer as its literature writes it, integrated on its own in small steps along a run's record.
#[test]
fn the_disturbance_observer_is_the_one_of_the_books() {
    let mut bench = Bench::arm("planar3r");
    bench.duration = 3.0;
    let entry = rival("disturbance-observer").unwrap();
    let run = bench.run(entry, &bench.published(entry));
    let g = 100.0;
    for i in 0..3 {
        let m = bench.supply.inertia[i];
        let (mut z, mut worst, mut largest) = (g * m * run.dq[0][i], 0.0_f64, 0.0_f64);
        for k in 1..run.t.len() {
            for part in 1..=20 {
                let x = f64::from(part) / 20.0;
                let v = run.dq[k - 1][i] + x * (run.dq[k][i] - run.dq[k - 1][i]);
                z += PERIOD / 20.0 * g * (run.tau[k - 1][i] - (z - g * m * v));
            }
            let phi = z - g * m * run.dq[k][i];
            let wanted = bench.reference(i, run.t[k]);
            let [e, de] = error(&bench, &run, k, i);
            let torque = m * (wanted[2] - 40.0 * de - 400.0 * e) + phi;
            worst = worst.max((torque - run.tau[k][i]).abs());
            largest = largest.max(torque.abs());
        }
        assert!(worst < 0.01 * largest, "joint {i}: {worst} of {largest}");
    }
}

/// Smallest eigenvalue of `U^{-1/2} M(q) U^{-1/2}`, by powers of its distance to the trace.
fn ratio_min(bench: &Bench, q: &[f64]) -> f64 {
    let (n, units) = (q.len(), &bench.supply.inertia);
    let mut m = vec![0.0; n * n];
    bench.plant.mass_matrix(&mut Workspace::new(&bench.plant), q, &mut m);
    for i in 0..n {
        for j in 0..n {
            m[i * n + j] /= (units[i] * units[j]).sqrt();
        }
    }
    let trace: f64 = (0..n).map(|i| m[i * n + i]).sum();
    let mut x: Vec<_> = (0..n).map(|i| 1.0 + 0.1 * i as f64).collect();
    let mut size = 0.0;
    for _ in 0..3000 {
        let row = |i: usize| -> f64 { (0..n).map(|j| m[i * n + j] * x[j]).sum() };
        let next: Vec<_> = (0..n).map(|i| trace * x[i] - row(i)).collect();
        size = next.iter().map(|x| x * x).sum::<f64>().sqrt();
        x = next.iter().map(|x| x / size).collect();
    }
    trace - size
}

/// On an arm of seven joints: what does not run there was told so by its condition.
#[test]
fn published_gains_on_seven_joints() {
    let mut bench = Bench::arm("panda");
    bench.duration = 5.0;
    let mut declared = bench.declared();
    declared.ratio = [ratio_min(&bench, &bench.center), 1.0];
    for id in SECOND_HALF {
        let entry = rival(id).unwrap();
        let tuning = bench.published(entry);
        let run = bench.run(entry, &tuning);
        if run.complete(&bench) {
            println!("{id:<24} rms {:.2e}", run.rms_worst(2.5));
            assert!(run.rms_worst(2.5) < 0.05, "{id}");
        } else {
            let condition = entry.condition(&tuning, &declared).unwrap();
            println!("{id:<24} lost at {} s: {condition:?}", run.t.len() as f64 * PERIOD);
            assert!(!condition.holds, "{id}: {condition:?}");
        }
    }
}

const SECOND_HALF: [&str; 27] = [
    "l1-adaptive",
    "indi",
    "proposed-positions-1",
    "proposed-positions-2",
    "proposed-positions-designed",
    "proposed-positions-filtered",
    "proposed-1",
    "proposed-2",
    "proposed-designed",
    "h-infinity-pid",
    "nric",
    "park-chung",
    "chen-lee-feng",
    "adaptive-robust-dob",
    "taylor-network",
    "fuzzy",
    "ultra-local",
    "industrial-pid",
    "disturbance-observer",
    "adrc",
    "super-twisting",
    "funnel-2013",
    "funnel-2021",
    "time-delay",
    "enhanced-time-delay",
    "prescribed-performance",
    "hayat-buss-2016",
];
