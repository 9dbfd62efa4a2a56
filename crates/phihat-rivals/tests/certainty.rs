//! Rivals that know a model: what is proved for them when it is exact, and identities among them.

use crate::support::{Bench, PERIOD, Run};
use phihat_model::Workspace;
use phihat_rivals::{All, Tuning, rival};

/// The torque that a rival answers with to a first sample.
fn answer(bench: &Bench, id: &str, values: &[f64], still: bool) -> Vec<f64> {
    let tuning = Tuning::new(values, &bench.supply.inertia, PERIOD).unwrap();
    let mut built = rival(id).unwrap().build(&tuning, &bench.supply).unwrap();
    let zero = [0.0; 3];
    let (dq_d, ddq_d) = if still { (zero, zero) } else { ([0.3, -0.2, 0.5], [1.0, 2.0, -3.0]) };
    let all = All {
        q: &[0.5, 1.0, 0.4],
        dq: &[0.6, -0.4, 0.2],
        tau: &zero,
        commanded: &zero,
        clipped: &[false; 3],
        q_d: &[0.4, 1.2, 0.6],
        dq_d: &dq_d,
        ddq_d: &ddq_d,
        ddq_d_acting: &ddq_d,
    };
    let mut tau = zero.to_vec();
    built.update(&all, &mut tau);
    tau
}

fn near(a: &[f64], b: &[f64], most: f64) {
    assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < most), "{a:?} {b:?}");
}

#[test]
fn laws_without_their_own_term_are_the_law_they_start_from() {
    let bench = Bench::arm("planar3r").exact();
    let small = 1e-12;
    let computed = |omega, zeta| answer(&bench, "computed-torque", &[omega, zeta], false);
    let robust = answer(&bench, "robust", &[1e4, 200.0, small, 1.0], false);
    near(&robust, &computed(10.0, 1.0), 1e-9);
    let cnf = answer(&bench, "cnf", &[20.0, 0.4, small, 2.0, 30.0], false);
    near(&cnf, &computed(20.0, 0.4), 1e-9);
    // At rest there is no reference to feed forward but its friction.
    let plus = answer(&bench, "pd-plus", &[20.0, 1.0], true);
    near(&plus, &answer(&bench, "pd-gravity", &[20.0, 1.0], true), 1e-9);
}

/// `xᵀPx`-like functions along a run, from the true inertia.
fn mechanical(bench: &Bench, run: &Run, stiffness: f64, slide: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut ws = Workspace::new(&bench.plant);
    let mut m = [0.0; 9];
    let value = |(k, t): (usize, &f64)| {
        bench.plant.mass_matrix(&mut ws, &run.q[k], &mut m);
        let e = &run.e[k];
        let z: Vec<_> =
            (0..3).map(|i| run.dq[k][i] - bench.reference(i, *t)[1] + slide(e[i])).collect();
        let kinetic: f64 = (0..9).map(|c| m[c] * z[c / 3] * z[c % 3]).sum();
        let spring = |i: usize| stiffness * bench.supply.inertia[i] * e[i] * e[i];
        0.5 * (kinetic + (0..3).map(spring).sum::<f64>())
    };
    run.t.iter().enumerate().map(value).collect()
}

/// Decreasing but for what holding the torque over a sample moves, and gone at the end.
fn decreases(v: &[f64], what: &str) {
    let first = v[0];
    assert!(first > 1e-3, "{what} starts at {first}");
    let most = v.windows(2).map(|w| w[1] - w[0]).fold(f64::MIN, f64::max);
    assert!(most < 1e-4 * first, "{what} rises by {most} of {first}");
    assert!(*v.last().unwrap() < 1e-3 * first, "{what} ends at {} of {first}", v.last().unwrap());
}

fn displaced(duration: f64) -> Bench {
    let mut bench = Bench::arm("planar3r").exact();
    bench.start = vec![0.2, 1.5, 0.4];
    bench.duration = duration;
    bench
}

#[test]
fn pd_with_gravity_comes_to_rest_on_its_set_point() {
    let mut bench = displaced(3.0);
    bench.amplitude = 0.0;
    let entry = rival("pd-gravity").unwrap();
    let run = bench.run(entry, &bench.published(entry));
    decreases(&mechanical(&bench, &run, 400.0, |_| 0.0), "V");
    assert!(run.error_peak(2.9) < 1e-6);
}

#[test]
fn pd_plus_loses_energy_while_the_arm_moves() {
    let bench = displaced(4.0);
    let entry = rival("pd-plus").unwrap();
    let run = bench.run(entry, &bench.published(entry));
    decreases(&mechanical(&bench, &run, 400.0, |_| 0.0), "V");
    assert!(run.error_peak(3.9) < 1e-3);
}

#[test]
fn finite_time_backstepping_decreases_its_function_and_stays_below_its_level() {
    let bench = displaced(3.0);
    let entry = rival("finite-time").unwrap();
    let tuning = bench.published(entry);
    let slide = |e: f64| 10.0 * e * (e.abs() + 0.01_f64).powf(-0.3);
    let run = bench.run(entry, &tuning);
    decreases(&mechanical(&bench, &run, 1.0, slide), "V");
    // (3) with dry friction as the disturbance: the L2 gain from d to z.
    let mut rubbed = bench.clone();
    rubbed.friction.1.fill(1.0);
    rubbed.start = rubbed.center.clone();
    let run = rubbed.run(entry, &tuning);
    let (mut output, mut input) = (0.0, 0.0);
    for (k, t) in run.t.iter().enumerate() {
        for i in 0..3 {
            let unit = bench.supply.inertia[i];
            let z = run.dq[k][i] - bench.reference(i, *t)[1] + slide(run.e[k][i]);
            let d = (run.dq[k][i] / 0.02).tanh();
            output += unit * z * z;
            input += 0.01 * d * d / unit;
        }
    }
    assert!(output > 0.0 && output <= input, "{output} of {input}");
}

#[test]
fn the_robust_law_decreases_its_function_and_takes_what_the_model_lacks() {
    let bench = displaced(3.0);
    let entry = rival("robust").unwrap();
    let run = bench.run(entry, &bench.published(entry));
    let (p12, p22) = (100.0, 20.0);
    let value = |k: usize| {
        let each = (0..3).map(|i| {
            let e = run.e[k][i];
            let de = run.dq[k][i] - bench.reference(i, run.t[k])[1];
            p12 * p22 * e * e + 2.0 * p12 * e * de + p22 * de * de
        });
        each.sum::<f64>()
    };
    decreases(&(0..run.t.len()).map(value).collect::<Vec<_>>(), "V");
    let bench = Bench::arm("planar3r");
    let weak = Tuning::new(&[1e4, 200.0, 1e-3, 0.05], &bench.supply.inertia, PERIOD).unwrap();
    let (with, without) = (bench.run(entry, &bench.published(entry)), bench.run(entry, &weak));
    assert!(20.0 * with.rms_worst(4.0) < without.rms_worst(4.0));
}

/// The linear part alone overshoots by `exp(−π ζ/√(1 − ζ²))`, 25.4 % at 0.4.
#[test]
fn nonlinear_feedback_takes_the_overshoot_away() {
    let mut bench = Bench::arm("planar3r").exact();
    (bench.amplitude, bench.duration) = (0.0, 1.5);
    bench.start[1] -= 0.2;
    let entry = rival("cnf").unwrap();
    let overshoot = |growth: f64| {
        let values = [20.0, 0.4, growth, 2.0, 30.0];
        let tuning = Tuning::new(&values, &bench.supply.inertia, PERIOD).unwrap();
        let run = bench.run(entry, &tuning);
        run.e.iter().map(|e| e[1]).fold(0.0, f64::max) / 0.2
    };
    let (linear, nonlinear) = (overshoot(1e-9), overshoot(30.0));
    assert!((linear - 0.254).abs() < 0.01, "{linear}");
    assert!(nonlinear < 0.04, "{nonlinear}");
}

#[test]
fn the_observer_of_the_sliding_mode_holds_a_load_that_the_model_lacks() {
    let mut bench = Bench::arm("planar3r");
    (bench.amplitude, bench.duration) = (0.0, 4.0);
    bench.friction.1.fill(0.0);
    let entry = rival("switching").unwrap();
    let held = bench.run(entry, &bench.published(entry));
    assert!(held.error_peak(3.9) < 1e-7, "{}", held.error_peak(3.9));
    // Without the observer the feedback alone holds a fifth of the weight.
    let blind = Tuning::new(&[10.0, 20.0, 8.0, 0.05, 1e-9], &bench.supply.inertia, PERIOD).unwrap();
    assert!(bench.run(entry, &blind).error_peak(3.9) > 1e-4);
}

/// One inertia under a velocity gain, held over a sample: stable below 2, below 1 with a sample of delay.
#[test]
fn the_conditions_of_sampling_are_those_of_a_single_inertia() {
    let bench = Bench::arm("planar3r");
    let entry = rival("pd-plus").unwrap();
    let mut arm = bench.declared();
    arm.ratio = [0.5, 2.0];
    let values = [20.0, 1.0];
    let tuning = Tuning::new(&values, &bench.supply.inertia, PERIOD).unwrap();
    // K_D T = 0.04 against 2 λ and, a sample late, λ.
    for (delay, margin) in [(0, 25.0), (1, 12.5)] {
        arm.delay_samples = delay;
        let found = entry.condition(&tuning, &arm).unwrap();
        assert!(found.holds && (found.margin - margin).abs() < 1e-9, "{found:?}");
    }
}

/// With an exact model the arm ends on the path and runs along it at the task's own speed, at no set time.
#[test]
fn the_orbit_is_reached_and_run_at_its_own_speed() {
    let mut bench = displaced(12.0);
    let path = bench.supply.orbit.clone().unwrap();
    let entry = rival("orbital").unwrap();
    let run = bench.run(entry, &bench.published(entry));
    let off = run.distance(path.as_ref(), 10.0);
    assert!(off < 2e-3, "{off}");
    // A turn later it is where it was.
    let turn = run.t.len() - 1 - 6170;
    let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 5e-3);
    assert!(near(&run.q[turn], run.q.last().unwrap()), "{:?}", run.q[turn]);
    assert!(run.error_peak(10.0) > 0.05, "not on the time table either");
    // Dry friction slows it down: the path is kept, the turn is not completed.
    bench.friction.1.fill(0.2);
    let run = bench.run(entry, &bench.published(entry));
    assert!(run.distance(path.as_ref(), 8.0) < 0.03);
    assert!(!near(&run.q[turn], run.q.last().unwrap()));
}

/// A load that the model lacks is estimated as `K_O/(s + K_O)` of it, integrated on its own along the run,
/// and taken off: dry friction here.
#[test]
fn the_momentum_observer_finds_the_load_behind_its_own_filter() {
    let mut bench = Bench::arm("planar3r").exact();
    bench.friction.1 = vec![0.4, 0.3, 0.2];
    (bench.supply.dry, bench.duration) = (vec![0.0; 3], 3.0);
    let entry = rival("momentum-observer").unwrap();
    let tuning = Tuning::new(&[20.0, 1.0, 50.0], &bench.supply.inertia, PERIOD).unwrap();
    let run = bench.run(entry, &tuning);
    let mut ws = Workspace::new(&bench.plant);
    let (mut found, mut worst) = ([0.0_f64; 3], 0.0_f64);
    for (k, t) in run.t.iter().enumerate() {
        let d: Vec<[f64; 3]> = (0..3).map(|i| bench.reference(i, *t)).collect();
        let a: Vec<f64> = (0..3)
            .map(|i| d[i][2] - 40.0 * (run.dq[k][i] - d[i][1]) - 400.0 * run.e[k][i])
            .collect();
        let wanted = bench.exact_torque(&mut ws, &run.q[k], &run.dq[k], &run.dq[k], &a);
        for i in 0..3 {
            // τ = computed torque − r.
            let r = wanted[i] - run.tau[k][i];
            worst = worst.max((r - found[i]).abs());
            let load = -bench.friction.1[i] * (run.dq[k][i] / 0.02).tanh();
            found[i] += -(-50.0 * PERIOD).exp_m1() * (load - found[i]);
        }
    }
    // Half a sample of the load's own change is all that they may differ by.
    assert!(worst < 0.03 && found[0].abs() > 0.2, "{worst} {found:?}");
    // Identified friction, fed forward, leaves less for the observer to find and less error.
    let error = |dry: Vec<f64>| {
        let mut bench = bench.clone();
        bench.supply.dry = dry;
        bench.run(entry, &tuning).rms_worst(1.0)
    };
    let (told, untold) = (error(vec![0.4, 0.3, 0.2]), error(vec![0.0; 3]));
    assert!(told < 0.7 * untold, "{told} and {untold}");
}

/// Feed-forward of friction: with a law that has a model, the error from dry friction at a steady speed
/// vanishes; a law without a model is built as it is.
#[test]
fn friction_is_fed_forward_to_laws_with_a_model_alone() {
    let mut bench = Bench::arm("planar3r").exact();
    bench.friction.1 = vec![0.4, 0.3, 0.2];
    bench.supply.dry = bench.friction.1.clone();
    let zero = [0.0; 3];
    let moving = [0.3, -0.4, 0.5];
    let torque = |id: &str, friction: bool| {
        let entry = rival(id).unwrap();
        let tuning = bench.published(entry);
        let built = if friction {
            entry.build_with_friction(&tuning, &bench.supply)
        } else {
            entry.build(&tuning, &bench.supply)
        };
        let mut law = built.unwrap();
        let mut tau = [0.0; 3];
        let all = All {
            q: &bench.center,
            dq: &moving,
            tau: &zero,
            commanded: &zero,
            clipped: &[false; 3],
            q_d: &bench.center,
            dq_d: &moving,
            ddq_d: &zero,
            ddq_d_acting: &zero,
        };
        law.update(&all, &mut tau);
        tau
    };
    for id in ["computed-torque", "nric", "computed-torque-integral"] {
        let (with, without) = (torque(id, true), torque(id, false));
        for i in 0..3 {
            let exact = bench.friction.1[i] * moving[i] / moving[i].hypot(0.01);
            assert!((with[i] - without[i] - exact).abs() < 1e-12, "{id}: {with:?} {without:?}");
        }
    }
    for id in ["pd", "momentum-observer"] {
        let bits = |friction: bool| torque(id, friction).map(f64::to_bits);
        assert_eq!(bits(true), bits(false), "{id}");
    }
}

/// The maker's stack, worked again from the record: impedance, the filter of its library, the step that its
/// rate allows.
#[test]
fn the_makers_stack_is_its_three_stages() {
    let mut bench = Bench::arm("planar3r");
    (bench.duration, bench.supply.torque_rate_max) = (1.0, Some(vec![200.0; 3]));
    bench.start[1] += 0.1;
    let entry = rival("makers-stack").unwrap();
    let run = bench.run(entry, &bench.published(entry));
    let (model, units) = (bench.supply.model.clone(), bench.supply.inertia.clone());
    let mut ws = Workspace::new(&model);
    let share = PERIOD / (PERIOD + 1.0 / (2.0 * core::f64::consts::PI * 100.0));
    let (mut filtered, mut sent, mut limited) = ([0.0_f64; 3], [0.0_f64; 3], 0);
    for (k, t) in run.t.iter().enumerate() {
        let mut bias = [0.0; 3];
        model.bias(&mut ws, &run.q[k], &run.dq[k], &mut bias);
        for i in 0..3 {
            let de = run.dq[k][i] - bench.reference(i, *t)[1];
            let u = bias[i] - units[i] * (400.0 * run.e[k][i] + 40.0 * de);
            if k == 0 {
                (filtered[i], sent[i]) = (u, u);
            } else {
                filtered[i] += share * (u - filtered[i]);
                let step = filtered[i] - sent[i];
                limited += i32::from(step.abs() > 0.2);
                sent[i] += step.clamp(-0.2, 0.2);
            }
            assert!((sent[i] - run.tau[k][i]).abs() < 1e-9, "{k} {i}");
        }
    }
    assert!(limited > 5, "{limited}");
}

/// On the reference with an exact model, the feed-forward is the motion's own torque, and hardly anything is
/// left for the gains; and the model receives no measurement: at the same error the torque is the
/// reference's, wherever the arm is.
#[test]
fn a_torque_from_the_reference_alone_drives_an_exact_arm() {
    let bench = Bench::arm("planar3r").exact();
    let error = |id: &str| {
        let entry = rival(id).unwrap();
        let tuning = Tuning::new(&[20.0, 1.0], &bench.supply.inertia, PERIOD).unwrap();
        bench.run(entry, &tuning).error_peak(0.0)
    };
    let (with, without) = (error("feedforward-pd"), error("pd-gravity"));
    assert!(with < 2e-3 && with < 0.3 * without, "{with} {without}");
}
