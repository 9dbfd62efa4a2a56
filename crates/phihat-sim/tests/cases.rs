//! Stops that went wrong once, each with its whole kind. Wrong if a push is held against the arm, if a drive
//! that is wired the wrong way round drives on, if an arm without brakes sinks once it is stopped, if a joint
//! that turns without end runs away where its encoder starts over, or if an arm that never moved is within
//! its specification.

use std::fs;
use std::path::Path;

use phihat::{Fault, Form, JointDesign, JointGains, Mode};
use phihat_sim::{Metrics, Simulation, SimulationOutcome};
use phihat_study::Study;

const PLANAR: &str = "[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 1.5\nerror_bound_rad = 2e-3\n[gains]\norder = \
    1\nbandwidth_rad_s = 20.0\nestimator_bandwidth_rad_s = 70.0\ninertia_kg_m2 = [0.42, 0.18, 0.14]\n[loop]\nrate_hz = \
    1000.0\ndelay_samples = 1\n[sensor]\nencoder_bits = 18\nvelocity = \"differenced\"\n[world]\ngravity_m_s2 = [0.0, \
    0.0, 0.0]\nfriction = \"robot\"\npayload = { mass_kg = 0.3 }\n";

const PANDA: &str = "[robot]\nname = \"panda\"\n[spec]\nsettle_s = 1.0\nerror_bound_rad = 3e-3\n[gains]\norder = 2\n\
    bandwidth_rad_s = 20.0\nestimator_bandwidth_rad_s = 50.0\ninertia_kg_m2 = [1.78, 2.22, 1.02, 1.28, 0.247, 0.259, \
    0.212]\n[loop]\nrate_hz = 1000.0\ndelay_samples = 1\n[sensor]\nencoder_bits = 18\nvelocity = \
    \"differenced\"\nvelocity_filter_hz = 45.0\n";

const SINES: &str = "[reference]\nkind = \"sines\"\ncenter = \"ready\"\nfade_in_s = \
    0.5\n[[reference.sine]]\namplitude_rad = 0.2\nfrequency_hz = 0.3\n";

fn study(text: &str) -> Study {
    Study::from_text(text, "test.toml", Path::new(env!("CARGO_TARGET_TMPDIR")))
        .unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn run(study: &Study, a: &[f64]) -> SimulationOutcome {
    let joint = |inertia: &f64| {
        let design = JointDesign {
            inertia: *inertia,
            kp: 400.0,
            kd: 40.0,
            a,
            period: 1e-3,
            form: Form::Observer,
        };
        JointGains::new(&design).unwrap()
    };
    let gains: Vec<_> = study.gains.as_ref().unwrap().inertia.iter().map(joint).collect();
    Simulation::new(study, &gains).unwrap().run(|_| ())
}

fn stopped(outcome: &SimulationOutcome) -> (usize, Option<Fault>) {
    let s = outcome.trace.supervision.as_ref().unwrap();
    let at = s.mode.iter().position(|mode| *mode == Mode::SafeStop).unwrap();
    (at, s.fault[at])
}

fn speed(outcome: &SimulationOutcome, k: usize) -> f64 {
    outcome.trace.joints.iter().fold(0.0, |most, joint| joint.dq[k].abs().max(most))
}

/// It stopped after 44 ms and held the push against the arm: 26.6 rad, 10.3 rad/s; with a limit of the speed 94 rad/s.
#[test]
fn a_stop_after_a_push_does_not_throw_the_arm() {
    for more in ["", "velocity_max_rad_s = 1.5\n"] {
        for torque in [40.0, -40.0] {
            let push = format!(
                "[[world.push]]\njoint = \"joint2\"\ntorque_nm = {torque:?}\nstart_s = 2.0\nduration_s = 0.15\n"
            );
            let text = format!(
                "duration_s = 4.0\n{PLANAR}{push}[supervisor]\nerror_stop_rad = 0.05\n{more}{SINES}"
            );
            let outcome = run(&study(&text), &[70.0]);
            let (at, fault) = stopped(&outcome);
            assert!(matches!(fault, Some(Fault::TrackingError | Fault::Overspeed)), "{fault:?}");
            let fastest = (at..4000).map(|k| speed(&outcome, k)).fold(0.0, f64::max);
            // The push goes on after the stop.
            assert!(fastest < 6.0, "{fastest} rad/s, {} at the stop", speed(&outcome, at));
            assert!(speed(&outcome, 3999) < 0.02, "it rests: {}", speed(&outcome, 3999));
            let travel = outcome.trace.joints.iter().map(|j| (j.q[3999] - j.q[at]).abs());
            assert!(travel.fold(0.0, f64::max) < 0.6);
        }
    }
}

/// Measurements one joint off: a damper on the velocities of other joints drove the arm, 14 rad in half a second.
#[test]
fn measurements_in_another_order_do_not_throw_the_arm() {
    for (duration, brakes) in [(0.005, ""), (0.5, ""), (20.0, ""), (0.5, "brake_closing_s = 0.1\n")]
    {
        let fault = format!(
            "[[fault]]\nkind = \"joint_order\"\nsize = 1.0\nstart_s = 2.0\nduration_s = {duration:?}\n"
        );
        let text = format!(
            "duration_s = 12.0\n{PANDA}[world]\nfriction = \"robot\"\n[profile]\nname = \
                \"franka\"\n[supervisor]\n{brakes}{fault}{SINES}"
        );
        let outcome = run(&study(&text), &[2500.0, 100.0]);
        let (at, fault) = stopped(&outcome);
        assert!(at < 2010 && fault == Some(Fault::BadSample), "{at} {fault:?}");
        let travel = outcome.trace.joints.iter().map(|j| (j.q[11_999] - j.q[at]).abs());
        let travel = travel.fold(0.0, f64::max);
        let fastest = (at..12_000).map(|k| speed(&outcome, k)).fold(0.0, f64::max);
        println!("{duration} s, {brakes:?}: {travel:.3} rad, {fastest:.3} rad/s");
        // Without brakes and without measurements it coasts, as fast as it was; else it rests.
        let coasts = brakes.is_empty() && duration > 0.1;
        assert!(fastest < 0.6, "{duration} {brakes}: {fastest} rad/s");
        assert!(coasts || travel < 0.05, "{duration} {brakes}: {travel} rad");
        assert!(coasts || speed(&outcome, 11_999) < 0.01, "{duration} {brakes}: it still moves");
    }
}

/// -98 rad/s at full torque, never stopped: `[supervisor]` at its defaults.
#[test]
fn a_drive_that_is_wired_the_wrong_way_round_is_stopped_by_default() {
    for joint in ["panda_joint1", "panda_joint4", "panda_joint5", "panda_joint7"] {
        let fault = format!(
            "[[fault]]\nkind = \"drive_gain\"\njoint = \"{joint}\"\nsize = -1.0\nstart_s = 0.0\n"
        );
        let text = format!(
            "duration_s = 1.5\n{PANDA}[world]\ngravity_m_s2 = [0.0, 0.0, 0.0]\n[supervisor]\n{fault}{SINES}"
        );
        let outcome = run(&study(&text), &[2500.0, 100.0]);
        let (at, _) = stopped(&outcome);
        assert!(at < 700, "{joint}: {at}");
        let i = outcome.trace.joints.iter().position(|j| j.name == joint).unwrap();
        let own = &outcome.trace.joints[i];
        let fastest = own.dq.iter().fold(0.0_f64, |most, dq| dq.abs().max(most));
        assert!(fastest < 4.0, "{joint}: {fastest} rad/s");
    }
}

/// The tip sank by 1.2 m.
#[test]
fn an_arm_without_brakes_is_held_where_it_was_stopped() {
    let requests = [(0.0, "arm"), (0.01, "hold"), (0.1, "track"), (2.0, "stop")]
        .map(|(t, mode)| format!("[[supervisor.request]]\nt_s = {t:?}\nmode = \"{mode}\"\n"));
    let text = format!(
        "duration_s = 7.0\n{PANDA}[world]\npayload = {{ frame = \"panda_link8\", mass_kg = 0.5, com_m = [0.0, 0.0, \
         0.05] }}\n[supervisor]\npreset_nm = [0.0, -4.2, -0.6, 22.0, 0.6, 2.2, 0.0]\n{}{SINES}",
        requests.concat()
    );
    let outcome = run(&study(&text), &[2500.0, 100.0]);
    assert_eq!(stopped(&outcome), (2000, None));
    for joint in &outcome.trace.joints {
        // Half a second later it stands.
        let (stands, end) = (joint.q[2500], joint.q[6999]);
        assert!((end - stands).abs() < 2e-3, "{}: {stands} to {end}", joint.name);
    }
}

const AXIS: &str = r#"<robot name="axis"><link name="base"/>
<joint name="axis" type="continuous"><parent link="base"/><child link="load"/><axis xyz="0 0 1"/>
<limit effort="40" velocity="4"/></joint>
<link name="load"><inertial><mass value="2"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.3"/>
</inertial></link></robot>"#;

/// It stopped at the wrap with a supervisor, and was 200 rad away without one that limits its speed.
#[test]
fn a_joint_without_ends_is_tracked_through_its_wrap() {
    fs::write(Path::new(env!("CARGO_TARGET_TMPDIR")).join("axis.urdf"), AXIS).unwrap();
    for supervisor in ["", "[supervisor]\n", "[supervisor]\nvelocity_max_rad_s = 10.0\n"] {
        for center in [2.8, -3.0, 9.0] {
            let text = format!(
                "duration_s = 6.0\n[robot]\nfile = \"axis.urdf\"\n[spec]\nsettle_s = 1.5\nerror_bound_rad = \
                 3e-3\n[gains]\norder = 1\nbandwidth_rad_s = 20.0\nestimator_bandwidth_rad_s = 70.0\ninertia_kg_m2 = \
                 0.35\n[loop]\nrate_hz = 1000.0\ndelay_samples = 1\n[sensor]\nencoder_bits = 18\nvelocity = \
                 \"differenced\"\nvelocity_filter_hz = 100.0\nwrap = true\n{supervisor}[reference]\nkind = \
                 \"sines\"\ncenter_rad = {center:?}\n[[reference.sine]]\namplitude_rad = 1.5\nfrequency_hz = 0.2\n"
            );
            let outcome = run(&study(&text), &[70.0]);
            let most =
                outcome.trace.joints[0].e[1500..].iter().fold(0.0_f64, |most, e| e.abs().max(most));
            assert!(most < 3e-3, "{supervisor:?} about {center}: {most} rad");
        }
    }
}

/// "Within spec on all 7 joints", exit 0.
#[test]
fn an_arm_that_was_never_let_go_is_not_within_its_specification() {
    let text = format!(
        "duration_s = 3.0\n{PANDA}[profile]\nname = \"robot\"\n[supervisor]\nreference_velocity_max_rad_s = \
         1.0\nreference_acceleration_max_rad_s2 = 3.0\nreference_jerk_max_rad_s3 = 30.0\n[start]\npose = \
         \"ready\"\n[reference]\nkind = \"hold\"\nq_rad = [0.8, -0.3, 0.4, -1.6, 0.2, 1.8, 0.5]\n"
    );
    let study = study(&text);
    let outcome = run(&study, &[2500.0, 100.0]);
    let metrics = Metrics::of(&outcome.trace, &study);
    assert!(metrics.untracked_steady_samples > 0 && !metrics.within_spec, "{metrics:?}");
}
