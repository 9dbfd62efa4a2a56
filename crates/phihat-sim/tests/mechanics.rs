//! Mechanics of a joint: stiction, springs, stops, walls, loads, each against its closed form. Wrong if one
//! had another size, sign or place than its key says, or left a mark where it is absent.

use crate::support::{ROD_INERTIA, gains, read, rod_study, run};
use phihat_sim::{Simulation, SimulationOutcome};

const G: f64 = 9.81;
const HOLD: &str = "[reference]\nkind = \"hold\"\nq_rad = 0.3\n";
const FLAT: &str = "[world]\ngravity_m_s2 = [0.0, 0.0, 0.0]\n";
/// Nobody drives: only the world moves the rod.
const DEAD: &str = "[world.drive]\ngain = 0.0\n";

fn last(values: &[f64]) -> f64 {
    values[values.len() - 1]
}

/// The rod behind a rotor of 0.5 kg·m².
fn geared(rest: &str) -> phihat_study::Study {
    read(&format!(
        "duration_s = 1.0\n[robot]\nfile = \"geared.toml\"\n[gains]\nbandwidth_rad_s = 20.0\n\
         estimator_bandwidth_rad_s = 70.0\ninertia_kg_m2 = 1.02\n[spec]\nsettle_s = 0.5\n{rest}"
    ))
}

fn push(torque: f64) -> String {
    format!(
        "[[world.push]]\njoint = \"hinge\"\ntorque_nm = {torque}\nstart_s = 0.0\nduration_s = 10.0\n"
    )
}

#[test]
fn what_is_not_met_leaves_every_bit_as_it_is() {
    let plain = run(&rod_study("duration_s = 1.0", &format!("[start]\nq_rad = 0.31\n{HOLD}")));
    let absent = [
        "[world]\nfriction_cold_factor = 1.0\n",
        "[world.stiction]\nbreakaway_ratio = 2.0\n",
        "[world.end_stops]\nstiffness_nm_rad = 1e5\n",
        "[[world.wall]]\npoint_m = [0.0, 0.0, -5.0]\nnormal = [0.0, 0.0, 1.0]\nstiffness_n_m = 1e5\n",
        "[[world.push]]\nforce_n = [0.0, 0.0, 0.0]\nstart_s = 0.1\nduration_s = 0.2\n",
        "[sensor]\nencoder_at = \"motor\"\n",
        "[world]\npayload = { mass_kg = 3.0, start_s = 2.0 }\n",
    ];
    for text in absent {
        let outcome =
            run(&rod_study("duration_s = 1.0", &format!("{text}[start]\nq_rad = 0.31\n{HOLD}")));
        assert_eq!(outcome, plain, "{text}");
    }
}

#[test]
fn below_breakaway_a_joint_sticks_and_above_it_slides_at_the_coulomb_level() {
    let pushed = |torque: f64| -> SimulationOutcome {
        // In small steps: a joint that is hit breaks away earlier.
        let step = |k: u32| {
            let start = 0.05 * f64::from(k);
            push(torque / 20.0).replace("start_s = 0.0", &format!("start_s = {start}"))
        };
        let pushes: String = (0..20).map(step).collect();
        let world = format!("{FLAT}coulomb_extra_nm = 1.0\nsubsteps = 4\n{DEAD}{pushes}");
        let stiction = "[world.stiction]\nbreakaway_ratio = 1.5\nstribeck_velocity_rad_s = 0.05\n\
                        stiffness_nm_rad = 2000.0\ndamping_nm_s_rad = 20.0\n";
        run(&rod_study("duration_s = 8.0", &format!("{world}{stiction}{HOLD}")))
    };
    for torque in [0.5, -0.9, 1.25] {
        let joint = &pushed(torque).trace.joints[0];
        // It gives way by about τ/σ_0, then rests: nothing creeps in a second.
        let gave = (last(&joint.q) - 0.3) / (torque / 2000.0);
        assert!((0.99..10.0).contains(&gave), "{torque}: {gave}");
        assert!((last(&joint.q) - joint.q[7000]).abs() < 1e-9 && last(&joint.dq).abs() < 1e-9);
    }
    let joint = &pushed(1.6).trace.joints[0];
    let k = joint.dq.iter().position(|v| *v > 1.0).unwrap();
    assert!((joint.ddq[k] - (1.6 - 1.0) / ROD_INERTIA).abs() < 1e-6, "{}", joint.ddq[k]);
}

#[test]
fn bristles_agree_with_their_equation_solved_finely() {
    // A push that swings: sticks, breaks away, reverses. The oracle is plain Euler at 2 µs.
    let swing = |k: usize| {
        format!(
            "[[world.push]]\njoint = \"hinge\"\ntorque_nm = {}\nstart_s = {}\nduration_s = 0.125\n",
            if k.is_multiple_of(2) { 2.5 } else { -2.5 },
            0.125 * k as f64
        )
    };
    let world = format!("{FLAT}coulomb_extra_nm = 1.0\nsubsteps = 8\n{DEAD}");
    let pushes: String = (0..8).map(swing).collect();
    let stiction = "[world.stiction]\nbreakaway_ratio = 1.5\nstribeck_velocity_rad_s = 0.05\n\
                    stiffness_nm_rad = 2000.0\ndamping_nm_s_rad = 20.0\n";
    let text = format!("{world}{pushes}{stiction}{HOLD}");
    let joint = &run(&rod_study("duration_s = 1.0", &text)).trace.joints[0];
    let (mut q, mut v, mut z, h) = (0.3, 0.0_f64, 0.0, 2e-6);
    let mut worst = 0.0_f64;
    for k in 0..500_000_usize {
        if k.is_multiple_of(500) {
            worst = worst.max((joint.q[k / 500] - q).abs());
        }
        let level = 1.0 + 0.5 * (-(v / 0.05).powi(2)).exp();
        let slip = v - 2000.0 * v.abs() / level * z;
        let torque = if (k / 62_500).is_multiple_of(2) { 2.5 } else { -2.5 };
        q += h * v;
        v += h * (torque - 2000.0 * z - 20.0 * slip) / ROD_INERTIA;
        z += h * slip;
    }
    let travel = joint.q.iter().fold(0.0_f64, |most, q| most.max((q - 0.3).abs()));
    assert!(travel > 5e-3 && worst < 1e-3 * travel, "travel {travel}, off by {worst}");
}

#[test]
fn friction_of_a_cold_joint_falls_as_it_warms_up() {
    let world = format!(
        "{FLAT}viscous_extra_nm_s_rad = 0.5\nfriction_cold_factor = 3.0\nfriction_warm_up_s = 0.4\n"
    );
    let motion = "[reference]\nkind = \"sines\"\ncenter_rad = 0.0\n[[reference.sine]]\n\
                  amplitude_rad = 1.0\nfrequency_hz = 0.5\n";
    let joint = &run(&rod_study("duration_s = 1.0", &format!("{world}{motion}"))).trace.joints[0];
    for k in [100, 400, 900] {
        let viscous = 0.5 * (1.0 + 2.0 * (-(k as f64) * 1e-3 / 0.4).exp());
        assert!((joint.phi[k] - viscous * joint.dq[k]).abs() < 1e-9, "sample {k}");
    }
}

#[test]
fn two_masses_ring_at_their_frequency() {
    let world = format!(
        "{FLAT}substeps = 4\n[world.flexibility]\nstiffness_nm_rad = 800.0\n{DEAD}{}",
        push(2.0)
    );
    let joint = &run(&geared(&format!("{world}{HOLD}"))).trace.joints[0];
    // x = θ − q: ẍ = −ω²x − τ/J, ω² = k(1/B + 1/J); q̈ = (τ + kx)/J.
    let rate = (800.0_f64 * (1.0 / 0.5 + 1.0 / ROD_INERTIA)).sqrt();
    for k in 0..1000 {
        let t = k as f64 * 1e-3;
        let twist = -2.0 / (ROD_INERTIA * rate * rate) * (1.0 - (rate * t).cos());
        let expected = (2.0 + 800.0 * twist) / ROD_INERTIA;
        assert!((joint.ddq[k] - expected).abs() < 1e-3, "sample {k}: {} {expected}", joint.ddq[k]);
    }
}

#[test]
fn an_encoder_on_the_motor_does_not_see_the_twist() {
    let world = "[world]\nsubsteps = 2\n[world.flexibility]\nstiffness_nm_rad = 2000.0\ndamping_nm_s_rad = 20.0\n";
    let study = geared(&format!("{world}[sensor]\nencoder_at = \"motor\"\n{HOLD}"));
    let mut study = study;
    study.duration = 4.0;
    let joint = &run(&study).trace.joints[0];
    // At rest the spring carries the weight −m g l cos q: the motor is ahead by −weight/k.
    let weight = -2.0 * 0.5 * G * last(&joint.q).cos();
    assert!((last(&joint.q_measured) - 0.3).abs() < 1e-6);
    assert!((last(&joint.q_measured) - last(&joint.q) - weight / 2000.0).abs() < 1e-6);
}

#[test]
fn f24_a_joint_on_a_spring_is_stable_from_eight_to_a_hundred_hertz() {
    // The measurement on the motor, as on most arms; the loop as slow as the softest spring asks for.
    for hz in [8.0, 15.0, 30.0, 60.0, 100.0] {
        let rate = core::f64::consts::TAU * hz;
        let stiffness = rate * rate / (1.0 / 0.5 + 1.0 / ROD_INERTIA);
        let world = format!(
            "[world]\nsubsteps = 2\n[world.flexibility]\nstiffness_nm_rad = {stiffness}\ndamping_nm_s_rad = {}\n",
            0.02 * rate * 0.255
        );
        let study = geared(&format!(
            "{world}[sensor]\nencoder_at = \"motor\"\n[loop]\ndelay_samples = 1\n[start]\nq_rad = 0.31\n{HOLD}"
        ));
        let mut study = study;
        study.duration = 6.0;
        let outcome = run(&study);
        let joint = &outcome.trace.joints[0];
        let swing =
            |from: usize| joint.dq[from..from + 1000].iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let (early, late) = (swing(1000), swing(5000));
        assert!(outcome.divergence.is_none(), "{hz} Hz");
        assert!(
            late < 0.7 * early || late < 1e-6,
            "{hz} Hz does not ring down: {early} {late} rad/s"
        );
    }
}

#[test]
fn a_joint_rests_in_its_end_stop_by_force_over_stiffness() {
    let stops = "[world.end_stops]\nstiffness_nm_rad = 5000.0\ndamping_nm_s_rad = 50.0\n";
    let world = format!("{FLAT}substeps = 4\n{DEAD}{}{stops}", push(5.0));
    let start = "[start]\nq_rad = 2.9\n[reference]\nkind = \"hold\"\nq_rad = 2.9\n";
    let joint = &run(&rod_study("duration_s = 4.0", &format!("{world}{start}"))).trace.joints[0];
    assert!((last(&joint.q) - 3.0 - 5.0 / 5000.0).abs() < 1e-9, "{}", last(&joint.q));
}

#[test]
fn a_tip_rests_on_a_wall_by_force_over_stiffness() {
    let wall = "[[world.wall]]\npoint_m = [0.3, 0.0, -0.4]\nnormal = [0.0, 0.0, 2.0]\nstiffness_n_m = 1e5\n\
                damping_n_s_m = 500.0\n";
    let world = format!("[world]\nsubsteps = 8\n{wall}{DEAD}");
    let joint = &run(&rod_study("duration_s = 3.0", &format!("{world}{HOLD}"))).trace.joints[0];
    // The weight m g at half the length asks for half of it at the tip.
    let depth = 2.0 * 0.5 * G / 1e5;
    assert!((last(&joint.q).sin() - (0.4 + depth)).abs() < 1e-9, "{}", last(&joint.q).sin());
}

#[test]
fn a_force_at_the_tool_is_felt_by_its_lever() {
    let force = "[[world.push]]\nforce_n = [3.0, 5.0, -7.0]\nframe = \"tool\"\nstart_s = 0.5\nduration_s = 9.0\n";
    let joint =
        &run(&rod_study("duration_s = 3.0", &format!("[world]\n{force}{HOLD}"))).trace.joints[0];
    // About +y, at r = (cos q, 0, −sin q): r_z F_x − r_x F_z.
    let torque = -0.3_f64.sin() * 3.0 + 0.3_f64.cos() * 7.0;
    let weight = 2.0 * 0.5 * G * 0.3_f64.cos();
    assert!(
        (last(&joint.tau_applied) + torque + weight).abs() < 1e-5,
        "{}",
        last(&joint.tau_applied)
    );
}

#[test]
fn a_payload_has_its_time() {
    let window = "payload = { mass_kg = 0.7, start_s = 1.0, end_s = 2.0 }\n";
    let one = run(&rod_study("duration_s = 3.0", &format!("[world]\n{window}{HOLD}")));
    let fault = "[[fault]]\nkind = \"payload\"\nstart_s = 1.0\nduration_s = 1.0\nsize = 0.7\n";
    assert_eq!(one.trace, run(&rod_study("duration_s = 3.0", &format!("{fault}{HOLD}"))).trace);
    let weight = |mass: f64| -(2.0 * 0.5 + mass) * G * 0.3_f64.cos();
    for (k, mass) in [(990, 0.0), (1990, 0.7), (2990, 0.0)] {
        assert!((one.trace.joints[0].tau_applied[k] - weight(mass)).abs() < 1e-4);
    }
}

#[test]
fn what_is_too_stiff_for_the_step_is_refused_with_the_step_it_needs() {
    let why = |study: &phihat_study::Study| {
        Simulation::new(study, &gains(study)).unwrap_err().to_string()
    };
    let flexible = geared(&format!("[world.flexibility]\nstiffness_nm_rad = 4e6\n{HOLD}"));
    // √(k(1/B + 1/J)) T/2 = 1.98.
    assert!(why(&flexible).contains("2 or more"), "{}", why(&flexible));
    let wall = "[[world.wall]]\npoint_m = [0.0, 0.0, -0.4]\nnormal = [0.0, 0.0, 1.0]\nstiffness_n_m = 1e8\n";
    let walled = rod_study("duration_s = 1.0", &format!("{wall}{HOLD}"));
    // √(k cos²q/J) T/2 = 6.6 at a lever of cos 0.3.
    assert!(why(&walled).contains("7 or more"), "{}", why(&walled));
}
