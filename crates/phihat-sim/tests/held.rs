//! A start that is held, and torque that is fed forward, against physics: an arm that is held by its own
//! gravity stays where it is, and one whose dynamics are known leaves nothing to estimate.
//! Wrong if a law took over another torque than the one that acts, or received its feed-forward at another
//! instant.

use std::path::Path;

use phihat::{Form, JointGains, PositionDesign};
use phihat_sim::{Simulation, Trace};
use phihat_study::Study;

const ARM: &str = "duration_s = 0.5\n[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 0.001\nerror_bound_rad = \
    1.0\n[design]\n";
const REST: &str = "[reference]\nkind = \"hold\"\nq_rad = [0.4, -0.7, 0.9]\n";
const MOVES: &str = "[reference]\nkind = \"sines\"\ncenter_rad = [0.4, -0.7, 0.9]\nfade_in_s = 0.2\n\
                     [[reference.sine]]\namplitude_rad = [0.3, 0.4, 0.5]\nfrequency_hz = [0.7, 1.1, 0.9]\n";
/// Nothing acts but gravity, and every reading is exact.
const BARE: &str = "[world]\nfriction = \"none\"\n";

fn study(text: &str) -> Study {
    Study::from_text(text, "held.toml", Path::new(".")).unwrap()
}

/// A law by bandwidths, in a form.
fn gains(study: &Study) -> Vec<JointGains<f64>> {
    let period = study.control.period_ns as f64 * 1e-9;
    let law = |inertia: f64| match study.control.form {
        Form::Positions => {
            let x = (-200.0 * period).exp();
            let correction = [
                1.0 - x * x * x,
                1.5 * (1.0 - x) * (1.0 - x) * (1.0 + x) / period,
                -(1.0 - x) * (1.0 - x) * (1.0 - x) / (period * period),
            ];
            let design = PositionDesign {
                inertia,
                kp: 100.0,
                kd: 20.0,
                correction: &correction,
                velocity_correction: &[],
                share: 0.8,
                delay: study.control.delay_samples as usize,
                period,
            };
            JointGains::from_positions(&design).unwrap()
        }
        form => {
            let design =
                phihat::JointDesign { inertia, kp: 100.0, kd: 20.0, a: &[40.0], form, period };
            JointGains::new(&design).unwrap()
        }
    };
    [1.0, 0.5, 0.1].map(law).to_vec()
}

fn run(text: &str) -> Trace {
    let study = study(text);
    let outcome = Simulation::new(&study, &gains(&study)).unwrap().run(|_| ());
    assert!(outcome.divergence.is_none(), "{text}");
    outcome.trace
}

fn largest_error(trace: &Trace) -> f64 {
    let all = trace.joints.iter().flat_map(|joint| &joint.e);
    all.fold(0.0, |most, e| most.max(e.abs()))
}

#[test]
fn what_is_held_by_its_gravity_stays_where_it_is() {
    for form in ["observer", "literal", "positions"] {
        for delay in [0, 2] {
            let text = |held: &str| {
                format!(
                    "{ARM}[loop]\nrate_hz = 1000.0\ndelay_samples = {delay}\nform = \"{form}\"\ntorque_max_nm = \
                     \"none\"\n[sensor]\nencoder_bits = \"none\"\nvelocity = \"measured\"\n{BARE}{held}{REST}"
                )
            };
            let held = run(&text("[start]\ntorque_nm = \"gravity\"\n"));
            assert!(largest_error(&held) < 1e-9, "{form}, {delay}: {}", largest_error(&held));
            // The first command is the torque that held it, typed or found.
            let first: Vec<f64> = held.joints.iter().map(|joint| joint.tau_command[0]).collect();
            let typed = run(&text(&format!("[start]\ntorque_nm = {first:?}\n")));
            assert_eq!(typed, held, "{form}, {delay}");
            let fallen = run(&text(""));
            assert!(largest_error(&fallen) > 1e-4, "{form}, {delay}: it is let go");
        }
    }
}

#[test]
fn what_is_known_need_not_be_estimated() {
    let text = |fed: &str| {
        format!(
            "{ARM}[loop]\nrate_hz = 1000.0\ndelay_samples = 1\nform = \"positions\"\ntorque_max_nm = \"none\"\n\
             [sensor]\nencoder_bits = \"none\"\n{BARE}[start]\ntorque_nm = \"gravity\"\n{fed}{MOVES}"
        )
    };
    let error = |fed: &str| largest_error(&run(&text(fed)));
    let alone = error("");
    let whole = error("[feedforward]\nmodel = \"inverse_dynamics\"\n");
    let wrong = error("[feedforward]\nmodel = \"inverse_dynamics\"\nmass_scale = 0.8\n");
    // What is left of it is the torque's change within a sample.
    assert!(whole < 6e-3 * alone, "{whole} against {alone}");
    assert!((0.15..0.3).contains(&(wrong / alone)), "a fifth: {wrong} against {alone}");
    // Of what is fed at the instant of the sample, and not of the torque, a delay and a half are late.
    let late = largest_error(&run(&text("[feedforward]\nmodel = \"inverse_dynamics\"\n")
        .replace("form = \"positions\"", "form = \"positions\"\npreview = false")));
    assert!(late > 10.0 * whole, "{late} against {whole}");
}

/// Behind a supervisor that takes over what holds the arm.
fn supervised(fed: &str, more: &str) -> String {
    let rest = run(&format!(
        "{ARM}[loop]\nrate_hz = 1000.0\ntorque_max_nm = \"none\"\n[sensor]\nencoder_bits = \"none\"\nvelocity = \
         \"measured\"\n{BARE}[start]\ntorque_nm = \"gravity\"\n{REST}"
    ));
    let held: Vec<f64> = rest.joints.iter().map(|joint| joint.tau_command[0]).collect();
    format!(
        "{ARM}[loop]\nrate_hz = 1000.0\ndelay_samples = 0\nform = \"positions\"\ntorque_max_nm = \"none\"\n\
         torque_rate_max_nm_s = \"none\"\n[sensor]\nencoder_bits = \"none\"\n{BARE}{fed}[supervisor]\npreset_nm = \
         {held:?}\n{more}{MOVES}"
    )
}

const KNOWN: &str = "[feedforward]\nmodel = \"inverse_dynamics\"\n";

/// Largest step of torque up to a sample \[N·m\].
fn largest_step(trace: &Trace, samples: std::ops::Range<usize>) -> f64 {
    let steps = |joint: &phihat_sim::JointTrace| {
        let tau = joint.tau_command[samples.clone()].to_vec();
        tau.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max)
    };
    trace.joints.iter().map(steps).fold(0.0, f64::max)
}

#[test]
fn behind_a_supervisor_it_is_as_without() {
    let alone = largest_error(&run(&supervised("", "")));
    let whole = run(&supervised(KNOWN, ""));
    let wrong = run(&supervised(&format!("{KNOWN}mass_scale = 0.8\n"), ""));
    let (error, share) = (largest_error(&whole), largest_error(&wrong) / alone);
    println!("{error:.1e} of {alone:.1e} rad; a fifth: {share:.3}");
    assert!(error < 2e-2 * alone, "{error} against {alone}");
    assert!((0.15..0.3).contains(&share), "{share}");
    // An arm that is held stays where it is, whatever the description says.
    for mass_scale in [0.01, 0.8, 1.0, 10.0] {
        let fed = format!("{KNOWN}mass_scale = {mass_scale}\n");
        let trace = run(&supervised(&fed, "").replace(MOVES, REST));
        let (step, error) = (largest_step(&trace, 0..500), largest_error(&trace));
        assert!(step < 1e-9 && error < 1e-9, "{mass_scale}: {step} N·m, {error} rad");
    }
    // What is recorded as φ̂ is the whole: φ, to a sample's change of it.
    for joint in &whole.joints {
        for k in 100..whole.joints[0].q.len() {
            let [phi, estimate] = [joint.phi[k], joint.phi_hat[k]];
            assert!((phi - estimate).abs() < 0.2, "{k}: {phi}, {estimate}");
        }
    }
}

#[test]
fn what_is_fed_is_of_the_reference_in_force() {
    // Shaped to a third of the motion's speed, the arm is away from the requested reference; and it is
    // commanded to stop and go on.
    let shaped = "reference_velocity_max_rad_s = 0.6\nreference_acceleration_max_rad_s2 = 4.0\n\
                  reference_jerk_max_rad_s3 = 80.0\n";
    let request =
        |t: f64, mode: &str| format!("[[supervisor.request]]\nt_s = {t}\nmode = \"{mode}\"\n");
    let steps = [(0.0, "arm"), (0.01, "hold"), (0.02, "track"), (0.25, "hold"), (0.35, "track")];
    let stops: String = steps.iter().map(|(t, mode)| request(*t, mode)).collect();
    let stops = format!("blend_s = 0.05\nstart_mismatch_max_rad = 1.0\n{stops}");
    let lost = format!("{stops}[world.network]\nsample_loss = 0.05\n");
    for (what, more) in [("shaped", shaped), ("stops", &stops), ("lost", &lost)] {
        let [alone, whole, wrong] = ["", KNOWN, &format!("{KNOWN}mass_scale = 0.8\n")]
            .map(|fed| run(&supervised(fed, more)));
        let asked = largest_step(&alone, 0..500);
        let [none, all, part] = [&alone, &whole, &wrong].map(largest_error);
        let (step, of_wrong) = (largest_step(&whole, 0..500), largest_step(&wrong, 0..500));
        println!(
            "{what}: {all:.1e}, {part:.1e} of {none:.1e} rad; {step:.3}, {of_wrong:.3} for {asked:.3} N·m"
        );
        assert!(all < 0.25 * none && part < 0.5 * none, "{what}: {all} {part} {none}");
        assert!(step < 2.0 * asked + 0.1 && of_wrong < 2.0 * asked + 0.1, "{what}: {step} {asked}");
    }
}

/// Positions that are sent while the arm moves: what is fed is of the way there, not of where it ends.
#[test]
fn on_the_way_to_a_position_that_is_told_what_is_known_is_fed_too() {
    let shaped = "reference_velocity_max_rad_s = 2.0\nreference_acceleration_max_rad_s2 = 10.0\n\
                  reference_jerk_max_rad_s3 = 400.0\n";
    let led = |fed: &str| {
        let study = study(&supervised(fed, shaped));
        let (mut control, mut world) = Simulation::new(&study, &gains(&study)).unwrap().apart();
        let mut tau = vec![0.0; 3];
        let (mut error, mut step, mut k) = (0.0_f64, 0.0_f64, 0);
        while let Some(sensed) = world.sense() {
            if k == 100 {
                assert!(control.refer_to(&[0.2, -0.2, 0.4]));
            }
            control.step(sensed.t_ns as f64 * 1e-9, sensed.sample, sensed.runs);
            let q = &sensed.sample.joints;
            for ((tau, command), (wanted, m)) in
                tau.iter_mut().zip(control.commands()).zip(control.references().iter().zip(q))
            {
                if k > 1 {
                    step = step.max((command.tau - *tau).abs());
                }
                if k > 100 {
                    error = error.max((m.q - wanted.q).abs());
                }
                *tau = command.tau;
            }
            world.act(&tau);
            k += 1;
        }
        (error, step)
    };
    let (alone, whole) = (led(""), led(KNOWN));
    println!("{whole:?} for {alone:?}");
    assert!(whole.0 < 0.2 * alone.0 && whole.1 < 2.0 * alone.1 + 0.1, "{whole:?} {alone:?}");
}

/// Gravity that a robot adds by itself is in no other feed-forward.
#[test]
fn what_the_robot_adds_is_not_fed() {
    let text = |fed: &str| {
        format!(
            "{ARM}[loop]\nrate_hz = 1000.0\nform = \"positions\"\ntorque_max_nm = \"none\"\n[sensor]\nencoder_bits = \
             \"none\"\n{BARE}[profile]\nname = \"robot\"\nadds_gravity = true\n[start]\ntorque_nm = \
             \"gravity\"\n{fed}{MOVES}"
        )
    };
    let alone = largest_error(&run(&text("")));
    let whole = largest_error(&run(&text(KNOWN)));
    assert!(whole < 0.02 * alone, "{whole} against {alone}");
    assert_eq!(run(&text("[feedforward]\nmodel = \"gravity\"\n")), run(&text("")));
}
