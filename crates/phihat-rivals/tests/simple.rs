//! PD, computed torque, the H-infinity PID, and the proposed law among them.

use crate::support::{Bench, PERIOD};
use phihat_rivals::{All, Tuning, rival};

#[test]
fn pd_under_gravity_sags_by_the_load_over_the_stiffness() {
    let mut bench = Bench::arm("planar3r");
    (bench.amplitude, bench.duration) = (0.0, 4.0);
    bench.friction.1.fill(0.0);
    let entry = rival("pd").unwrap();
    let run = bench.run(entry, &bench.published(entry));
    let q = run.q.last().unwrap();
    let mut gravity = vec![0.0; 3];
    let mut ws = phihat_model::Workspace::new(&bench.plant);
    bench.plant.gravity_torque(&mut ws, q, &mut gravity);
    for i in 0..3 {
        let sag = -gravity[i] / (400.0 * bench.supply.inertia[i]);
        assert!((run.e.last().unwrap()[i] - sag).abs() < 1e-6, "joint {i}: {sag}");
    }
}

#[test]
fn computed_torque_with_the_true_model_makes_the_error_a_critically_damped_joint() {
    let mut bench = Bench::arm("planar3r").exact();
    (bench.start[1], bench.duration) = (bench.center[1] + 0.2, 0.5);
    let entry = rival("computed-torque").unwrap();
    let run = bench.run(entry, &bench.published(entry));
    for (t, e) in run.t.iter().zip(&run.e) {
        let exact = 0.2 * (1.0 + 20.0 * t) * (-20.0 * t).exp();
        // The torque is held over a sample, the model moves within it.
        assert!((e[1] - exact).abs() < 2.5e-3, "{t}: {} and {exact}", e[1]);
        assert!(e[0].abs() < 2.5e-3 && e[2].abs() < 2.5e-3);
    }
}

/// `e⃛ + K_d ë + K_p ė + K_i e = 0` of the exact model, integrated on its own; and what a wrong model leaves
/// at rest is gone.
#[test]
fn computed_torque_with_integral_is_a_third_order_joint_that_forgets_its_load() {
    let mut bench = Bench::arm("planar3r").exact();
    (bench.start[1], bench.duration) = (bench.center[1] + 0.2, 0.8);
    let entry = rival("computed-torque-integral").unwrap();
    let run = bench.run(entry, &bench.published(entry));
    let (kp, kd, ki, h) = (400.0, 40.0, 400.0 * 5.0, PERIOD / 20.0);
    let (mut e, mut de, mut sum) = (0.2_f64, 0.0_f64, 0.0_f64);
    for (t, found) in run.t.iter().zip(&run.e) {
        assert!((found[1] - e).abs() < 2.5e-3, "{t}: {} and {e}", found[1]);
        assert!(found[0].abs() < 2.5e-3 && found[2].abs() < 2.5e-3);
        for _ in 0..20 {
            // Midpoint.
            let dde = |e: f64, de: f64, sum: f64| -kd * de - kp * e - ki * sum;
            let a = dde(e, de, sum);
            let (e1, de1, sum1) = (e + 0.5 * h * de, de + 0.5 * h * a, sum + 0.5 * h * e);
            (e, de, sum) = (e + h * de1, de + h * dde(e1, de1, sum1), sum + h * e1);
        }
    }
    let mut bench = Bench::arm("planar3r");
    (bench.amplitude, bench.duration) = (0.0, 8.0);
    bench.friction.1.fill(0.0);
    let left = |id: &str| {
        let entry = rival(id).unwrap();
        let run = bench.run(entry, &bench.published(entry));
        run.e.last().unwrap().iter().fold(0.0_f64, |most, e| most.max(e.abs()))
    };
    let (without, with) = (left("computed-torque"), left("computed-torque-integral"));
    assert!(without > 1e-3 && with < 1e-9, "{without} and {with}");
}

/// Identity 4 of the theory: order 1 is this PID plus acceleration feed-forward.
#[test]
fn the_h_infinity_pid_is_the_first_order_law_at_rest() {
    let (kd, kp, a0) = (40.0, 400.0, 69.6);
    let gamma = 0.5;
    let values =
        [(kp + a0 * kd) / (kd + a0), a0 * kp / (kd + a0), kd + a0 - 1.0 / (gamma * gamma), gamma];
    let mut bench = Bench::arm("planar3r");
    bench.start[0] += 0.0;
    bench.amplitude = 0.0;
    bench.duration = 3.0;
    let entry = rival("h-infinity-pid").unwrap();
    let tuning = Tuning::new(&values, &bench.supply.inertia, PERIOD).unwrap();
    let pid = bench.run(entry, &tuning);
    let first = rival("proposed-1").unwrap();
    let law = bench.run(first, &bench.published(first));
    let far = (0..3).map(|i| (pid.e.last().unwrap()[i] - law.e.last().unwrap()[i]).abs());
    assert!(far.fold(0.0, f64::max) < 1e-6);
    let along = |k: usize| (pid.e[k][0] - law.e[k][0]).abs();
    let largest = pid.e.iter().map(|e| e[0].abs()).fold(0.0, f64::max);
    let apart = (0..pid.e.len()).map(along).fold(0.0, f64::max);
    // The same law but for how it is discretised.
    assert!(largest > 1e-3 && apart < 0.1 * largest, "{apart} of {largest}");
}

#[test]
fn the_h_infinity_pid_keeps_its_attenuation_on_the_coupled_arm() {
    // (3): with x, tau, w of the run itself; w from the true model. Wrong with either sign changed.
    let mut bench = Bench::arm("planar3r");
    bench.friction.1.fill(0.0);
    let entry = rival("h-infinity-pid").unwrap();
    let tuning = bench.published(entry);
    let run = bench.run(entry, &tuning);
    let [kp, ki, k, gamma] = tuning.values().unwrap();
    let mut ws = phihat_model::Workspace::new(&bench.plant);
    let n = 3;
    let (mut cost, mut paid, mut sum) = (0.0, 0.0, vec![0.0; n]);
    for (step, t) in run.t.iter().enumerate() {
        let (e, q, v) = (&run.e[step], &run.q[step], &run.dq[step]);
        let d: Vec<_> = (0..n).map(|i| bench.reference(i, *t)).collect();
        let de: Vec<_> = (0..n).map(|i| v[i] - d[i][1]).collect();
        for i in 0..n {
            sum[i] += PERIOD * e[i];
        }
        // The reference acceleration and velocity of the sliding variable.
        let a: Vec<_> = (0..n).map(|i| d[i][2] - kp * de[i] - ki * e[i]).collect();
        let w: Vec<_> = (0..n).map(|i| d[i][1] - kp * e[i] - ki * sum[i]).collect();
        let mut model = bench.exact_torque(&mut ws, q, v, &w, &a);
        for i in 0..n {
            model[i] += bench.friction.0[i] * (v[i] - w[i]);
            let unit = bench.supply.inertia[i];
            let r = 1.0 / (unit * (k + 1.0 / (gamma * gamma)));
            let q_cost = unit
                * k
                * (ki * ki * sum[i] * sum[i] + (kp * kp - 2.0 * ki) * e[i] * e[i] + de[i] * de[i]);
            cost += PERIOD * (q_cost + r * run.tau[step][i] * run.tau[step][i]);
            paid += PERIOD * gamma * gamma / unit * model[i] * model[i];
        }
    }
    assert!(cost > 0.0 && cost <= 1.02 * paid, "{cost} of {paid}");
}

#[test]
fn a_rival_is_handed_only_what_it_declares() {
    // PD has no use for the torque that acted: what is there must not matter.
    let bench = Bench::arm("planar3r");
    let entry = rival("pd").unwrap();
    let mut answers = Vec::new();
    for acted in [0.0, 1e9] {
        let mut pd = entry.build(&bench.published(entry), &bench.supply).unwrap();
        let (q, zero, tau) = ([0.1; 3], [0.0; 3], [acted; 3]);
        let mut out = [0.0; 3];
        let all = All {
            q: &q,
            dq: &zero,
            tau: &tau,
            commanded: &tau,
            clipped: &[false; 3],
            q_d: &zero,
            dq_d: &zero,
            ddq_d: &tau,
            ddq_d_acting: &tau,
        };
        pd.update(&all, &mut out);
        answers.push(out.map(f64::to_bits));
    }
    assert_eq!(answers[0], answers[1]);
    assert!(!entry.needs.torque && entry.needs.derivatives == 1);
}

/// Stiffness, damping, filter and limit of the torque's change are those of the shipped files, played again beside the
/// law; gravity is outside of the limit.
#[test]
fn the_shipped_impedance_is_that_of_its_files() {
    let stiffness = [600.0, 600.0, 600.0, 600.0, 250.0, 150.0, 50.0];
    let damping = [50.0, 50.0, 50.0, 20.0, 20.0, 20.0, 10.0];
    let mut bench = Bench::arm("panda").exact();
    bench.start.iter_mut().for_each(|q| *q += 0.05);
    bench.duration = 0.5;
    let entry = rival("franka-ros-impedance").unwrap();
    let run = bench.run(entry, &bench.published(entry));
    let mut ws = phihat_model::Workspace::new(&bench.plant);
    let (mut filtered, mut sent, mut limited) = ([0.0; 7], [0.0; 7], 0);
    for (step, t) in run.t.iter().enumerate() {
        let (mut gravity, mut bias) = ([0.0; 7], [0.0; 7]);
        bench.plant.gravity_torque(&mut ws, &run.q[step], &mut gravity);
        bench.plant.bias(&mut ws, &run.q[step], &run.dq[step], &mut bias);
        for i in 0..7 {
            filtered[i] = 0.01 * filtered[i] + 0.99 * run.dq[step][i];
            let rate = filtered[i] - bench.reference(i, *t)[1];
            let wanted = bias[i] - gravity[i] - stiffness[i] * run.e[step][i] - damping[i] * rate;
            let change: f64 = wanted - sent[i];
            limited += i32::from(step > 0 && change.abs() > 1.0);
            sent[i] += if step > 0 { change.clamp(-1.0, 1.0) } else { change };
            let found = run.tau[step][i] - gravity[i];
            assert!((found - sent[i]).abs() < 1e-8, "joint {i} at {t}: {found}, {}", sent[i]);
        }
    }
    assert!(limited > 0 && run.complete(&bench));
    let planar = Bench::arm("planar3r");
    assert!(entry.build(&planar.published(entry), &planar.supply).is_err());
}
