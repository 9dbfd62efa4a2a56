//! Torque interfaces of real robots: what they add is counted once, and their rules stop who breaks them.
//! Wrong if an interface added the wrong torque, or let through what the robot would refuse.

use crate::support::{read, rod_study, run};
use phihat_model::Workspace;
use phihat_sim::{StopReason, Survival, forecast};

const FAR: &str = "[start]\nq_rad = 0.0\n[reference]\nkind = \"hold\"\nq_rad = 0.5\n";
const HOLD: &str = "[reference]\nkind = \"hold\"\nq_rad = 0.3\n";
const FLAT: &str = "[world]\ngravity_m_s2 = [0.0, 0.0, 0.0]\n";

fn profile(name: &str, rest: &str) -> String {
    format!("[profile]\nname = \"{name}\"\n{rest}\n")
}

/// An arm held in its ready pose: the study of it.
fn held(robot: &str, interface: &str) -> phihat_study::Study {
    let rate = if interface == "ur" { 500.0 } else { 1000.0 };
    let arm = phihat_model::Robot::named(robot).unwrap();
    let inertia = arm.inertia_range(200, 1).mean;
    read(&format!(
        "duration_s = 3.0\n[robot]\nname = \"{robot}\"\n[gains]\nbandwidth_rad_s = 20.0\n\
         estimator_bandwidth_rad_s = 70.0\ninertia_kg_m2 = {inertia:?}\n[spec]\nsettle_s = 1.0\n\
         [loop]\nrate_hz = {rate}\n[world]\nfriction = \"none\"\n{}[reference]\nkind = \"hold\"\npose = \"ready\"\n",
        profile(interface, "")
    ))
}

#[test]
fn f25_gravity_is_counted_once_by_every_interface() {
    for robot in ["planar3r", "panda", "iiwa14", "ur5"] {
        for interface in ["ideal", "franka", "ur", "kuka_fri", "kortex"] {
            let study = held(robot, interface);
            let outcome = run(&study);
            assert_eq!(outcome.abort, None, "{robot} {interface}");
            let model = study.robot.plant_model();
            let mut gravity = vec![0.0; study.robot.joints.len()];
            let q: Vec<f64> =
                outcome.trace.joints.iter().map(|j| *j.q_desired.last().unwrap()).collect();
            let rest = vec![0.0; q.len()];
            model.bias(&mut Workspace::new(&model), &q, &rest, &mut gravity);
            let scale = gravity.iter().fold(0.0_f64, |most, tau| most.max(tau.abs()));
            let share = if ["ideal", "kortex"].contains(&interface) { 1.0 } else { 0.0 };
            for (joint, gravity) in outcome.trace.joints.iter().zip(&gravity) {
                let bias = joint.phi_hat.last().unwrap() - share * gravity;
                assert!(
                    bias.abs() < 0.01 * scale,
                    "{robot} {interface} {}: {bias} N·m",
                    joint.name
                );
                assert!(joint.e.last().unwrap().abs() < 1e-4, "{robot} {interface} {}", joint.name);
            }
        }
    }
}

#[test]
fn the_ideal_interface_is_none() {
    let plain = run(&rod_study("duration_s = 0.5", FAR));
    assert_eq!(
        run(&rod_study("duration_s = 0.5", &format!("{}{FAR}", profile("ideal", "")))),
        plain
    );
}

#[test]
fn franka_stops_on_a_torque_that_changes_too_fast() {
    let reckless = profile("franka", "controller_keeps = false\nfirst_torque_max_nm = 1000.0");
    let study = rod_study("duration_s = 1.0", &format!("{reckless}{FLAT}{FAR}"));
    let abort = run(&study).abort.unwrap();
    // The first command is M̄ K_p Δq = 0.52·400·0.5 = 104 N·m.
    assert_eq!((abort.t, abort.joint.as_deref()), (0.0, Some("hinge")));
    assert_eq!(
        abort.reason.to_string(),
        "the torque changed by 104.000 N·m in one sample, at most 1 is allowed"
    );
    let reckless = profile("franka", "controller_keeps = false");
    let abort =
        run(&rod_study("duration_s = 1.0", &format!("{reckless}{FLAT}{FAR}"))).abort.unwrap();
    assert!(matches!(abort.reason, StopReason::FirstTorque { .. }), "{}", abort.reason);
}

#[test]
fn a_controller_that_keeps_the_rules_is_not_stopped() {
    let study = rod_study(
        "duration_s = 2.0",
        &format!("{}{FLAT}{HOLD}[start]\nq_rad = 0.31\n", profile("franka", "")),
    );
    let outcome = run(&study);
    assert_eq!(outcome.abort, None);
    let told = &outcome.trace.joints[0].tau_command;
    assert!(told[0].to_bits() == 0 && told[1].abs() > 0.5, "{} {}", told[0], told[1]);
    assert!(told.windows(2).all(|w| (w[1] - w[0]).abs() <= 1.0 + 1e-9));
    assert!(outcome.trace.joints[0].e.last().unwrap().abs() < 1e-6);
}

#[test]
fn the_twentieth_loss_in_a_row_stops_a_franka_and_ten_a_ur() {
    let stop = |name: &str, rate: f64, samples: f64| {
        let fault = format!(
            "[[fault]]\nkind = \"command_loss\"\nstart_s = 0.5\nduration_s = {}\n[loop]\nrate_hz = {rate}\n",
            (samples - 0.5) / rate
        );
        let study =
            rod_study("duration_s = 1.0", &format!("{}{FLAT}{fault}{HOLD}", profile(name, "")));
        let outcome = run(&study);
        let survival = Survival::of(&outcome, &study);
        assert_eq!(survival.stopped.is_some(), outcome.abort.is_some());
        outcome.abort
    };
    for (name, rate, most) in [("franka", 1000.0, 20), ("ur", 500.0, 10)] {
        let losses = f64::from(most);
        assert_eq!(stop(name, rate, losses - 1.0), None);
        let abort = stop(name, rate, losses).unwrap();
        assert!((abort.t - (0.5 + (losses - 1.0) / rate)).abs() < 1e-9, "{}", abort.t);
        assert_eq!((abort.joint, abort.reason), (None, StopReason::Lost { losses: most, most }));
    }
}

#[test]
fn a_clamped_torque_does_not_stop_the_robot() {
    // The rod's limit is 200 N·m; the first command would be 0.52·400·2 = 416.
    let far = "[start]\nq_rad = 0.0\n[reference]\nkind = \"hold\"\nq_rad = 2.0\n[loop]\ntorque_max_nm = \"none\"\n";
    let study = rod_study(
        "duration_s = 0.1",
        &format!("{}{FLAT}{far}", profile("kuka_fri", "controller_keeps = false")),
    );
    let outcome = run(&study);
    assert_eq!(outcome.abort, None);
    let joint = &outcome.trace.joints[0];
    assert!(joint.tau_command[0] > 400.0 && (joint.tau_applied[0] - 200.0).abs() < 1e-9);
}

#[test]
fn the_filter_on_commands_is_the_sampled_first_order_low_pass() {
    let filter = profile("ideal", "torque_filter_hz = 100.0");
    let study =
        rod_study("duration_s = 0.3", &format!("{filter}{FLAT}{HOLD}[start]\nq_rad = 0.31\n"));
    let joint = &run(&study).trace.joints[0];
    let pole = (-core::f64::consts::TAU * 0.1).exp();
    let mut told = 0.0;
    for k in 0..300 {
        told = pole * told + (1.0 - pole) * joint.tau_command[k];
        assert!((joint.tau_applied[k] - told).abs() < 1e-12);
    }
}

#[test]
fn added_friction_leaves_the_rest_of_it_to_the_controller() {
    let study = |interface: &str| {
        let interface = profile("ideal", interface);
        read(&format!(
            "duration_s = 1.0\n[robot]\nname = \"panda\"\n[gains]\nbandwidth_rad_s = 20.0\n\
             estimator_bandwidth_rad_s = 70.0\ninertia_kg_m2 = [1.78, 2.22, 1.02, 1.28, 0.247, 0.259, 0.212]\n\
             [spec]\nsettle_s = 0.5\n{interface}[world]\ngravity_m_s2 = [0.0, 0.0, 0.0]\n[reference]\n\
             kind = \"sines\"\ncenter = \"ready\"\nfade_in_s = 0.2\n[[reference.sine]]\n\
             amplitude_rad = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.3]\nfrequency_hz = 0.5\n"
        ))
    };
    let last = |interface: &str| {
        let study = study(interface);
        let joint = run(&study).trace.joints[6].clone();
        let sigmoid = study.robot.joints[6].friction.sigmoid.unwrap();
        let k = joint.q.len() - 1;
        // φ − (M − M̄)q̈ of a joint whose inertia is constant is its friction.
        (joint.phi[k], sigmoid.torque(joint.dq[k]), joint.ddq[k])
    };
    let (none, friction, _) = last("");
    let (most, ..) = last("adds_friction = 0.8");
    assert!(friction.abs() > 0.2);
    let left = most / none;
    println!("friction {friction:.3} N·m: φ {none:.4} without, {most:.4} with 0.8 added");
    assert!(((none - most) / friction - 0.8).abs() < 0.02, "{left}");
}

#[test]
fn a_forecast_says_what_the_interface_will_not_bear() {
    let fast = "[reference]\nkind = \"sines\"\ncenter_rad = 0.0\n[[reference.sine]]\namplitude_rad = 0.3\n\
                frequency_hz = 6.0\n";
    let study = rod_study("duration_s = 2.0", &format!("{}{FLAT}{fast}", profile("franka", "")));
    let said = forecast(&study).unwrap();
    // J A ω³ = 0.52·0.3·37.7³ = 8358 N·m/s, and J A ω² = 222 N·m against 200.
    assert!(said.iter().any(|line| line.contains("N·m/s along the reference")), "{said:?}");
    assert!(said.iter().any(|line| line.contains("221.9") && line.contains("200")), "{said:?}");
    let calm = rod_study("duration_s = 2.0", &format!("{}{HOLD}", profile("franka", "")));
    assert_eq!(forecast(&calm).unwrap(), Vec::<String>::new());
    let bare = rod_study(
        "duration_s = 2.0",
        &format!("{}{HOLD}", profile("franka", "adds_gravity = false")),
    );
    assert!(forecast(&bare).unwrap()[0].contains("from the start"));
    assert!(forecast(&rod_study("duration_s = 2.0", HOLD)).unwrap().is_empty());
}

#[test]
fn another_rate_than_the_interface_takes_is_refused() {
    let text = profile("ur", "");
    let text = format!(
        "duration_s = 1.0\n[robot]\nfile = \"rod.urdf\"\n[gains]\nbandwidth_rad_s = 20.0\n\
         estimator_bandwidth_rad_s = 70.0\ninertia_kg_m2 = 0.52\n[spec]\nsettle_s = 0.1\n{text}{HOLD}"
    );
    let base = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/support");
    let error = phihat_study::Study::from_text(&text, "test.toml", &base).unwrap_err();
    assert!(error.key() == "profile.name" && error.to_string().contains("500 Hz"), "{error}");
}

#[test]
fn a_controller_that_heeds_the_echo_outlives_lost_packets() {
    // Full steps all the time: the torque swings between its limits as fast as the rule allows.
    let swing = "[reference]\nkind = \"sines\"\ncenter_rad = 0.0\n[[reference.sine]]\namplitude_rad = 0.4\n\
                 frequency_hz = 2.0\n";
    for seed in 0..20 {
        let network =
            "[world.network]\ncommand_loss = 0.1\nsample_loss = 0.1\nsample_burst_samples = 3.0\n";
        let text = format!("{}{FLAT}{network}{swing}", profile("franka", ""));
        let outcome = run(&rod_study(&format!("duration_s = 2.0\nseed = {seed}"), &text));
        assert_eq!(outcome.abort, None, "seed {seed}");
        let limited = outcome.trace.joints[0].rate_limited.iter().filter(|l| **l).count();
        assert!(limited > 20, "the rule acts: {limited}");
    }
}

/// The limits in force are those that the controller keeps, wherever they are stated.
#[test]
fn metrics_name_the_limits_of_the_interface() {
    let study = held("panda", "franka");
    let outcome = run(&study);
    let metrics = phihat_sim::Metrics::of(&outcome.trace, &study);
    for joint in &metrics.joints {
        assert!(joint.tau_step_limit_nm.is_some_and(|step| (step - 1.0).abs() < 1e-12));
        assert!(joint.tau_step_max_nm <= 1.0 + 1e-9 && joint.tau_limit_nm.is_some());
    }
    assert_eq!(study.limits(6), (Some(12.0), Some(1000.0)));
}
