//! No arm is armed outside of its window: a thousand random arms in random loops, each played through the core in
//! time. Wrong if the gate let an arm pass whose loop does not settle, or refused one without naming the inequality.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use crate::sampled_support::{Random, Rig, estimator};
use nalgebra::{DMatrix, DVector};
use phihat::{Delay, Form, JointGains, JointState, Measurement, Reference};
use phihat_design::prelude::*;
use phihat_design::sampled::{InertiaWindow, LoopModel};
use phihat_design::{Arm, Gains, JointRecord, arm_inside_window, requested_gains};
use phihat_model::Workspace;
use phihat_study::{InertiaSource, Study};

/// Samples per window of [`Rig::settles`]: growth is seen over as many again.
const LONG: usize = 4000;

/// A loop of random rate, delay, sensor and form, around random gains.
fn text(random: &mut Random, robot: &str, design: &str, joints: u32) -> String {
    let rate = [500, 1000, 2000, 4000][random.below(4) as usize];
    let t = 1.0 / f64::from(rate);
    let w = random.around(0.003, 0.06) / t;
    let a = estimator(
        random.below(4) as usize + 1,
        w * random.around(0.5, 6.0),
        random.between(0.6, 1.2),
    );
    let damping = random.between(0.6, 1.4);
    let form = ["observer", "literal"][random.below(2) as usize];
    let velocity = ["measured", "differenced"][random.below(2) as usize];
    let filter =
        [String::new(), format!("velocity_filter_hz = {}\n", random.between(0.03, 0.3) / t)];
    let drive = [
        String::new(),
        format!("[world]\ndrive_bandwidth_hz = {}\n", random.between(0.1, 0.4) / t),
    ];
    let m = random.around(0.05, 5.0);
    let inertia: Vec<String> =
        (0..joints).map(|_| (m * random.around(0.5, 2.0)).to_string()).collect();
    format!(
        "duration_s = 3.0\n{robot}\n[design]\n{design}\n[gains]\nkp_per_s2 = {}\nkd_per_s = {}\na = {a:?}\n\
         inertia_kg_m2 = [{}]\n[loop]\nrate_hz = {rate}\nform = \"{form}\"\ndelay_samples = {}\n[sensor]\n\
         velocity = \"{velocity}\"\n{}{}[reference]\nkind = \"hold\"\nq_rad = 0.0\n",
        w * w,
        2.0 * damping * w,
        inertia.join(", "),
        random.below(4),
        filter[random.below(2) as usize],
        drive[random.below(2) as usize],
    )
}

fn read(text: &str, base: &Path) -> (Study, Gains) {
    let study = Study::from_text(text, "arm.toml", base).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let gains = requested_gains(&study).unwrap();
    (study, gains)
}

fn settles(record: &JointRecord, model: &LoopModel, mu: f64) -> bool {
    Rig::new(record, model, mu).settles(LONG)
}

/// Verdict of the gate on an arm whose every joint has an inertia in `M̄ [low, high]`.
fn gate(study: &mut Study, gains: &Gains, (low, high): (f64, f64)) -> Result<(), String> {
    let scaled = |factor: f64| gains.joints.iter().map(|j| factor * j.inertia_kg_m2).collect();
    study.design.inertia = InertiaSource::Typed { low: scaled(low), high: scaled(high) };
    let arm = Arm::of(study).unwrap();
    arm_inside_window(study, &arm, gains).map_err(|why| why.to_string())
}

#[test]
fn f10_a_thousand_arms_and_none_is_armed_outside_its_window() {
    let mut random = Random(2018);
    let (mut armed, mut refused, mut edges) = (0, 0, 0);
    for arm in 0..1000 {
        let robot = "[robot]\nname = \"planar3r\"";
        let (mut study, gains) = read(&text(&mut random, robot, "", 3), Path::new("."));
        let (record, model) = (&gains.joints[0], LoopModel::from_study(&study, 0));
        let low = random.around(0.05, 2.0);
        let high = low * random.around(1.05, 20.0);
        match gate(&mut study, &gains, (low, high)) {
            Ok(()) => {
                armed += 1;
                for mu in [low, (low * high).sqrt(), high] {
                    assert!(
                        settles(record, &model, mu),
                        "arm {arm} was armed and diverges at μ = {mu}"
                    );
                }
            }
            Err(why) => {
                refused += 1;
                assert!(why.contains("inertia window"), "arm {arm}: {why}");
            }
        }
        // Every fifth: 2 % inside of both edges is armed and settles; 2 % outside is refused and does not.
        if arm % 5 == 0
            && let Ok(window) = InertiaWindow::find(record, &model)
            && window.ratio() > 1.1
            && window.low > 1e-4
            && window.high < 1e4
        {
            edges += 1;
            let (low, high) = (window.low, window.high);
            assert_eq!(gate(&mut study, &gains, (low * 1.02, high / 1.02)), Ok(()), "arm {arm}");
            assert!(
                settles(record, &model, low * 1.02) && settles(record, &model, high / 1.02),
                "arm {arm}"
            );
            let why = gate(&mut study, &gains, (low / 1.02, high / 1.02)).unwrap_err();
            assert!(why.contains("window.low ≤ arm.low"), "arm {arm}: {why}");
            let why = gate(&mut study, &gains, (low * 1.02, high * 1.02)).unwrap_err();
            assert!(why.contains("arm.high ≤ window.high"), "arm {arm}: {why}");
            assert!(
                !settles(record, &model, low / 1.02),
                "arm {arm}: refused below, and it settles"
            );
            assert!(
                !settles(record, &model, high * 1.02),
                "arm {arm}: refused above, and it settles"
            );
        }
    }
    println!("{armed} armed, {refused} refused, {edges} taken 2 % to both sides of both edges");
    assert!(armed > 150 && refused > 150 && edges > 80);
}

/// A chain of links with random lengths, masses, axes and shapes.
fn chain(random: &mut Random, joints: u32) -> String {
    let mut urdf = "<robot name=\"chain\"><link name=\"l0\"/>".to_owned();
    for i in 1..=joints {
        let (mass, length) = (random.around(0.3, 5.0), random.between(0.1, 0.5));
        let mut axis = [0.0; 3];
        axis[random.below(3) as usize] = 1.0;
        let i2 = mass * length * length * random.between(0.05, 0.2);
        let _ = write!(
            urdf,
            "<link name=\"l{i}\"><inertial><origin xyz=\"{} {} 0.02\"/><mass value=\"{mass}\"/><inertia ixx=\"{i2}\" \
             ixy=\"0\" ixz=\"0\" iyy=\"{i2}\" iyz=\"0\" izz=\"{i2}\"/></inertial></link><joint name=\"j{i}\" \
             type=\"revolute\"><parent link=\"l{}\"/><child link=\"l{i}\"/><origin xyz=\"{length} 0 0\"/>\
             <axis xyz=\"{} {} {}\"/><limit lower=\"-2.5\" upper=\"2.5\" effort=\"90\" velocity=\"5\"/></joint>",
            length / 2.0,
            random.between(-0.1, 0.1),
            i - 1,
            axis[0],
            axis[1],
            axis[2],
        );
    }
    urdf + "</robot>"
}

/// All joints of a frozen posture together, coupled by `M`, without gravity: whether a kick dies out.
fn coupled_settles(law: &[JointGains<f64>], mass: &DMatrix<f64>, model: &LoopModel) -> bool {
    let (n, t) = (law.len(), model.period_s);
    let inverse = mass.clone().try_inverse().unwrap();
    let mut states = vec![JointState::<f64>::new(); n];
    let mut lines: Vec<Delay<f64>> =
        (0..n).map(|_| Delay::new(model.delay_samples as usize).unwrap()).collect();
    let (mut q, mut dq) =
        (DVector::<f64>::zeros(n), DVector::from_fn(n, |i, _| 1e-3 / (i + 1) as f64));
    let mut applied = DVector::<f64>::zeros(n);
    let mut largest = [0.0_f64; 3];
    for slot in &mut largest {
        for _ in 0..LONG {
            for i in 0..n {
                let measurement = Measurement { q: q[i], dq: dq[i], tau_applied: applied[i] };
                let command = law[i].update(&mut states[i], &measurement, &Reference::default());
                applied[i] = lines[i].pass(command.tau);
            }
            let ddq = &inverse * &applied;
            q += &dq * t + &ddq * (0.5 * t * t);
            dq += &ddq * t;
            *slot = slot.max(q.amax() + 0.01 * dq.amax());
            if slot.is_nan() || *slot > 1e9 {
                return false;
            }
        }
    }
    largest[2] < largest[1] || largest[2] < 1e-14
}

#[test]
fn coupled_arms_that_are_armed_settle_in_every_posture() {
    let mut random = Random(25);
    let folder =
        PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(env!("CARGO_PKG_NAME")).join("random-arms");
    fs::create_dir_all(&folder).unwrap();
    let (mut armed, mut refused) = (0, 0);
    for arm in 0..60 {
        let joints = 2 + random.below(2);
        fs::write(folder.join("chain.urdf"), chain(&mut random, joints)).unwrap();
        let robot = "[robot]\nfile = \"chain.urdf\"";
        let loops = text(&mut random, robot, "", joints);
        let drives = ["drive_bandwidth_hz", "[world]", "velocity", "form"];
        let plain: Vec<&str> =
            loops.lines().filter(|l| !drives.iter().any(|d| l.starts_with(d))).collect();
        let (study, mut gains) = read(&(plain.join("\n") + "\n"), &folder);
        let model = study.robot.plant_model();
        let mut workspace = Workspace::new(&model);
        let n = joints as usize;
        let mut masses: Vec<DMatrix<f64>> = Vec::new();
        for _ in 0..300 {
            let q: Vec<f64> = (0..n).map(|_| random.between(-2.5, 2.5)).collect();
            let mut entries = vec![0.0; n * n];
            model.mass_matrix(&mut workspace, &q, &mut entries);
            masses.push(DMatrix::from_row_slice(n, n, &entries));
        }
        // M̄ around each joint's mean, so that some arms fit and some do not.
        let factor = random.around(0.4, 2.5);
        for (i, joint) in gains.joints.iter_mut().enumerate() {
            let mean = masses.iter().map(|m| m[(i, i)].ln()).sum::<f64>() / 300.0;
            joint.inertia_kg_m2 = factor * mean.exp();
        }
        if let Err(why) = arm_inside_window(&study, &Arm::of(&study).unwrap(), &gains) {
            refused += 1;
            assert!(why.to_string().contains("inertia window"), "{why}");
            continue;
        }
        armed += 1;
        let bar = DMatrix::from_fn(n, n, |i, j| {
            1.0 / (gains.joints[i].inertia_kg_m2 * gains.joints[j].inertia_kg_m2).sqrt()
        });
        let eigenvalues = |m: &DMatrix<f64>| m.component_mul(&bar).symmetric_eigenvalues();
        let by = |of: &dyn Fn(&DMatrix<f64>) -> f64| {
            masses.iter().max_by(|a, b| of(a).total_cmp(&of(b))).unwrap()
        };
        let names: Vec<String> = gains.joints.iter().map(|j| j.name.clone()).collect();
        let law = gains.joint_gains(&names, study.control.period_ns, Form::Observer).unwrap();
        let heaviest = by(&|m| eigenvalues(m).max());
        let lightest = by(&|m| -eigenvalues(m).min());
        for mass in [heaviest, lightest, &masses[0]] {
            let fine = coupled_settles(&law, mass, &LoopModel::from_study(&study, 0));
            assert!(fine, "arm {arm} was armed and diverges with M = {mass}");
        }
    }
    println!("{armed} coupled arms armed, {refused} refused");
    assert!(armed >= 10 && refused >= 10);
}
