//! Imperfections of a laboratory: drives, sensors and messages, each against its closed form. Wrong if an
//! effect had another size, sign or timing than its key says, or left a mark where it is absent.

use crate::support::{ROD_INERTIA, rod_study, run};
use phihat_sim::{SimulationOutcome, Survival, Trace};

const HOLD: &str = "[start]\nq_rad = 0.31\n[reference]\nkind = \"hold\"\nq_rad = 0.3\n";
const TURN: &str = "[reference]\nkind = \"sines\"\ncenter_rad = 0.0\n[[reference.sine]]\n\
                    amplitude_rad = 1.0\nfrequency_hz = 0.5\n";

/// The rod without gravity, friction or delay, for a second.
fn free(rest: &str) -> SimulationOutcome {
    let rest = if rest.contains("[world]") {
        rest.replace("[world]", "[world]\ngravity_m_s2 = [0.0, 0.0, 0.0]")
    } else {
        format!("[world]\ngravity_m_s2 = [0.0, 0.0, 0.0]\n{rest}")
    };
    run(&rod_study("duration_s = 1.0\nseed = 5", &rest))
}

fn fault(kind: &str, rest: &str) -> String {
    format!("[[fault]]\nkind = \"{kind}\"\nstart_s = 0.2\nduration_s = 0.3\n{rest}\n")
}

/// `J q̈ / τ` of what was asked for: the gain of the way to the joint.
fn gains(trace: &Trace) -> impl Iterator<Item = f64> {
    let joint = &trace.joints[0];
    joint.ddq.iter().zip(&joint.tau_command).map(|(ddq, tau)| ROD_INERTIA * ddq / tau)
}

#[test]
fn effects_of_size_zero_leave_every_bit_as_it_is() {
    let base = "[sensor]\nencoder_bits = 18\nvelocity = \"differenced\"\n";
    let plain = free(&format!("{base}{HOLD}"));
    let sensor = [
        "position_noise_rad = 0.0",
        "position_bias_rad = 0.0",
        "velocity_noise_rad_s = 0.1",
        "torque_noise_nm = 0.0",
        "sample_jitter_s = 0.0",
        "position_noise_max_rad = 0.0\nposition_noise_max_lsb = 0.0\nsample_stamps = \"nominal\"",
        "sample_delay_samples = 0",
        "wrap = true",
        "torque = \"demanded\"",
    ];
    for key in sensor {
        let outcome = free(&format!("{base}{key}\n{HOLD}"));
        assert_eq!(outcome, plain, "{key}");
    }
    let world = [
        "[world.drive]\ngain = 1.0\ngain_error = 0.0\nripple = 0.0\ncogging_nm = 0.0",
        "[world.drive]\ntorque_max_nm = 1e4\ntorque_rate_max_nm_s = 1e8\nno_load_speed_rad_s = 1e4",
        "[world.network]\ncommand_loss = 0.0\nsample_loss = 0.0\nsample_burst_samples = 3.0",
    ];
    let faults = [
        "drive_gain = 1",
        "drive_limit = 10000",
        "friction = 1",
        "friction = 0",
        "brake = 0",
        "push = 0",
        "payload = 0",
        "sensor_bias = 0",
        "sensor_noise = 0",
        "sample_loss = 0",
        "command_loss = 0",
        "clock_jump = 0",
    ];
    let faults = faults.map(|entry| {
        let (kind, size) = entry.split_once(" = ").unwrap();
        fault(kind, &format!("size = {size}"))
    });
    for text in world.into_iter().map(str::to_owned).chain(faults) {
        let outcome = free(&format!("{base}[world]\n{text}\n{HOLD}"));
        assert_eq!(outcome.trace, plain.trace, "{text}");
    }
}

#[test]
fn same_seed_same_run_another_seed_another_run() {
    let noisy = "[sensor]\nposition_noise_rad = 1e-5\n[world.network]\nsample_loss = 0.1\n";
    let at = |seed: u32| {
        run(&rod_study(&format!("duration_s = 0.3\nseed = {seed}"), &format!("{noisy}{HOLD}")))
    };
    assert_eq!(at(5), at(5));
    assert_ne!(at(5).trace, at(6).trace);
}

#[test]
fn weak_dead_and_reversed_drives_give_their_share_of_the_torque() {
    for gain in [0.5, 0.0, 1.3] {
        let steady = free(&format!("[world.drive]\ngain = {gain}\n{HOLD}"));
        assert!(gains(&steady.trace).take(300).all(|share| (share - gain).abs() < 1e-9));
    }
    let outcome = free(&format!("{}{TURN}", fault("drive_gain", "size = 0.5")));
    for (k, share) in gains(&outcome.trace).enumerate().skip(1) {
        let expected = if (200..500).contains(&k) { 0.5 } else { 1.0 };
        assert!((share - expected).abs() < 1e-9, "sample {k}: {share}");
    }
    let reversed = free(&format!("{}{HOLD}", fault("drive_gain", "size = -1.0")));
    let share = gains(&reversed.trace).nth(210).unwrap();
    assert!((share + 1.0).abs() < 1e-9, "{share}");
}

#[test]
fn gain_errors_are_drawn_within_their_bound_and_drift_is_linear() {
    let drawn = |seed: u32| {
        let text = format!(
            "[world]\ngravity_m_s2 = [0.0, 0.0, 0.0]\n[world.drive]\ngain_error = 0.2\n\
             gain_drift_per_s = 0.1\n{TURN}"
        );
        let trace = run(&rod_study(&format!("duration_s = 0.6\nseed = {seed}"), &text)).trace;
        let [early, late] = [100, 500].map(|k| gains(&trace).nth(k).unwrap());
        assert!((late / early - 1.05 / 1.01).abs() < 1e-9, "{early} {late}");
        early / 1.01
    };
    let all: Vec<f64> = (0..40).map(drawn).collect();
    assert!(all.iter().all(|gain| (0.8..=1.2).contains(gain)));
    let mean = all.iter().sum::<f64>() / 40.0;
    assert!((mean - 1.0).abs() < 0.06, "{mean}");
    assert!(all.iter().any(|gain| *gain < 0.88) && all.iter().any(|gain| *gain > 1.12));
}

#[test]
fn ripple_and_cogging_follow_the_position() {
    let drive = "[world.drive]\nripple = 0.1\ncogging_nm = 0.3\nripple_per_turn = 7\n";
    let joint = &free(&format!("{drive}{TURN}")).trace.joints[0];
    for k in 1..1000 {
        let wave = (7.0 * joint.q[k]).sin();
        let expected = joint.tau_command[k] * (1.0 + 0.1 * wave) + 0.3 * wave;
        assert!((ROD_INERTIA * joint.ddq[k] - expected).abs() < 1e-9, "sample {k}");
        // The mean over the sample, to the accuracy of the integrator's own quadrature.
        assert!((joint.tau_applied[k] - expected).abs() < 0.02, "sample {k}");
    }
}

#[test]
fn a_drive_gives_no_more_torque_than_it_has_at_its_speed() {
    let drive = "[world.drive]\ntorque_max_nm = 4.0\nno_load_speed_rad_s = 2.0\n";
    let far = "[start]\nq_rad = 0.0\n[reference]\nkind = \"hold\"\nq_rad = 1.5\n";
    let joint = &free(&format!("{drive}{far}")).trace.joints[0];
    let mut driving = 0;
    for k in 0..1000 {
        let tau = ROD_INERTIA * joint.ddq[k];
        let limit =
            if tau * joint.dq[k] > 0.0 { 4.0 * (1.0 - joint.dq[k].abs() / 2.0) } else { 4.0 };
        assert!(tau.abs() <= limit + 1e-9, "sample {k}: {tau} {limit}");
        driving += i32::from(joint.dq[k] > 0.2 && (tau - limit).abs() < 1e-9);
    }
    assert!(driving > 100, "the limit acts: {driving}");
    let weak = free(&format!("{}{TURN}", fault("drive_limit", "size = 0.5"))).trace;
    assert!((200..500).all(|k| (ROD_INERTIA * weak.joints[0].ddq[k]).abs() <= 0.5 + 1e-9));
}

#[test]
fn a_slow_drive_changes_its_torque_no_faster_than_it_can() {
    let drive = "[world.drive]\ntorque_rate_max_nm_s = 50.0\n";
    let joint = &free(&format!("{drive}{HOLD}")).trace.joints[0];
    let steps = joint.tau_applied.windows(2).map(|w| (w[1] - w[0]).abs());
    assert!((steps.fold(0.0, f64::max) - 0.05).abs() < 1e-9);
}

#[test]
fn a_noise_with_a_bound_reaches_it_and_stays_within_it() {
    let sensor = "[sensor]\nencoder_bits = 16\nposition_noise_max_lsb = 3.0\nposition_noise_max_rad = 1e-4\n";
    let joint = &free(&format!("{sensor}{HOLD}")).trace.joints[0];
    let quantum = core::f64::consts::TAU / 65536.0;
    let most = 3.5 * quantum + 1e-4;
    let off = joint.q_measured.iter().zip(&joint.q).map(|(m, q)| (m - q).abs());
    let largest = off.fold(0.0, f64::max);
    assert!(largest <= most * (1.0 + 1e-9) && largest > 0.8 * most, "{largest} {most}");
}

#[test]
fn a_lost_command_leaves_the_torque_of_the_one_before() {
    let outcome = free(&format!(
        "[world.network]\ncommands_lost_max = 3\ncommands_lost_every_s = 0.05\n{TURN}"
    ));
    let joint = &outcome.trace.joints[0];
    let pairs = joint.tau_applied.iter().zip(&joint.tau_command);
    let lost: Vec<bool> = pairs.map(|(acts, told)| (acts - told).abs() > 0.0).collect();
    let longest = lost.split(|own| !own).map(<[bool]>::len).max();
    assert_eq!((lost[..50].contains(&true), longest), (false, Some(3)));
    for (k, _) in lost.iter().enumerate().filter(|(_, lost)| **lost) {
        assert!((joint.tau_applied[k] - joint.tau_applied[k - 1]).abs() < 1e-12, "{k}");
    }
}

#[test]
fn noise_and_bias_of_the_sensors_have_their_size() {
    let sensor = "[sensor]\nposition_noise_rad = 2e-4\nposition_bias_rad = 1e-3\n\
                  velocity_noise_rad_s = 5e-3\n";
    let joint = &free(&format!("{sensor}{HOLD}")).trace.joints[0];
    let spread = |measured: &[f64], truth: &[f64]| {
        let off: Vec<f64> = measured.iter().zip(truth).map(|(m, q)| m - q).collect();
        let mean = off.iter().sum::<f64>() / off.len() as f64;
        let square = off.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / off.len() as f64;
        (mean, square.sqrt())
    };
    // Of 1000 samples: the mean is off by 1/√1000, the deviation by 1/√2000, in units of the latter.
    let (mean, deviation) = spread(&joint.q_measured, &joint.q);
    assert!((mean - 1e-3).abs() < 4.0 * 2e-4 / 1000_f64.sqrt(), "{mean}");
    assert!((deviation / 2e-4 - 1.0).abs() < 0.1, "{deviation}");
    let (mean, deviation) = spread(&joint.dq_measured, &joint.dq);
    assert!(mean.abs() < 4.0 * 5e-3 / 1000_f64.sqrt(), "{mean}");
    assert!((deviation / 5e-3 - 1.0).abs() < 0.1, "{deviation}");
    let text = format!(
        "{}{}{TURN}",
        fault("sensor_bias", "size = 0.01"),
        fault("sensor_noise", "size = 1e-4")
    );
    let joint = &free(&text).trace.joints[0];
    let (mean, deviation) = spread(&joint.q_measured[200..500], &joint.q[200..500]);
    assert!(
        (mean - 0.01).abs() < 4e-5 && (deviation / 1e-4 - 1.0).abs() < 0.2,
        "{mean} {deviation}"
    );
    assert_eq!(joint.q_measured[500..], joint.q[500..]);
}

#[test]
fn early_samples_show_where_the_arm_was() {
    let trace = free(&format!("[sensor]\nsample_jitter_s = 1e-3\n{TURN}")).trace;
    let joint = &trace.joints[0];
    let moving = (1..1000).filter(|k| joint.dq[*k].abs() > 0.5);
    let ages: Vec<f64> =
        moving.map(|k| (joint.q[k] - joint.q_measured[k]) / joint.dq[k] * 1e3).collect();
    assert!(ages.len() > 500 && ages.iter().all(|age| (-0.02..1.02).contains(age)));
    let mean = ages.iter().sum::<f64>() / ages.len() as f64;
    assert!((mean - 0.5).abs() < 0.05, "{mean}");
}

#[test]
fn late_samples_are_those_of_before() {
    let joint = &free(&format!("[sensor]\nsample_delay_samples = 3\n{HOLD}")).trace.joints[0];
    assert_eq!(joint.q_measured[3..], joint.q[..997]);
    assert!(joint.q_measured[..3].iter().all(|q| q.to_bits() == joint.q[0].to_bits()));
}

#[test]
fn a_wrapping_encoder_starts_over_at_pi() {
    let turn = "[start]\nq_rad = 2.9\ndq_rad_s = 1.0\n[reference]\nkind = \"hold\"\nq_rad = 2.9\n";
    // Dead drive: the rod turns on at 1 rad/s.
    let joint =
        &free(&format!("[sensor]\nwrap = true\n[world.drive]\ngain = 0.0\n{turn}")).trace.joints[0];
    for (measured, q) in joint.q_measured.iter().zip(&joint.q) {
        let turns = (q - measured) / core::f64::consts::TAU;
        assert!((turns - turns.round()).abs() < 1e-12 && measured.abs() <= core::f64::consts::PI);
    }
    assert!(joint.q_measured.iter().any(|q| *q < -3.0), "it passed π");
}

#[test]
fn lost_commands_leave_the_last_torque_standing() {
    let outcome = free(&format!("[world.network]\ncommand_loss = 0.3\n{TURN}"));
    let joint = &outcome.trace.joints[0];
    let lost =
        (1..1000).filter(|k| joint.tau_applied[*k].to_bits() != joint.tau_command[*k].to_bits());
    let lost: Vec<usize> = lost.collect();
    assert!(
        lost.iter().all(|k| joint.tau_applied[*k].to_bits() == joint.tau_applied[k - 1].to_bits())
    );
    assert!((230..370).contains(&lost.len()), "{} of 1000", lost.len());
    for kind in ["command_loss", "controller_stop"] {
        let joint = &free(&format!("{}{TURN}", fault(kind, ""))).trace.joints[0];
        let held = joint.tau_applied[199];
        assert!(joint.tau_applied[199..500].iter().all(|tau| tau.to_bits() == held.to_bits()));
        assert!(joint.tau_applied[500].to_bits() != held.to_bits());
        let computes = joint.tau_command[250].to_bits() != joint.tau_command[200].to_bits();
        assert_eq!(computes, kind == "command_loss", "a stopped controller does not compute");
    }
}

#[test]
fn lost_and_frozen_samples_repeat() {
    for kind in ["sample_loss", "sensor_freeze"] {
        let joint = &free(&format!("{}{TURN}", fault(kind, ""))).trace.joints[0];
        for k in 200..500 {
            assert_eq!(joint.q_measured[k].to_bits(), joint.q_measured[199].to_bits(), "{kind}");
            assert_eq!(joint.dq_measured[k].to_bits(), joint.dq_measured[199].to_bits(), "{kind}");
        }
        assert_eq!(joint.q_measured[500].to_bits(), joint.q[500].to_bits(), "{kind}");
    }
}

#[test]
fn a_body_picked_up_and_dropped_is_felt_as_its_weight() {
    // m g l cos(q) at the tip, 1 m from the hinge; velocities do not jump.
    let study = rod_study(
        "duration_s = 3.0",
        &format!(
            "[[fault]]\nkind = \"payload\"\nstart_s = 1.0\nduration_s = 1.0\nsize = 0.7\n{HOLD}"
        ),
    );
    let outcome = run(&study);
    let joint = &outcome.trace.joints[0];
    let weight = |mass: f64| -(2.0 * 0.5 + mass) * 9.81 * 0.3_f64.cos();
    for (k, mass) in [(990, 0.0), (1990, 0.7), (2990, 0.0)] {
        assert!(
            (joint.tau_applied[k] - weight(mass)).abs() < 1e-4,
            "{} {}",
            joint.tau_applied[k],
            weight(mass)
        );
    }
    let jump = joint.dq.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
    assert!(jump < 0.05, "{jump}");
    let survival = Survival::of(&outcome, &study);
    assert!(survival.finite && survival.torque_kept && survival.error_end_rad < 1e-5);
    assert!(
        (survival.error_peak_rad - joint.e[1000..].iter().fold(0.0, |m: f64, e| m.max(e.abs())))
            .abs()
            < 1e-15
    );
}

#[test]
fn friction_grows_and_brakes_drag() {
    let world = "[world]\nviscous_extra_nm_s_rad = 0.5\nsubsteps = 8\n";
    let joint = &free(&format!("{world}{}{TURN}", fault("friction", "size = 3.0"))).trace.joints[0];
    for (k, viscous) in [(100, 0.5), (300, 1.5), (700, 0.5)] {
        assert!(
            (joint.phi[k] - viscous * joint.dq[k]).abs() < 1e-9,
            "{} {}",
            joint.phi[k],
            joint.dq[k]
        );
    }
    let joint = &free(&format!("{world}{}{TURN}", fault("brake", "size = 2.0"))).trace.joints[0];
    assert!((joint.phi[300] - 0.5 * joint.dq[300] - 2.0 * joint.dq[300].signum()).abs() < 1e-3);
}

#[test]
fn not_a_number_and_wrong_order_reach_the_controller_as_they_are() {
    let text = "duration_s = 0.4\n[robot]\nname = \"planar3r\"\n[gains]\ninertia_kg_m2 = 0.2\n\
                bandwidth_rad_s = 20.0\nestimator_bandwidth_rad_s = 70.0\n[spec]\nsettle_s = 0.1\n\
                [reference]\nkind = \"hold\"\npose = \"ready\"\n";
    let order = crate::support::read(&format!("{text}{}", fault("joint_order", "size = 1")));
    let trace = run(&order).trace;
    for k in [100, 250] {
        let places = usize::from(k >= 200);
        for i in 0..3 {
            let from = &trace.joints[(i + places) % 3];
            assert_eq!(trace.joints[i].q_measured[k].to_bits(), from.q[k].to_bits());
        }
    }
    let nan = crate::support::read(&format!("{text}{}", fault("sensor_nan", "joint = \"joint2\"")));
    let outcome = run(&nan);
    assert!(outcome.trace.joints[1].q_measured[200].is_nan());
    assert!(!outcome.trace.joints[0].q_measured[200].is_nan());
}
