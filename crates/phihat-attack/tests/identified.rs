//! Intervals of inertia from records of random arms, held against the arms' own inertia along the record. Wrong if an
//! interval excluded the inertia of a posture that the record visits.

use core::f64::consts::TAU;
use core::fmt::Write as _;
use std::path::Path;

use phihat::Form;
use phihat_attack::{Dice, UserArm};
use phihat_design::{
    DryFriction, RecordedJoint, Smoothed, enclose_dry_friction, enclose_inertia, requested_gains,
};
use phihat_model::{JointKind, Robot, Workspace};
use phihat_sim::{SimError, Simulation, Trace};
use phihat_study::{Study, StudyError};

/// A drawn record and the truth about it.
struct Drawn {
    name: String,
    joints: Vec<RecordedJoint>,
    period_ns: u64,
    /// Least and largest `M_ii` at the postures of the record \[kg·m²\].
    truth: Vec<(f64, f64)>,
    /// Dry friction per joint \[N·m\], where it is a level: without stiction and smooth friction that changes fast.
    dry: Option<Vec<f64>>,
    /// Sines per joint.
    sines: usize,
}

const SECONDS_LEFT_OUT: usize = 1;

fn numbers(dice: &mut Dice, n: usize, (low, high): (f64, f64)) -> Vec<f64> {
    (0..n).map(|_| dice.log_between(low, high)).collect()
}

/// Text of a study: typed gains, sines, friction, payload, encoder.
fn text(dice: &mut Dice, arm: &UserArm, robot: &Robot, sines: usize) -> String {
    let n = robot.joints.len();
    let ends = |i: usize| robot.joints[i].position.unwrap_or((-2.5, 2.5));
    let at: Vec<f64> =
        (0..n).map(|i| ends(i).0 + (ends(i).1 - ends(i).0) * dice.between(0.25, 0.75)).collect();
    let model = robot.plant_model();
    let mut mass = vec![0.0; n * n];
    model.mass_matrix(&mut Workspace::new(&model), &at, &mut mass);
    let inertia: Vec<f64> = (0..n).map(|i| mass[i * n + i] * dice.between(0.7, 1.5)).collect();
    let mut weight = vec![0.0; n];
    model.bias(&mut Workspace::new(&model), &at, &vec![0.0; n], &mut weight);
    let weight: Vec<f64> = weight.iter().zip(&inertia).map(|(g, m)| g.abs() + 5.0 * m).collect();
    let seconds = dice.between(5.0, 12.0);
    let (robot_lines, _) = arm.section();
    let mut text = format!(
        "duration_s = {seconds:?}\nseed = 3\n[robot]\n{robot_lines}\n[gains]\nbandwidth_rad_s = {:?}\n\
         estimator_bandwidth_rad_s = {:?}\ninertia_kg_m2 = {inertia:?}\n[loop]\nrate_hz = {:?}\ndelay_samples = {}\n\
         torque_max_nm = \"none\"\nbeyond_drives = \"allow\"\n",
        dice.between(12.0, 25.0),
        dice.between(30.0, 60.0),
        dice.pick(&[500.0, 1000.0, 1000.0, 1000.0, 2000.0]),
        dice.pick(&[0, 1, 1, 2]),
    );
    text += &sensor(dice);
    text += &world(dice, robot, &weight);
    text + &sines_around(dice, robot, &at, sines)
}

/// An encoder, mostly without noise.
fn sensor(dice: &mut Dice) -> String {
    let bits = dice.pick(&[14, 16, 17, 18, 18, 19, 20, 22]);
    let mut text = String::new();
    let _ = write!(
        text,
        "[sensor]\nencoder_bits = {bits}\nvelocity = \"differenced\"\nvelocity_filter_hz = 100.0\n"
    );
    if dice.chance(0.3) {
        let noise = dice.log_between(1e-7, 1e-4);
        let _ = writeln!(text, "position_noise_rad = {noise:?}");
    }
    text
}

/// Friction, payload and stiction, for joints that carry so much weight \[N·m\].
fn world(dice: &mut Dice, robot: &Robot, weight: &[f64]) -> String {
    let n = weight.len();
    let times = |factors: Vec<f64>| -> Vec<f64> {
        factors.iter().zip(weight).map(|(x, w)| x * w).collect()
    };
    let mut text = String::new();
    let friction = if dice.chance(0.6) { "robot" } else { "none" };
    let _ = write!(text, "[world]\nfriction = \"{friction}\"\nsubsteps = SUBSTEPS\n");
    if dice.chance(0.7) {
        let size = dice.log_between(3e-3, 0.1);
        let _ =
            writeln!(text, "coulomb_extra_nm = {:?}", times(numbers(dice, n, (0.5 * size, size))));
    }
    if dice.chance(0.6) {
        let size = dice.log_between(3e-3, 0.1);
        let _ = writeln!(
            text,
            "viscous_extra_nm_s_rad = {:?}",
            times(numbers(dice, n, (0.5 * size, size)))
        );
    }
    if dice.chance(0.6) {
        let whole: f64 = robot.model.dynamic_parameters().iter().map(|p| p[0]).sum();
        let mass = whole * dice.log_between(0.005, 0.1);
        let far = dice.between(0.0, 0.1);
        let com = dice.direction().map(|x| far * x);
        let _ = write!(text, "[world.payload]\nmass_kg = {mass:?}\ncom_m = {com:?}\n");
    }
    if dice.chance(0.5) {
        let (ratio, slow) = (dice.between(1.0, 1.8), dice.log_between(0.01, 0.3));
        let _ = write!(
            text,
            "[world.stiction]\nbreakaway_ratio = {ratio:?}\nstribeck_velocity_rad_s = {slow:?}\nstiffness_nm_rad = \
                2000.0\n"
        );
    }
    text
}

/// Sines around a posture: a share of them at one frequency for all joints, a share at multiples of the first.
fn sines_around(dice: &mut Dice, robot: &Robot, at: &[f64], sines: usize) -> String {
    let ends = |i: usize| robot.joints[i].position.unwrap_or((-2.5, 2.5));
    let fade = dice.pick(&[0.5, 1.0]);
    let mut text = String::new();
    let _ = write!(
        text,
        "[start]\ntorque_nm = \"gravity\"\n[reference]\nkind = \"sines\"\ncenter_rad = {at:?}\nfade_in_s = {fade:?}\n"
    );
    let vivid = dice.log_between(0.1, 1.0);
    let alike = dice.chance(0.2);
    // Gravity bends: a second sine at a multiple of the first looks like what it does on the first.
    let harmonic = dice.chance(0.2);
    let mut first = Vec::new();
    for term in 0..sines {
        let (mut amplitude, mut frequency, mut phase) = (vec![], vec![], vec![]);
        let common = dice.log_between(0.15, 2.0);
        for (i, at) in at.iter().enumerate() {
            let room = (ends(i).1 - at).min(at - ends(i).0) / sines as f64;
            let mut f = if alike { common } else { dice.log_between(0.15, 2.5) };
            if harmonic && term > 0 {
                f = (term + 1) as f64 * first[i];
            } else if term == 0 {
                first.push(f);
            }
            let slides = robot.joints[i].kind == JointKind::Prismatic;
            let fast = 1.5 / (TAU * f) / sines as f64 * if slides { 0.3 } else { 1.0 };
            let still = term == 0 && dice.chance(0.05);
            amplitude.push(if still {
                0.0
            } else {
                vivid * room.min(fast).min(0.6) * dice.between(0.3, 1.0)
            });
            frequency.push(f);
            phase.push(dice.between(0.0, TAU));
        }
        let _ = write!(
            text,
            "[[reference.sine]]\namplitude_rad = {amplitude:?}\nfrequency_hz = {frequency:?}\nphase_rad = {phase:?}\n"
        );
    }
    text
}

/// Runs the text; `None` where the typed gains do not hold the arm.
fn run(text: &str, folder: &Path) -> Result<Option<Box<(Study, Trace)>>, StudyError> {
    let mut substeps = 1;
    loop {
        let whole = text.replace("SUBSTEPS", &substeps.to_string());
        let study = Study::from_text(&whole, "study.toml", folder)?;
        let names = study.robot.joint_names();
        let Some(gains) = requested_gains(&study) else { return Ok(None) };
        let Ok(law) = gains.joint_gains(&names, study.control.period_ns, Form::Observer) else {
            return Ok(None);
        };
        match Simulation::new(&study, &law) {
            Ok(simulation) => {
                let done = simulation.run(|_| ());
                let good = done.divergence.is_none() && done.abort.is_none();
                let near = |trace: &Trace| {
                    trace.joints.iter().all(|joint| joint.e.iter().all(|e| e.abs() < 0.1))
                };
                return Ok((good && near(&done.trace)).then(|| Box::new((study, done.trace))));
            }
            Err(SimError::TooStiff { needed, .. }) if needed <= 24 => {
                substeps = needed + needed / 4 + 1;
            }
            Err(_) => return Ok(None),
        }
    }
}

fn drawn(seed: u64, index: u64) -> Option<Drawn> {
    let mut dice = Dice::new(seed, index);
    let arm = if dice.chance(0.6) { UserArm::small(&mut dice) } else { UserArm::draw(&mut dice) };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("identified-{seed}-{index}"));
    std::fs::create_dir_all(&folder).unwrap();
    for (name, text) in arm.section().1 {
        std::fs::write(folder.join(name), text).unwrap();
    }
    let robot = arm.robot().unwrap();
    let sines = dice.pick(&[1, 1, 2, 2, 3, 4]);
    let text = text(&mut dice, &arm, &robot, sines);
    let ran = run(&text, &folder);
    std::fs::remove_dir_all(&folder).unwrap();
    // What is drawn may ask a joint for more than its limits.
    let (study, trace) = *ran.ok()??;
    let mut model = study.robot.plant_model();
    if let Some(body) = &study.world.payload {
        model = model.with_payload_on(&body.frame, &body.body()).unwrap();
    }
    let n = trace.joints.len();
    let mut workspace = Workspace::new(&model);
    let mut truth = vec![(f64::INFINITY, 0.0_f64); n];
    let mut m = vec![0.0; n * n];
    let from = usize::try_from(1_000_000_000 / trace.period_ns).unwrap() * SECONDS_LEFT_OUT;
    for k in (from..trace.len()).step_by(5) {
        let q: Vec<f64> = trace.joints.iter().map(|joint| joint.q[k]).collect();
        model.mass_matrix(&mut workspace, &q, &mut m);
        for (i, (low, high)) in truth.iter_mut().enumerate() {
            *low = low.min(m[i * n + i]);
            *high = high.max(m[i * n + i]);
        }
    }
    let joints = trace.joints.iter().map(|joint| RecordedJoint {
        name: joint.name.clone(),
        q: joint.q_measured[from..].to_vec(),
        tau: joint.tau_applied[from..].to_vec(),
    });
    let level = |(i, extra): (usize, &f64)| {
        let own = &study.robot.joints[i].friction;
        let smooth = own.sigmoid.is_some() && study.world.robot_friction;
        (!smooth).then(|| extra + if study.world.robot_friction { own.coulomb } else { 0.0 })
    };
    let levels = study.world.extra_coulomb.iter().enumerate().map(level);
    let dry = if study.world.stiction.is_some() { None } else { levels.collect() };
    let (joints, period_ns) = (joints.collect(), trace.period_ns);
    Some(Drawn { name: arm.name(), joints, period_ns, truth, dry, sines })
}

/// Records: so many in the gate, so many with `PHIHAT_ALL`.
const RECORDS: (u64, u64) = (30, 1000);

#[test]
fn no_interval_excludes_the_inertia_of_an_arm() {
    let all = std::env::var_os("PHIHAT_ALL").is_some();
    let wanted = if all { RECORDS.1 } else { RECORDS.0 };
    let (mut records, mut joints, mut answered, mut useful, mut index) = (0, 0, 0, 0, 0);
    let mut of_sines = [[0; 3]; 5];
    let (mut frictions, mut narrow) = (0, 0);
    let mut false_ones: Vec<String> = Vec::new();
    while records < wanted {
        index += 1;
        let Some(drawn) = drawn(4711, index) else { continue };
        records += 1;
        let found = enclose_inertia(&drawn.joints, drawn.period_ns, 0.01).unwrap();
        if let Some(levels) = &drawn.dry {
            let smoothed = Smoothed::new(&drawn.joints, drawn.period_ns, 0.01).unwrap();
            for (i, level) in levels.iter().enumerate() {
                let reach = smoothed.reach();
                let dry = DryFriction::of(&smoothed.signals(), i, drawn.period_ns, reach);
                let enclosed = enclose_dry_friction(&drawn.joints, i, &smoothed);
                let Some((dry, enclosed)) = dry.zip(enclosed) else { continue };
                let dry = dry.widened(enclosed);
                frictions += 1;
                narrow += usize::from(dry.high_nm - dry.low_nm <= 0.4 * level);
                // The simulated level is smooth below 1 mrad/s.
                if dry.low_nm > 1.01 * level || *level > 1.01 * dry.high_nm + 1e-6 {
                    false_ones
                        .push(format!("{index} joint {i}: dry friction {level} not in {dry:?}"));
                }
            }
        }
        for (i, (found, (low, high))) in found.iter().zip(&drawn.truth).enumerate() {
            joints += 1;
            of_sines[drawn.sines][0] += 1;
            let Ok(found) = found else { continue };
            answered += 1;
            of_sines[drawn.sines][1] += 1;
            if found.low_kg_m2 >= 0.8 * low && found.high_kg_m2 <= 1.2 * high {
                useful += 1;
                of_sines[drawn.sines][2] += 1;
            }
            if found.low_kg_m2 > *low || *high > found.high_kg_m2 {
                let name = &drawn.name;
                false_ones
                    .push(format!("{index} {name} joint {i}: {low} … {high} not in {found:?}"));
            }
        }
    }
    println!("{records} records, {joints} joints: {answered} intervals, {useful} within 20 %");
    println!("dry friction: {frictions} intervals, {narrow} within 20 %");
    for (sines, [joints, answered, useful]) in of_sines.iter().enumerate().skip(1) {
        println!("  {sines} sines: {joints} joints, {answered} intervals, {useful} within 20 %");
    }
    assert!(false_ones.is_empty(), "{false_ones:#?}");
    // An estimator that refuses everything makes no mistake.
    assert!(10 * answered >= joints, "{answered} of {joints}");
}
