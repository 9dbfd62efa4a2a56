//! Rivals that learn: what they learn is what takes the error away.

use crate::support::{Bench, PERIOD};
use phihat_model::Workspace;
use phihat_rivals::{Knows, Planar, Tuning, rival};

/// Error late in a run, with learning as published and with (almost) none. With the sign of the update
/// changed the first is the larger one, or the run ends.
fn learnt(id: &str, rates: &[usize]) -> (f64, f64) {
    let mut bench = Bench::arm("planar3r").exact();
    bench.duration = 25.0;
    let entry = rival(id).unwrap();
    let mut values: Vec<_> = entry.scalars.iter().map(|scalar| scalar.default).collect();
    let mut late = || {
        let tuning = Tuning::new(&values, &bench.supply.inertia, PERIOD).unwrap();
        let run = bench.run(entry, &tuning);
        assert!(run.complete(&bench), "{id} diverged");
        let late = run.rms_worst(18.8);
        for rate in rates {
            values[*rate] *= 1e-9;
        }
        late
    };
    (late(), late())
}

#[test]
fn what_is_learnt_takes_the_error_away() {
    let cases: [(&str, &[usize], f64); 6] = [
        ("slotine-li-units", &[2, 3, 4, 5], 40.0),
        ("slotine-li", &[2], 40.0),
        ("fat", &[2, 3], 30.0),
        ("fat-lumped", &[2], 5.0),
        ("output-feedback", &[4], 20.0),
        ("filtered-regressor", &[2, 3], 100.0),
    ];
    for (id, rates, factor) in cases {
        let (with, without) = learnt(id, rates);
        println!("{id:<20} {with:.2e} with, {without:.2e} without");
        assert!(with * factor < without, "{id}: {with} with, {without} without");
    }
}

/// With nothing learnt yet the units of the gains are all that is in the torque.
#[test]
fn slotine_and_lis_first_torque_is_damping_alone() {
    let bench = Bench::arm("planar3r");
    let entry = rival("slotine-li").unwrap();
    let mut moved = bench.clone();
    moved.start = vec![0.3, 1.0, 0.9];
    moved.duration = PERIOD;
    let run = moved.run(entry, &moved.published(entry));
    for i in 0..3 {
        // Nothing is known at first: K_D (ė + Λ e) is all.
        let expected = -80.0 * bench.supply.inertia[i] * 10.0 * run.e[0][i];
        assert!((run.tau[0][i] - expected).abs() < 1e-12);
    }
}

/// On an arm that is held, everything learnt ends in the gravity torque, whatever was learnt.
#[test]
fn a_held_arm_is_held_without_error() {
    let mut bench = Bench::arm("planar3r").exact();
    (bench.amplitude, bench.duration) = (0.0, 20.0);
    let mut ws = Workspace::new(&bench.plant);
    let mut gravity = [0.0; 3];
    bench.plant.gravity_torque(&mut ws, &bench.center, &mut gravity);
    for id in ["slotine-li", "output-feedback", "filtered-regressor"] {
        let entry = rival(id).unwrap();
        let mut values: Vec<_> = entry.scalars.iter().map(|scalar| scalar.default).collect();
        if id != "filtered-regressor" {
            *values.last_mut().unwrap() = 1e-9;
        }
        let tuning = Tuning::new(&values, &bench.supply.inertia, PERIOD).unwrap();
        let run = bench.run(entry, &tuning);
        assert!(run.error_peak(19.0) < 1e-4, "{id}: {}", run.error_peak(19.0));
        for i in 0..3 {
            assert!((run.tau.last().unwrap()[i] - gravity[i]).abs() < 1e-2, "{id} {i}");
        }
    }
}

/// The estimation error in the update makes the transient shorter than the sliding variable alone.
#[test]
fn the_filtered_regressor_learns_faster() {
    let bench = Bench::arm("planar3r").exact();
    let error = |id: &str| {
        let entry = rival(id).unwrap();
        bench.run(entry, &bench.published(entry)).rms_worst(1.0)
    };
    let (filtered, plain) = (error("filtered-regressor"), error("slotine-li"));
    assert!(filtered < 0.7 * plain, "{filtered} against {plain}");
}

/// Purpose of the law: with lengths believed 10 % too long the tip gets where it shall. Its form of the
/// kinematics is the model's.
#[test]
fn the_tip_is_followed_with_lengths_that_are_not_known() {
    let mut bench = Bench::arm("planar3r").exact();
    bench.duration = 25.0;
    let entry = rival("task-space").unwrap();
    let tuning =
        |length_rate| Tuning::new(&[10.0, 160.0, 5.0, length_rate], &bench.supply.inertia, PERIOD);
    let (run, ignorant) =
        (bench.run(entry, &tuning(5.0).unwrap()), bench.run(entry, &tuning(1e-6).unwrap()));
    let planar = Planar::of(&bench.supply).unwrap();
    let tip = bench.plant.frame(&bench.supply.tip).unwrap();
    let mut ws = Workspace::new(&bench.plant);
    let mut place = |q: &[f64]| {
        bench.plant.forward_kinematics(&mut ws, q);
        bench.plant.pose(&ws, tip).p
    };
    let far = |a: [f64; 3], b: [f64; 3]| {
        a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
    };
    let (one, other) = (&run.q[1000], &run.q[4000]);
    let ([a, _], [b, _]) = (planar.tip(one, &[0.0; 3]), planar.tip(other, &[0.0; 3]));
    let seen = (a[0] - b[0]).hypot(a[1] - b[1]);
    assert!(seen > 0.05 && (far(place(one), place(other)) - seen).abs() < 1e-9);
    let worst = |run: &crate::support::Run, from: usize| {
        (from..from + 3000)
            .map(|k| {
                let wanted: Vec<_> = (0..3).map(|i| bench.reference(i, run.t[k])[0]).collect();
                let (q, q_d) =
                    (planar.tip(&run.q[k], &[0.0; 3])[0], planar.tip(&wanted, &[0.0; 3])[0]);
                (q[0] - q_d[0]).hypot(q[1] - q_d[1])
            })
            .fold(0.0, f64::max)
    };
    let (early, late) = (worst(&run, 1000), worst(&run, 22_000));
    assert!(early > 1e-3 && late < 0.25 * early, "{early} to {late} m");
    let never = worst(&ignorant, 22_000);
    assert!(late < 0.2 * never, "{late} m, and {never} m where lengths are not learnt");
}

#[test]
fn an_arm_in_space_has_no_planar_kinematics() {
    let bench = Bench::arm("panda");
    let entry = rival("task-space").unwrap();
    let refused = entry.build(&bench.published(entry), &bench.supply).unwrap_err();
    assert!(refused.to_string().contains("redundant"), "{refused}");
    assert!(entry.needs.task && !entry.needs.model_free());
}
