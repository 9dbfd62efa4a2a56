//! Nothing that is not a number opens the gate before a run. Wrong if some M̄, rotor, mass or limit at the end of the
//! floating-point range arms, or if a range of inertia comes out that is none.

use std::path::Path;

use phihat_design::{Arm, ArmInertia, Gains, arm_inside_window, requested_gains};
use phihat_model::{JointKind, Robot};
use phihat_study::Study;

const EXTREME: [f64; 18] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    1e308,
    1e300,
    1e200,
    1e160,
    1e100,
    1e20,
    1e-20,
    1e-100,
    1e-160,
    1e-200,
    1e-300,
    5e-324,
    0.0,
    -1.0,
];

fn study(robot: &str, base: &Path) -> Study {
    let text = format!(
        "duration_s = 2.0\n[robot]\n{robot}\n[design]\npayload_max_kg = 1.0\n[gains]\nkp_per_s2 = 144.0\n\
         kd_per_s = 24.0\na = [40.0]\ninertia_kg_m2 = 1.0\n[loop]\ndelay_samples = 1\n\
         [sensor]\nvelocity = \"differenced\"\nvelocity_filter_hz = 200.0\n[reference]\nkind = \"hold\"\n\
         q_rad = 0.3\n"
    );
    Study::from_text(&text, "gate.toml", base).unwrap_or_else(|e| panic!("{}", e.render()))
}

/// The study's gains with the arm's own nominal inertias.
fn gains(study: &Study, arm: &Arm) -> Gains {
    let mut gains = requested_gains(study).unwrap();
    for (joint, nominal) in gains.joints.iter_mut().zip(arm.nominal()) {
        joint.inertia_kg_m2 = nominal;
    }
    gains
}

fn is_a_range(range: &ArmInertia) -> bool {
    0.0 < range.low && range.low <= range.high && range.high < f64::INFINITY
}

#[test]
fn no_nominal_inertia_at_the_end_of_the_numbers_arms() {
    let study = study("name = \"planar3r\"", Path::new(""));
    let arm = Arm::of(&study).unwrap();
    let good = gains(&study, &arm);
    arm_inside_window(&study, &arm, &good).unwrap();
    // One joint, another, all of them; in the short version the first one and all.
    let each = if std::env::var_os("PHIHAT_ALL").is_some() { 1 } else { good.joints.len() };
    for extreme in EXTREME {
        for which in (0..=good.joints.len()).step_by(each) {
            let mut bad = good.clone();
            for (i, joint) in bad.joints.iter_mut().enumerate() {
                if which == i || which == good.joints.len() {
                    joint.inertia_kg_m2 = extreme;
                }
            }
            let refused = arm_inside_window(&study, &arm, &bad);
            assert!(refused.is_err(), "M̄ = {extreme:e} on joint {which} arms");
            let nominal = bad.joints.iter().map(|joint| joint.inertia_kg_m2).collect();
            if let Ok(range) = arm.against(nominal) {
                assert!(is_a_range(&range), "{extreme:e}: {} … {}", range.low, range.high);
            }
        }
    }
}

#[test]
fn no_rotor_and_no_link_at_the_end_of_the_numbers_arms() {
    let mut robot = study("name = \"planar3r\"", Path::new(""));
    let arm = Arm::of(&robot).unwrap();
    let good = gains(&robot, &arm);
    for armature in [f64::MAX, 1e308, 1e300, 1e160, 1e100, 1e20] {
        for joint in 0..robot.robot.joints.len() {
            let before = core::mem::replace(&mut robot.robot.joints[joint].armature, armature);
            if let Ok(arm) = Arm::of(&robot) {
                assert!(arm_inside_window(&robot, &arm, &good).is_err(), "rotor {armature:e}");
                assert!(
                    arm.against(arm.nominal()).is_ok_and(|r| is_a_range(&r)) || armature > 1e10
                );
            }
            robot.robot.joints[joint].armature = before;
        }
    }
}

/// A revolute joint after the base, then another; both with these limits.
fn arm_with(kind: &str, limits: &str, mass: &str) -> String {
    let link = |name: &str| {
        format!(
            "<link name=\"{name}\"><inertial><origin xyz=\"0.2 0 0\"/><mass value=\"{mass}\"/><inertia ixx=\"0.01\" \
             iyy=\"0.02\" izz=\"0.02\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\n"
        )
    };
    let joint = |name: &str, kind: &str, parent: &str, child: &str| {
        format!(
            "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/>\
             <origin xyz=\"0.4 0 0\"/><axis xyz=\"0 0 1\"/><limit {limits}/></joint>\n"
        )
    };
    format!(
        "<robot name=\"wide\">\n<link name=\"base\"/>\n{}{}{}{}</robot>\n",
        link("one"),
        link("two"),
        joint("first", "revolute", "base", "one"),
        joint("second", kind, "one", "two")
    )
}

#[test]
fn limits_that_say_unlimited_are_read_as_none() {
    let wide = "lower=\"-1.7976931348623157e308\" upper=\"1.7976931348623157e308\" effort=\"1e308\" velocity=\"1e300\"";
    let robot = Robot::from_text(&arm_with("revolute", wide, "1"), None, "wide.urdf").unwrap();
    for joint in &robot.joints {
        assert_eq!((joint.kind, joint.position), (JointKind::Continuous, None));
        assert_eq!((joint.torque_max, joint.velocity_max), (None, None));
    }
    assert!(robot.warnings.iter().any(|warning| warning.contains("turns without end")));
    let why = Robot::from_text(&arm_with("prismatic", wide, "1"), None, "wide.urdf").unwrap_err();
    assert!(why.to_string().contains("travel in metres"), "{why}");

    let folder = std::env::temp_dir().join(format!("phihat_wide_{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let range = |urdf: &str| {
        std::fs::write(folder.join("wide.urdf"), urdf).unwrap();
        let text = "file = \"wide.urdf\"\narmature_kg_m2 = 0.1";
        Arm::of(&study(text, &folder)).and_then(|arm| arm.against(arm.nominal()))
    };
    let found = range(&arm_with("revolute", wide, "1")).unwrap();
    let turns = "lower=\"-3.2\" upper=\"3.2\" effort=\"10\" velocity=\"2\"";
    let same = range(&arm_with("revolute", turns, "1")).unwrap();
    assert!(is_a_range(&found));
    assert!(
        (found.high / same.high - 1.0).abs() < 1e-6 && (found.low / same.low - 1.0).abs() < 1e-6
    );
    // Masses that no link has: an error, or a range; never a range of nothing.
    for mass in ["1e308", "1e200", "1e155", "1e-200", "1e-308"] {
        if let Ok(range) = range(&arm_with("revolute", turns, mass)) {
            assert!(is_a_range(&range), "{mass} kg");
        }
    }
    std::fs::remove_dir_all(&folder).unwrap();
}
