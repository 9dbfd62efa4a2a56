//! The first motion of an arm without gains. Wrong if its measured intervals did not contain the values of
//! the simulated arm, whatever load, friction, losses and rotors it was given; if a joint were commanded more
//! than its cap, or went further than it may; or if it were driven where no gains cover the error of the
//! guess.

use std::fs;
use std::net::Ipv4Addr;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::thread;
use std::time::Duration;

use crate::support::folder;
use crate::support::served::patient;
use phihat_drive::{CheckName, DriveOptions, Driven, End, On, State, prepare};
use phihat_fci::{Event, Pace};
use phihat_model::{Body, Workspace};
use phihat_session::{
    FIRST_WIDTH, FirstMeasured, FirstMotion, FirstStudy, IdentifyOptions, Leave, RunOptions,
    ServeOptions, ServeWatch, ServedMotion, TraceKind, first_measured,
};
use phihat_sim::{Motion, Trace};
use phihat_study::Study;

/// Even draws from 0 to 1: a sequence of the golden ratio.
fn share(k: u32) -> f64 {
    (0.5 + 0.618_033_988_749_895 * f64::from(k)).fract()
}

fn between(low: f64, high: f64, k: u32) -> f64 {
    low + (high - low) * share(k)
}

fn written(folder: &Path, name: &str, text: &str) -> PathBuf {
    let path = folder.join(name);
    fs::write(&path, text).unwrap();
    path
}

fn options(study: &Path, on: On, first: FirstMotion) -> DriveOptions {
    let run = RunOptions {
        study: study.to_owned(),
        out: Some(study.with_extension("driven")),
        ..RunOptions::default()
    };
    let accept = vec![CheckName::RealTime, CheckName::Rehearsal, CheckName::Description];
    DriveOptions { run, on, accept, first: Some(first), ..DriveOptions::default() }
}

fn driven(options: &DriveOptions) -> (Driven, FirstStudy, FirstMeasured) {
    let out = options.run.out.clone().unwrap();
    let prepared = prepare(options).unwrap();
    let refused: Vec<_> = prepared.checks.iter().filter(|check| check.refuses()).collect();
    assert!(refused.is_empty(), "{refused:#?}");
    let first = prepared.first.clone().unwrap();
    let leave = Leave { folder: &out, page: None };
    let driven = prepared.drive(leave, &mut (), &AtomicBool::new(false)).unwrap();
    let width = IdentifyOptions { width: FIRST_WIDTH, ..IdentifyOptions::default() };
    let found = first_measured(&first.study, &out, &width).unwrap();
    (driven, first, found)
}

/// True inertia of each joint where a study begins \[kg·m²\], with the payload of its world.
fn truth(study: &Study) -> Vec<f64> {
    let mut model = study.robot.plant_model();
    if let Some(payload) = &study.world.payload {
        let body = Body { mass: payload.mass, com: payload.com, inertia: payload.inertia };
        model = model.with_payload_on(&payload.frame, &body).unwrap();
    }
    let motion = Motion::of(study).unwrap();
    let n = study.robot.joints.len();
    let q: Vec<f64> = (0..n).map(|i| motion.at(i, 0.0)[0]).collect();
    let mut mass = vec![0.0; n * n];
    model.mass_matrix(&mut Workspace::new(&model), &q, &mut mass);
    (0..n).map(|i| mass[i * n + i]).collect()
}

/// Compares the result with the truth; the largest width of the intervals, as a factor.
fn held(found: &FirstMeasured, truth: &[f64], dry: &[f64], what: &str) -> f64 {
    let all = found.all();
    assert!(all.is_some(), "{what}: {found:#?}");
    let mut wide = 1.0_f64;
    for ((joint, truth), dry) in all.unwrap().iter().zip(truth).zip(dry) {
        let (low, high) = (joint.inertia.low_kg_m2, joint.inertia.high_kg_m2);
        assert!(
            low <= *truth && *truth <= high,
            "{what}, {}: {truth} not in {low} … {high}",
            joint.name
        );
        let jump = joint.phi_jump_max_nm;
        assert!(jump >= 2.0 * dry, "{what}, {}: jump {jump}, dry friction {dry}", joint.name);
        wide = wide.max(high / low);
    }
    wide
}

/// Asserts that no command exceeds the cap, and no joint goes further than the amplitude plus the tolerance
/// of the supervisor.
fn within(first: &FirstStudy, told: &FirstMotion, out: &Path) {
    let file = fs::File::open(out.join("trace.parquet")).unwrap();
    let trace = Trace::read(file, &first.study).unwrap();
    for (joint, cap) in trace.joints.iter().zip(&first.torque) {
        let most = joint.tau_command.iter().fold(0.0_f64, |most, tau| most.max(tau.abs()));
        assert!(most <= *cap, "{}: {most} of {cap} N·m", joint.name);
        let away = |q: &f64| (q - joint.q_desired[0]).abs();
        let far = joint.q.iter().map(away).fold(0.0, f64::max);
        assert!(far <= 3.0 * told.amplitude, "{}: {far} rad", joint.name);
    }
}

const ARM: &str = r#"
duration_s = 2.0
[robot]
name = "planar3r"
ROTORS
[spec]
settle_s = 1.0
[design]
[loop]
form = "observer"
delay_samples = 1
[sensor]
encoder_bits = BITS
velocity = "differenced"
velocity_filter_hz = "design"
[world]
gravity_m_s2 = [0.0, 0.0, 0.0]
friction = "none"
coulomb_extra_nm = DRY
viscous_extra_nm_s_rad = VISCOUS
PAYLOAD
[world.network]
sample_loss = LOSS
command_loss = LOSS
[reference]
kind = "sines"
center = "ready"
[[reference.sine]]
amplitude_rad = 0.1
frequency_hz = 0.3
"#;

/// Loads, friction, encoders and losses, drawn.
#[test]
fn what_a_first_motion_measures_holds_what_the_arm_is() {
    let folder = folder("first-motion");
    let mut wide = 1.0_f64;
    let arms = if std::env::var_os("PHIHAT_ALL").is_some() { 16 } else { 3 };
    for k in 0..arms {
        let draw = |low: f64, high: f64, at: u32| between(low, high, 31 * k + at);
        let dry = [1, 2, 3].map(|at| draw(0.0, 0.6, at) / f64::from(at));
        let text = ARM
            .replace("ROTORS", "")
            .replace("BITS", &(17 + k % 4).to_string())
            .replace("DRY", &format!("{dry:?}"))
            .replace("VISCOUS", &format!("{:?}", draw(0.0, 0.5, 4)))
            .replace("PAYLOAD", &format!("payload = {{ mass_kg = {:?} }}", draw(0.01, 1.0, 5)))
            .replace("LOSS", &format!("{:?}", draw(0.0, 0.02, 6)));
        let study = written(&folder, &format!("arm{k}.toml"), &text);
        let told = FirstMotion::default();
        let (driven, first, found) = driven(&options(&study, On::Sim, told));
        assert!(driven.tally.end == End::Complete && driven.good(), "{k}: {:?}", driven.tally);
        within(&first, &told, &study.with_extension("driven"));
        let true_ = truth(&Study::read(&study).unwrap());
        wide = wide.max(held(&found, &true_, &dry, &format!("arm {k}")));
    }
    println!("intervals are within a factor of {wide:.3}");
    assert!(wide < 2.0, "{wide}");
}

/// The arm as the study says, with a good encoder and little friction.
fn plain() -> String {
    ARM.replace("ROTORS", "")
        .replace("BITS", "18")
        .replace("DRY", "0.05")
        .replace("VISCOUS", "0.0")
        .replace("PAYLOAD", "")
        .replace("LOSS", "0.0")
}

/// A drive that is wired with the wrong sign, dead or weak: the arm stops within the tolerance of the
/// supervisor, or the measured intervals are right.
#[test]
fn a_drive_that_does_what_it_likes_stops_near() {
    let folder = folder("first-motion-faults");
    for (gain, stops) in [(-1.0, true), (0.0, true), (0.5, false)] {
        let text = format!(
            "{}[[fault]]\nkind = \"drive_gain\"\njoint = \"joint2\"\nstart_s = 0.0\nduration_s = 100.0\nsize = \
                {gain:?}\n",
            plain()
        );
        let study = written(&folder, "arm.toml", &text);
        let told = FirstMotion::default();
        let (driven, _, found) = driven(&options(&study, On::Sim, told));
        let file = fs::File::open(study.with_extension("driven").join("trace.parquet")).unwrap();
        let trace = Trace::read(
            file,
            &prepare(&options(&study, On::Sim, told)).unwrap().first.unwrap().study,
        )
        .unwrap();
        let joint = &trace.joints[1];
        let far = joint.q.iter().map(|q| (q - joint.q[0]).abs()).fold(0.0, f64::max);
        let faults = &driven.document["supervisor_faults"];
        println!("gain {gain}: {far:.3} rad, {faults}, all: {}", found.all().is_some());
        assert_eq!(faults.as_array().is_some_and(|all| !all.is_empty()), stops, "{gain}: {faults}");
        assert_eq!(found.all().is_none(), stops);
        assert_eq!(driven.tally.end == End::Faulted, stops);
        assert!(far < 0.4, "gain {gain}: {far} rad");
    }
}

#[test]
fn what_cannot_be_moved_safely_is_refused() {
    let folder = folder("first-motion-refused");
    let plain = plain();
    // A guess that may be off by twenty, on a loop that is late.
    let late = written(
        &folder,
        "late.toml",
        &plain
            .replace("delay_samples = 1", "delay_samples = 8\nrate_hz = 100.0")
            .replace("velocity_filter_hz = \"design\"", "velocity_filter_hz = 20.0"),
    );
    let off = FirstMotion { inertia_within: 20.0, ..FirstMotion::default() };
    let prepared = prepare(&options(&late, On::Sim, off)).unwrap();
    let window = prepared.checks.iter().find(|check| check.name == CheckName::Window).unwrap();
    assert!(prepared.is_refused() && window.state == State::Failed, "{window:?}");
    // No limit of which a share could be taken.
    let joint = "[[joint]]\nname = \"one\"\ninertia_min_kg_m2 = 0.1\ninertia_max_kg_m2 = 0.4\nphi_rate_max_nm_s = \
        1.0\nphi_jump_max_nm = 0.1\n";
    let bare = plain
        .replace("[robot]\nname = \"planar3r\"", joint)
        .replace("center = \"ready\"", "center_rad = 0.0");
    let bare = written(&folder, "bare.toml", &bare);
    let why = prepare(&options(&bare, On::Sim, FirstMotion::default())).unwrap_err().to_string();
    assert!(why.contains("one states none") && why.contains("torque_max_nm"), "{why}");
    // No room to move.
    let at = plain.find("[reference]").unwrap();
    let hold = "[reference]\nkind = \"hold\"\nq_rad = [3.13, 0.0, 0.0]\n";
    let edge = written(&folder, "edge.toml", &format!("{}{hold}", &plain[..at]));
    let why = prepare(&options(&edge, On::Sim, FirstMotion::default())).unwrap_err().to_string();
    assert!(why.contains("joint1 stands at 3.130") && why.contains("0.07 rad or more"), "{why}");
}

/// Nobody is told of what comes.
struct Deaf;

impl ServeWatch for Deaf {
    fn event(&mut self, _: Event) {}
    fn motion(&mut self, _: &ServedMotion) {}
}

const FRANKA: &str = r#"
duration_s = 60.0
[robot]
name = "panda"
ROTORS
[profile]
name = "robot"
[spec]
settle_s = 1.0
[design]
[loop]
form = "observer"
rate_hz = 1000.0
delay_samples = 1
[sensor]
encoder_bits = 18
velocity = "differenced"
velocity_filter_hz = 45.0
[world]
friction = "robot"
PAYLOAD
[world.network]
sample_loss = 0.01
command_loss = 0.01
[reference]
kind = "hold"
pose = "ready"
"#;

/// The robot has other rotors and a load than the study says: what it has is found.
#[test]
fn a_franka_that_is_not_what_the_study_says_is_measured() {
    let folder = folder("first-motion-franka");
    let rotors = "armature_kg_m2 = [0.9, 0.4, 0.7, 0.3, 0.12, 0.35, 0.19]";
    for (protocol, mass) in [(5, 0.8), (10, 0.2)] {
        let payload = format!(
            "payload = {{ frame = \"panda_link8\", mass_kg = {mass:?}, com_m = [0.0, 0.0, 0.06] }}"
        );
        let robot = FRANKA.replace("ROTORS", rotors).replace("PAYLOAD", &payload);
        let robot = written(&folder, &format!("robot{protocol}.toml"), &robot);
        let told = written(
            &folder,
            &format!("told{protocol}.toml"),
            &FRANKA.replace("ROTORS", "").replace("PAYLOAD", ""),
        );
        let serve = ServeOptions {
            study: robot.clone(),
            out: Some(robot.with_extension("served")),
            listen: Ipv4Addr::LOCALHOST.into(),
            port: 0,
            trace: TraceKind::default(),
            pace: Pace::LockStep { patience: Duration::from_mins(1) },
            cycles: None,
        };
        let mut served = serve.open().unwrap();
        let address = served.address();
        thread::spawn(move || served.run(&mut Deaf));
        let on = patient(&format!("fci://{address}?protocol={protocol}"));
        let asked = FirstMotion::default();
        let (driven, first, found) = driven(&options(&told, on, asked));
        assert!(driven.tally.end == End::Complete && driven.good(), "{:?}", driven.tally);
        assert!(driven.tally.lost > 100, "{:?}", driven.tally);
        within(&first, &asked, &told.with_extension("driven"));
        let wide = held(&found, &truth(&Study::read(&robot).unwrap()), &[0.0; 7], "franka");
        println!(
            "protocol {protocol}: {} samples, {} lost, intervals within a factor of {wide:.3}",
            driven.tally.cycles, driven.tally.lost
        );
        assert!(wide < 2.0, "{wide}");
        // The rotor of the first joint differs so much that the arm cannot pass for the one of the study.
        assert_eq!(found.joints[0].as_told(), Some(false));
    }
}
