//! Reference records for the ros2_control plugin: a two-joint arm under the Rust supervisor, in closed loop,
//! sample by sample.
//!
//! Writes into a folder, for a law with an estimator and for one from positions, a gains document and a
//! record. `examples/ros2/test/plugin.cpp` gives the plugin the same samples and compares torques, estimates,
//! modes and faults, bit for bit.
//!
//! A row of a record, numbers as the hexadecimal bits of a double:
//!
//! ```text
//! period_ns came wanted  q dq (each joint)  q_d dq_d ddq_d (each joint)  tau phi_hat (each joint)  mode fault
//! ```
//!
//! Run it: `cargo run -p phihat --example ros2_record FOLDER`
#![allow(clippy::print_stdout, reason = "it tells a person what the records have seen")]

use std::collections::VecDeque;
use std::error::Error;
use std::fmt::Write;
use std::path::Path;

use phihat::{
    Fault, Form, GainError, InnovationSection, JointDesign, JointGains, JointOptions, JointRange,
    Limits, Measurement, Mode, ModeRequest, MotionLimits, Options, PositionDesign, Reference,
    Request, Sample, Stamp, Supervisor, SupervisorState,
};

const T_NS: u64 = 1_000_000;
const NAMES: [&str; 2] = ["shoulder", "elbow"];
const TORQUE: [f64; 2] = [60.0, 20.0];
const ROWS: u64 = 7000;

/// Mass, length and how far its centre is, of both links: rods.
const MASS: [f64; 2] = [2.0, 1.0];
const LENGTH: [f64; 2] = [0.4, 0.3];

/// Nominal inertia \[kg·m²\].
const INERTIA: [f64; 2] = [0.4, 0.03];

/// `K_p` \[1/s²\] and `K_d` \[1/s\] of the law with an estimator, and of that from positions.
const OUTER: [[f64; 2]; 2] = [[400.0, 40.0], [590.0, 74.0]];

/// Correction by the innovation, and share of the way to the wanted torque per sample, of the law from
/// positions: as a design gives them to a Panda.
const CORRECTION: [f64; 3] = [0.53, 298.0, -23300.0];
const SHARE: f64 = 0.17;

/// The innovation filter of the second joint's law from positions, likewise.
const SECTIONS: [InnovationSection; 2] = [
    InnovationSection { rates: [0.001, 0.13], weights: [2.4, -410.0] },
    InnovationSection { rates: [0.137, 0.49], weights: [-680.0, -2300.0] },
];

/// The laws, as `phihat design` would write them down.
fn document(positions: bool) -> String {
    let [kp, kd] = OUTER[usize::from(positions)];
    let law = if positions {
        format!(
            r#""observer": {{"correction": {CORRECTION:?}, "share": {SHARE}, "delay_samples": 1"#
        )
    } else {
        r#""a": [4900.0, 140.0]"#.to_owned()
    };
    let joint = |i: usize| {
        let (name, inertia) = (NAMES[i], INERTIA[i]);
        let rest = if positions { filter(i) + "}" } else { String::new() };
        format!(
            r#"{{"name": "{name}", "inertia_kg_m2": {inertia}, "kp_per_s2": {kp:?}, "kd_per_s": {kd:?}, {law}{rest}}}"#
        )
    };
    format!(
        r#"{{
  "format": "phihat-gains",
  "version": 3,
  "study": "", "study_sha256": "", "rate_hz": 1000.0, "method": "by hand, for a test",
  "joints": [{}, {}]
}}
"#,
        joint(0),
        joint(1)
    )
}

/// The innovation filter of the second joint's law from positions, as a document has it; the first joint has none.
fn filter(i: usize) -> String {
    let section = |own: &InnovationSection| {
        format!(r#"{{"rates": {:?}, "weights_per_s2": {:?}}}"#, own.rates, own.weights)
    };
    let sections: Vec<String> = SECTIONS.iter().map(section).collect();
    if i == 0 {
        return String::new();
    }
    format!(r#", "innovation_filter": [{}]"#, sections.join(", "))
}

/// The same laws in the core.
fn law(positions: bool, i: usize) -> Result<JointGains<f64>, GainError> {
    let (inertia, period) = (INERTIA[i], T_NS as f64 * 1e-9);
    let [kp, kd] = OUTER[usize::from(positions)];
    let law = if positions {
        JointGains::from_positions(&PositionDesign {
            inertia,
            kp,
            kd,
            correction: &CORRECTION,
            velocity_correction: &[],
            share: SHARE,
            delay: 1,
            period,
        })
        .and_then(|law| if i == 0 { Ok(law) } else { law.with_innovation_filter(&SECTIONS) })
    } else {
        let a = &[4900.0, 140.0];
        JointGains::new(&JointDesign { inertia, kp, kd, a, period, form: Form::Observer })
    }?;
    Ok(law.with_limits(Limits::new(Some(TORQUE[i]), Some(4000.0), period)?))
}

/// Accelerations of the arm in the vertical plane, `q` from the horizontal.
fn accelerations(q: [f64; 2], dq: [f64; 2], tau: [f64; 2]) -> [f64; 2] {
    let [(m1, m2), (l1, l2)] = [(MASS[0], MASS[1]), (LENGTH[0], LENGTH[1])];
    let (c1, c2, g) = (0.5 * l1, 0.5 * l2, 9.81);
    let (i1, i2) = (m1 * l1 * l1 / 12.0, m2 * l2 * l2 / 12.0);
    let h = m2 * l1 * c2;
    let m11 = i1 + i2 + m1 * c1 * c1 + m2 * (l1 * l1 + c2 * c2) + 2.0 * h * q[1].cos();
    let m12 = i2 + m2 * c2 * c2 + h * q[1].cos();
    let m22 = i2 + m2 * c2 * c2;
    let s = h * q[1].sin();
    let weight = m2 * g * c2 * (q[0] + q[1]).cos();
    let friction = |dq: f64| 0.3 * (dq / 0.02).tanh();
    let n0 = -s * dq[1] * (2.0 * dq[0] + dq[1])
        + (m1 * c1 + m2 * l1) * g * q[0].cos()
        + weight
        + friction(dq[0]);
    let n1 = s * dq[0] * dq[0] + weight + friction(dq[1]);
    let (r0, r1) = (tau[0] - n0, tau[1] - n1);
    let determinant = m11 * m22 - m12 * m12;
    [(m22 * r0 - m12 * r1) / determinant, (m11 * r1 - m12 * r0) / determinant]
}

/// Returns true if the sample of a cycle arrives: the first two are lost, then at times one, ten in a row,
/// thirty in a row.
fn comes(k: u64) -> bool {
    k > 1 && k % 97 != 13 && !(3000..3010).contains(&k) && !(6500..6530).contains(&k)
}

/// Returns true if there is a reference.
fn wanted(k: u64) -> bool {
    k > 500 && !(4000..4600).contains(&k)
}

/// Time to the cycle before \[ns\]: now and then a fifth longer or shorter.
fn period(k: u64) -> u64 {
    match k % 53 {
        7 => T_NS + T_NS / 5,
        8 => T_NS - T_NS / 5,
        _ => T_NS,
    }
}

/// Motion from where it begins, at a time since then \[s\].
fn motion(from: f64, joint: usize, t: f64) -> Reference<f64> {
    let (size, w) = ([0.3, -0.4][joint], [2.0, 3.0][joint]);
    let s = 0.5 * w * t;
    Reference {
        q: from + size * s.sin() * s.sin(),
        dq: 0.5 * size * w * (w * t).sin(),
        ddq: 0.5 * size * w * w * (w * t).cos(),
    }
}

/// Mode that the plugin requests.
fn request(mode: Mode, wanted: bool) -> ModeRequest {
    match mode {
        Mode::Idle => ModeRequest::Arm,
        Mode::SafeStop => ModeRequest::Stop,
        Mode::Holding | Mode::Tracking if wanted => ModeRequest::Track,
        Mode::Armed | Mode::Holding | Mode::Tracking => ModeRequest::Hold,
    }
}

fn supervisor(positions: bool) -> Result<Supervisor<f64, 2>, Box<dyn Error>> {
    let joint = JointOptions {
        velocity_max: Some(8.0),
        range: Some(JointRange { lower: -2.5, upper: 2.5, soft: 0.05, braking: 5.0 }),
        error_stop: Some(0.3),
        motion: Some(MotionLimits { velocity: 1.5, acceleration: 8.0, jerk: 200.0 }),
        ..JointOptions::default()
    };
    Ok(Supervisor::new([law(positions, 0)?, law(positions, 1)?], &[joint; 2], &Options::new(T_NS))?)
}

/// Modes, worst error and fault of a whole record, so that an empty test is noticed.
#[derive(Default)]
struct Seen {
    modes: Vec<Mode>,
    worst: f64,
    fault: Option<Fault>,
}

/// A line of a record.
fn row(text: &mut String, k: u64, numbers: impl Iterator<Item = f64>, (mode, fault): (&str, &str)) {
    let _ = write!(text, "{} {} {}", period(k), u8::from(comes(k)), u8::from(wanted(k)));
    for number in numbers {
        let _ = write!(text, " {:016x}", number.to_bits());
    }
    let _ = writeln!(text, " {mode} {fault}");
}

/// The arm over a period \[ns\], a tenth of it at a time; brakes hold it.
fn go_on((q, dq): (&mut [f64; 2], &mut [f64; 2]), tau: [f64; 2], period_ns: u64, held: bool) {
    let step = period_ns as f64 * 1e-10;
    for _ in 0..10 {
        let ddq = accelerations(*q, *dq, tau);
        for i in 0..2 {
            dq[i] = if held { 0.0 } else { dq[i] + step * ddq[i] };
            q[i] += step * dq[i];
        }
    }
}

fn record(positions: bool) -> Result<(String, Seen), Box<dyn Error>> {
    let arm = supervisor(positions)?;
    let mut state = SupervisorState::new();
    let delay = usize::from(positions);
    let (mut q, mut dq) = ([-0.4, 0.9], [0.0; 2]);
    let (mut known, mut known_dq) = ([f64::NAN; 2], [f64::NAN; 2]);
    let mut sent = VecDeque::from(vec![[0.0; 2]; delay + 1]);
    let (mut acted, mut waited, mut applied) = ([0.0; 2], 0_u32, [0.0; 2]);
    let (mut now, mut stamp) = (0, Stamp { sequence: 0, t_ns: 0 });
    let (mut mode, mut begun) = (Mode::Idle, (0, q));
    let mut references = [Reference { q: 0.0, dq: 0.0, ddq: 0.0 }; 2];
    let (mut text, mut seen) = (String::new(), Seen::default());
    for k in 0..ROWS {
        now += period(k);
        waited += 1;
        for i in 0..2 {
            acted[i] += sent[delay][i];
        }
        if comes(k) {
            (known, known_dq) = (q, dq);
            applied = acted.map(|sum| sum / f64::from(waited));
            (acted, waited) = ([0.0; 2], 0);
            stamp = Stamp { sequence: k + 1, t_ns: now };
        }
        if wanted(k) && !wanted(k.saturating_sub(1)) {
            begun = (now, q);
        }
        if wanted(k) {
            let t = (now - begun.0) as f64 * 1e-9;
            references = [motion(begun.1[0], 0, t), motion(begun.1[1], 1, t)];
        }
        let joint =
            |i: usize| Measurement { q: known[i], dq: known_dq[i], tau_applied: applied[i] };
        let (asked, preset) = (request(mode, wanted(k)), Some(&[0.0; 2][..]));
        let answer = arm.step(
            &mut state,
            &Sample { stamp, now_ns: now, joints: &[joint(0), joint(1)] },
            &Request { mode: asked, references: &references, preset, feed_forward: None },
        );
        mode = answer.report.mode;
        if seen.modes.last() != Some(&mode) {
            seen.modes.push(mode);
        }
        if mode == Mode::Tracking && k > 2000 && k < 3000 {
            let error = |i: usize| (q[i] - references[i].q).abs();
            seen.worst = seen.worst.max(error(0)).max(error(1));
        }
        seen.fault = answer.report.fault.map(|(fault, _)| fault);
        let measured = (0..2).flat_map(|i| [q[i], dq[i]]);
        let asked = references.iter().flat_map(|r| [r.q, r.dq, r.ddq]);
        let answered = answer.commands.iter().flat_map(|c| [c.tau, c.phi_hat]);
        let fault = seen.fault.map_or("none", Fault::name);
        row(&mut text, k, measured.chain(asked).chain(answered), (mode.name(), fault));
        sent.push_front(answer.commands.map(|command| command.tau));
        sent.truncate(delay + 1);
        go_on((&mut q, &mut dq), sent[delay], period(k), mode == Mode::Idle);
    }
    Ok((text, seen))
}

fn write(folder: &Path) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(folder)?;
    for (name, positions) in [("observer", false), ("positions", true)] {
        let (text, seen) = record(positions)?;
        let tracked = seen.modes.iter().filter(|mode| **mode == Mode::Tracking).count();
        assert!(tracked == 2 && seen.fault == Some(Fault::LinkLost), "{name}: {:?}", seen.modes);
        println!("{name}: {:?}, at most {:.2} mrad while it tracks", seen.modes, 1e3 * seen.worst);
        assert!((1e-4..0.01).contains(&seen.worst), "this arm does not follow");
        std::fs::write(folder.join(format!("{name}.json")), document(positions))?;
        std::fs::write(folder.join(format!("{name}.txt")), text)?;
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("which folder?")?;
    write(Path::new(&folder))
}
