//! Torque and speed that a motion needs of the drives, against a pendulum's closed form and the torque of a
//! run. Wrong if a need, an instant, a limit or the factor to a slower motion were another, or if a shipped
//! study needed more than its drives have.

use std::f64::consts::TAU;
use std::path::Path;

use crate::support::{ROD_INERTIA, rod_study, run};
use phihat_sim::{Lack, Overload, overload};
use phihat_study::Study;

const G: f64 = 9.81;
/// Amplitude \[rad\], frequency \[Hz\] of the motion about hanging at an angle \[rad\].
const A: f64 = 0.4;
const F: f64 = 1.5;
const ANGLE: f64 = 0.3;
const DRY: f64 = 0.3;

/// A swing `slower` times slower, under a torque limit \[N·m\]; `rest` goes into the file.
fn swing(limit: f64, slower: f64, rest: &str) -> Study {
    let (duration, f) = (2.0 * slower, F / slower);
    rod_study(
        &format!("duration_s = {duration:?}"),
        &format!(
            "[loop]\ntorque_max_nm = {limit:?}\n[world]\ncoulomb_extra_nm = {DRY}\nsubsteps = 4\n[reference]\nkind = \
             \"sines\"\ncenter_rad = {ANGLE}\nfade_in_s = 0.0\n[[reference.sine]]\namplitude_rad = {A}\nfrequency_hz = \
             {f:?}\nphase_rad = 0.0\n{rest}"
        ),
    )
}

/// Torque \[N·m\] of the rod of 2 kg at 0.5 m with a point mass at 1 m, by hand: its largest value, and when,
/// on a fine grid.
fn by_hand(mass: f64, slower: f64) -> (f64, f64) {
    let (w, inertia) = (TAU * F / slower, ROD_INERTIA + mass);
    let at = |t: f64| {
        let (q, ddq) = (ANGLE + A * (w * t).sin(), -A * w * w * (w * t).sin());
        let dq = A * w * (w * t).cos();
        // Positive angles turn +x towards −z.
        let dry = DRY * dq / dq.hypot(1e-3);
        (inertia * ddq - (2.0 * 0.5 + mass) * G * q.cos() + dry).abs()
    };
    let grid = (0..200_000).map(|k| f64::from(k) * 1e-5 * slower);
    grid.map(|t| (at(t), t)).fold((0.0, 0.0), |most, now| if now.0 > most.0 { now } else { most })
}

fn found(study: &Study) -> Overload {
    overload(study).unwrap().unwrap()
}

#[test]
fn a_pendulum_needs_what_its_equation_says() {
    let (need, _) = by_hand(0.0, 1.0);
    assert!(overload(&swing(need * 1.001, 1.0, "")).unwrap().is_none());
    let more = found(&swing(need * 0.999, 1.0, ""));
    assert_eq!((more.joint.as_str(), more.lack), ("hinge", Lack::Torque));
    assert!((more.need - need).abs() < 1e-4 * need, "{} {need}", more.need);
    // At its own instant the equation gives the need too.
    let w = TAU * F;
    let (q, ddq) = (ANGLE + A * (w * more.t).sin(), -A * w * w * (w * more.t).sin());
    let there = (ROD_INERTIA * ddq - G * q.cos()).abs();
    assert!((there - need).abs() < DRY * 1.001, "t = {}: {there} {need}", more.t);
}

#[test]
fn each_end_of_the_payload_counts() {
    // The point mass at the tool, 1 m from the hinge; none in the world.
    let design = "[design]\npayload_kg = [0.0, 0.6]\n";
    let ((bare, _), (heavy, _)) = (by_hand(0.0, 1.0), by_hand(0.6, 1.0));
    let more = found(&swing(0.5 * (bare + heavy), 1.0, design));
    assert!((more.need - heavy).abs() < 1e-4 * heavy, "{} {heavy}", more.need);
    assert!((more.payload_kg - 0.6).abs() < 1e-12);
    assert!(overload(&swing(0.5 * (bare + heavy), 1.0, "")).unwrap().is_none());
}

#[test]
fn the_factor_is_the_one_of_the_equation_and_the_slower_motion_is_borne() {
    // Gravity and friction stay as the motion gets slower: below what they need no factor helps.
    let held = by_hand(0.0, 100.0).0;
    let limit = 0.5 * (held + by_hand(0.0, 1.0).0);
    let slower = found(&swing(limit, 1.0, "")).slower.unwrap();
    assert!(by_hand(0.0, slower).0 <= limit * 1.0001);
    assert!(by_hand(0.0, slower - 0.02).0 > limit, "{slower}");
    // The study that the advice describes.
    assert!(overload(&swing(limit, slower, "")).unwrap().is_none());
    assert!(overload(&swing(limit, slower - 0.02, "")).unwrap().is_some());
    let heavy = found(&swing(0.9 * held, 1.0, ""));
    assert_eq!(heavy.slower, None);
    assert!(heavy.to_string().contains("no slower motion helps"), "{heavy}");
}

#[test]
fn a_run_needs_the_torque_that_was_told_before() {
    let (need, _) = by_hand(0.0, 1.0);
    let more = found(&swing(0.9 * need, 1.0, ""));
    // Without a limit the arm follows, but for the start at full speed, which the record shows as a transient.
    let free = swing(1e4, 1.0, "");
    let joint = &run(&free).trace.joints[0];
    let steady = joint.tau_applied.iter().skip(500).fold(0.0_f64, |most, tau| most.max(tau.abs()));
    assert!((steady - more.need).abs() < 0.02 * need, "{steady} {}", more.need);
    // With the limit it is reached.
    let held = run(&swing(0.9 * need, 1.0, "")).trace;
    assert!(held.joints[0].saturated.iter().skip(500).any(|limited| *limited));
}

#[test]
fn a_joint_that_would_be_too_fast_is_told_with_its_speed() {
    // Sines are looked at as the file is read; what inverse kinematics makes of a curve is not.
    let text = "duration_s = 4.0\n[robot]\nname = \"panda\"\n[spec]\nsettle_s = 1.0\nerror_bound_rad = \
                1e-3\n[design]\n[loop]\ntorque_max_nm = \"none\"\n[reference]\nkind = \"circle\"\ncenter_m = [0.45, \
                0.0, 0.45]\nradius_m = 0.12\nperiod_s = 0.35\nseed = \"ready\"\n";
    let study = crate::support::read(text);
    let more = found(&study);
    let motion = phihat_sim::Motion::new(&study.reference, &study.robot, study.duration).unwrap();
    let speed = |i: usize, t: f64| motion.at(i, t)[1].abs();
    let i = study.robot.joints.iter().position(|joint| joint.name == more.joint).unwrap();
    assert_eq!(more.lack, Lack::Speed);
    assert!((speed(i, more.t) - more.need).abs() < 1e-9);
    let most = study.robot.joints[i].velocity_max.unwrap();
    assert_eq!(more.limit.to_bits(), most.to_bits());
    let all = (0..4000).map(|k| speed(i, f64::from(k) * 1e-3)).fold(0.0, f64::max);
    assert!((all - more.need).abs() < 1e-9 && all > most);
    let slower = crate::support::read(
        &text
            .replace("period_s = 0.35", &format!("period_s = {}", 0.35 * more.slower.unwrap()))
            .replace("seed =", &format!("fade_in_s = {}\nseed =", more.slower.unwrap()))
            .replace("duration_s = 4.0", &format!("duration_s = {}", 4.0 * more.slower.unwrap())),
    );
    assert!(overload(&slower).unwrap().is_none());
}

#[test]
fn a_study_may_be_about_drives_that_saturate() {
    let (need, _) = by_hand(0.0, 1.0);
    let study = swing(0.5 * need, 1.0, "");
    let text = study.text.replace("[loop]", "[loop]\nbeyond_drives = \"allow\"");
    let more = found(&study).to_string();
    assert!(more.contains("loop.beyond_drives = \"allow\""), "{more}");
    assert!(overload(&crate::support::read(&text)).unwrap().is_none());
}

#[test]
fn every_shipped_study_is_borne_by_its_drives() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for folder in ["../studies", "../studies/faults", "phihat-paper/studies"] {
        for entry in std::fs::read_dir(crates.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|e| e == "toml") {
                let study = Study::read(&path).unwrap();
                let more = overload(&study).unwrap();
                assert!(more.is_none(), "{}: {}", study.name, more.unwrap());
            }
        }
    }
}
