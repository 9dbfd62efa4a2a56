//! A start that is held, and torque that is fed forward, against physics: an arm that is held by its own gravity stays where it is, and
//! one whose dynamics are known leaves nothing to estimate.
//! Wrong if a law took over another torque than the one that acts, or was told what it is fed at another instant.

use std::path::Path;

use phihat::{Form, JointGains, PositionDesign};
use phihat_sim::{Simulation, Trace};
use phihat_study::Study;

const ARM: &str = "duration_s = 0.5\n[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 0.001\nerror_max_rad = 1.0\n[design]\n";
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
                    "{ARM}[loop]\nrate_hz = 1000.0\ndelay_samples = {delay}\nform = \"{form}\"\ntorque_max_nm = \"none\"\n\
                     [sensor]\nencoder_bits = \"none\"\nvelocity = \"measured\"\n{BARE}{held}{REST}"
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
