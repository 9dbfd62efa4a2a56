//! The range of an arm's inertia: its ends are found, and can be looked at again.
//!
//! Wrong if some posture lies far outside the range, or a witness does not show what it says.

use core::f64::consts::PI;
use std::fmt::Write as _;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::DMatrix;
use phihat_design::{Arm, ArmInertia};
use phihat_model::{Robot, Rotor, Workspace};
use phihat_study::Study;

/// Number of folders that this process has made.
static COUNT: AtomicUsize = AtomicUsize::new(0);

/// A planar chain of equal links, endless joints.
fn chain(joints: usize) -> Study {
    let mut urdf = String::from("<robot name=\"chain\">\n<link name=\"base\"/>\n");
    for i in 0..joints {
        let (parent, x) =
            if i == 0 { ("base".to_owned(), 0.0) } else { (format!("l{}", i - 1), 0.3) };
        let _ = write!(
            urdf,
            "<link name=\"l{i}\"><inertial><origin xyz=\"0.15 0 0\"/><mass value=\"1\"/>\
             <inertia ixx=\"1e-4\" iyy=\"8e-3\" izz=\"8e-3\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\n\
             <joint name=\"j{i}\" type=\"continuous\"><parent link=\"{parent}\"/><child link=\"l{i}\"/>\
             <origin xyz=\"{x} 0 0\"/><axis xyz=\"0 0 1\"/></joint>\n"
        );
    }
    urdf += "</robot>\n";
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    let folder = std::env::temp_dir().join(format!("phihat_chain_{}_{count}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("chain.urdf"), urdf).unwrap();
    let study = read(
        "duration_s = 2.0\n[robot]\nfile = \"chain.urdf\"\narmature_kg_m2 = 0.1\n[spec]\nerror_bound_rad = \
         1e-3\n[design]\n[loop]\ntorque_max_nm = \"none\"\n[reference]\nkind = \"hold\"\nq_rad = 0.3\n",
        &folder,
    );
    std::fs::remove_dir_all(&folder).unwrap();
    study
}

fn read(text: &str, base: &Path) -> Study {
    Study::from_text(text, "range.toml", base).unwrap_or_else(|e| panic!("{}", e.render()))
}

fn named(robot: &str, design: &str) -> Study {
    let text = format!(
        "duration_s = 2.0\n[robot]\nname = \"{robot}\"\n[spec]\nerror_bound_rad = 1e-3\n[design]\n{design}\n\
         [reference]\nkind = \"hold\"\npose = \"ready\"\n"
    );
    read(&text, Path::new(""))
}

fn eigenvalues(robot: &Robot, q: &[f64], nominal: &[f64]) -> (f64, f64) {
    let (n, model) = (q.len(), robot.plant_model());
    let mut m = vec![0.0; n * n];
    model.mass_matrix(&mut Workspace::new(&model), q, &mut m);
    let w = DMatrix::from_fn(n, n, |i, j| m[i * n + j] / (nominal[i] * nominal[j]).sqrt());
    let all = w.symmetric_eigenvalues();
    (all.min(), all.max())
}

fn replayed(study: &Study, range: &ArmInertia) {
    let searched = range.searched.as_ref().unwrap();
    searched.replay(&study.robot, &range.nominal_kg_m2).unwrap();
    searched.agrees(range.low, range.high).unwrap();
    for (factor, low) in [(0.9, true), (1.1, true), (0.9, false), (1.1, false)] {
        let mut forged = searched.clone();
        let witness = if low { &mut forged.low } else { &mut forged.high };
        witness.eigenvalue *= factor;
        forged.replay(&study.robot, &range.nominal_kg_m2).unwrap_err();
        forged.agrees(range.low, range.high).unwrap_err();
    }
    for witness in [&searched.low, &searched.high] {
        for (q, joint) in witness.q.iter().zip(&study.robot.joints) {
            let (low, high) = joint.position.unwrap_or((-PI, PI));
            assert!(*q >= low && *q <= high, "{q} is outside {low} to {high}");
        }
    }
}

#[test]
fn a_long_chain_is_found_stretched() {
    for joints in [3, 12, 16] {
        let study = chain(joints);
        let range = Arm::of(&study).unwrap().against(vec![1.0; joints]).unwrap();
        let (_, stretched) = eigenvalues(&study.robot, &vec![0.0; joints], &vec![1.0; joints]);
        // All entries of M are largest there, and positive: so is its largest eigenvalue.
        assert!(range.high <= stretched * (1.0 + 1e-9));
        assert!(range.high > stretched * (1.0 - 1e-6), "{joints}: {} of {stretched}", range.high);
        replayed(&study, &range);
    }
}

#[test]
fn no_posture_of_a_dense_sample_lies_outside() {
    for (robot, joints) in [("planar3r", 3), ("panda", 7), ("ur5", 6)] {
        let study = named(robot, "");
        let arm = Arm::of(&study).unwrap();
        let range = arm.against(arm.nominal()).unwrap();
        replayed(&study, &range);
        let mut random = 7_u64;
        let mut unit = || {
            random = random
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (random >> 33) as f64 / f64::from(1_u32 << 31)
        };
        for _ in 0..20_000 {
            let q: Vec<f64> = (0..joints)
                .map(|j| {
                    let (low, high) = study.robot.joints[j].position.unwrap_or((-PI, PI));
                    low + (high - low) * unit()
                })
                .collect();
            let (low, high) = eigenvalues(&study.robot, &q, &range.nominal_kg_m2);
            assert!(low >= range.low * (1.0 - 1e-6), "{robot}: {low} below {}", range.low);
            assert!(high <= range.high * (1.0 + 1e-6), "{robot}: {high} above {}", range.high);
        }
    }
}

#[test]
fn every_payload_of_the_set_is_inside() {
    let set = "payload_kg = [0.0, 2.0]\npayload_com_m = [[-0.05, 0.05], [0.0, 0.1], [0.0, 0.1]]\n\
               payload_gyration_m = 0.05";
    let study = named("panda", set);
    let arm = Arm::of(&study).unwrap();
    let range = arm.against(arm.nominal()).unwrap();
    replayed(&study, &range);
    let high = &range.searched.as_ref().unwrap().high;
    assert!((high.mass_kg - 2.0).abs() < 1e-12);
    let mut light = high.clone();
    light.mass_kg = 1.0;
    light.inertia_kg_m2 = [0.0; 6];
    let frame = &study.design.payload.frame;
    let w = light.matrix((&study.robot, Rotor::Stated), frame, &range.nominal_kg_m2).unwrap();
    let lighter = DMatrix::from_row_slice(7, 7, &w).symmetric_eigenvalues().max();
    assert!(lighter < range.high);
    let bare = named("panda", "");
    let without = Arm::of(&bare).unwrap().against(range.nominal_kg_m2.clone()).unwrap();
    assert!(without.high < range.high && (without.low / range.low - 1.0).abs() < 1e-6);
}

#[test]
fn the_postures_of_the_reference_count() {
    let study = named("panda", "");
    let posture = study.robot.poses["ready"].clone();
    let arm = Arm::of(&study).unwrap().along(&[(posture, vec![0.1; 7])]).unwrap();
    let range = arm.against(arm.nominal()).unwrap();
    assert_eq!(range.searched.unwrap().of_reference, 1);
}

/// Two joints that make most of their inertia far from a motion whose postures, each with every corner of the
/// payload's box, are next best: they crowded out what the ends were sought from. The attack found it (seed
/// 1700, study 570).
const TWO_MAXIMA: &str = r#"<robot name="two"><link name="base"/>
<joint name="joint1" type="revolute"><parent link="base"/><child link="link1"/>
<origin xyz="0 0 0.1" rpy="1.5707963267948966 1.5707963267948966 0"/>
<axis xyz="0 0 1"/><limit lower="-2.32213" upper="2.5971" effort="25" velocity="2.8"/></joint>
<link name="link1"><inertial><origin xyz="0.02003 0.10158 0.01548" rpy="-0.63853 -0.86556 0.38769"/>
<mass value="0.73044"/>
<inertia ixx="0.0040937" ixy="0" ixz="0" iyy="0.0031743" iyz="0" izz="0.0024165"/></inertial></link>
<joint name="joint2" type="revolute"><parent link="link1"/><child link="link2"/><origin xyz="0 0.165085 0"/>
<axis xyz="0 1 0"/><limit lower="-1.83105" upper="2.564" effort="10" velocity="3.5"/></joint>
<link name="link2"><inertial><origin xyz="-0.03923 0.151115 -0.0067858" rpy="-0.81498 0.13269 -0.11472"/>
<mass value="0.66964"/>
<inertia ixx="0.0094274" ixy="0" ixz="0" iyy="0.0068921" iyz="0" izz="0.0085903"/></inertial></link>
<joint name="tool_joint" type="fixed"><parent link="link2"/><child link="tool"/><origin xyz="0 0.2659275 0"/></joint>
<link name="tool"/></robot>"#;

#[test]
fn no_corner_of_a_payloads_box_makes_more_inertia_than_was_found() {
    let folder = std::env::temp_dir().join(format!("phihat_two_maxima_{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("two.urdf"), TWO_MAXIMA).unwrap();
    let study = read(
        "duration_s = 2.0\n[robot]\nfile = \"two.urdf\"\narmature_kg_m2 = [0.26443, 0.056244]\n[spec]\nerror_bound_rad \
         = 1e-3\n[design]\npayload_gyration_m = 0.017092\npayload_kg = [0.0, 0.097034]\npayload_frame = \"tool\"\n\
         payload_com_m = [[-0.041266, 0.027101], [0.024153, 0.09252], [-0.001468, 0.0669]]\n[reference]\nkind = \
         \"hold\"\nq_rad = 0.3\n",
        &folder,
    );
    std::fs::remove_dir_all(&folder).unwrap();
    let passed = |k: u16| {
        let swing = (f64::from(k) * 0.1).sin();
        (vec![-0.376 + 0.06 * swing, -0.452 + 0.034 * swing], vec![0.0; 2])
    };
    let reference: Vec<_> = (0..200).map(passed).collect();
    let arm = Arm::of(&study).unwrap().along(&reference).unwrap();
    let range = arm.against(vec![0.2751, 0.0565]).unwrap();
    let mut most = 0.0_f64;
    for body in study.design.payload.heaviest() {
        let model = study.robot.plant_model_at(Rotor::Most);
        let model = model.with_payload_on("tool", &body).unwrap();
        let mut workspace = Workspace::new(&model);
        for k in 0..=2000_u16 {
            // The first joint turns all of it.
            let q = [0.0, -1.83105 + 4.39505 * f64::from(k) / 2000.0];
            let mut m = [0.0; 4];
            model.mass_matrix(&mut workspace, &q, &mut m);
            let (a, b, c) = (m[0] / 0.2751, m[3] / 0.0565, m[1] / (0.2751_f64 * 0.0565).sqrt());
            most = most.max(0.5 * (a + b) + (0.25 * (a - b) * (a - b) + c * c).sqrt());
        }
    }
    assert!(range.high >= most * (1.0 - 1e-9) && range.high < 1.001 * most, "{range:?} {most}");
}
