//! An arm cut out of a larger robot is that robot with all else locked, and what cannot be cut is named.

use phihat_model::{Part, Robot, Workspace};

const PANDA: &str = include_str!("../robots/panda.urdf");

fn named(base: &str, tip: &str, locked: &[(&str, f64)]) -> Part {
    Part {
        base: Some(base.to_owned()),
        tip: Some(tip.to_owned()),
        joints: None,
        locked: locked.iter().map(|(name, at)| ((*name).to_owned(), *at)).collect(),
    }
}

/// Torque of a motion, which holds mass matrix, Coriolis torque and gravity.
fn torque(robot: &Robot) -> Vec<f64> {
    let n = robot.joints.len();
    let jet = |scale: f64| (0..n).map(|i| scale * (1.0 + 0.3 * i as f64).sin()).collect::<Vec<_>>();
    let mut tau = vec![0.0; n];
    let mut workspace = Workspace::new(&robot.model);
    robot.model.inverse_dynamics(&mut workspace, &jet(0.7), &jet(1.1), &jet(-2.3), &mut tau);
    tau
}

#[test]
fn a_part_is_the_whole_with_the_rest_locked() {
    let rest = [("panda_joint1", 0.4), ("panda_joint2", -0.3), ("panda_joint7", 0.9)];
    let part =
        Robot::part_of_text(PANDA, &named("panda_link2", "panda_link6", &rest), "p").unwrap();
    assert_eq!(part.joints.len(), 4);
    let locks = rest.map(|(name, at)| (name.to_owned(), at));
    let whole = Robot::from_text(PANDA, None, "p").unwrap().lock(&locks).unwrap();
    assert_eq!(part.model.joint_names(), whole.model.joint_names());
    for (a, b) in torque(&part).iter().zip(torque(&whole)) {
        assert!((a - b).abs() < 1e-13, "{a} {b}");
    }
    // Not stated: as near to 0 as the limits let it, and said.
    let part = Robot::part_of_text(PANDA, &named("panda_link0", "panda_link3", &[]), "p").unwrap();
    assert!(
        part.warnings.iter().any(|w| w.contains("\"panda_joint4\" at -0.06")),
        "{:?}",
        part.warnings
    );
}

/// Two arms on a waist, each with a gripper whose second finger follows the first.
fn two_arms() -> String {
    let body = crate::support::inertial(1.0, [0.1; 3], [0.1, 0.0, 0.0, 0.1, 0.0, 0.1]);
    let mut parts = vec![crate::support::link("world", ""), crate::support::link("base", &body)];
    let mut joint = |name: &str, kind: &str, ends: [&str; 2], more: &str| {
        let axis = if kind == "prismatic" { "1 0 0" } else { "0 1 0" };
        let text = crate::support::joint(name, kind, ends, "0 0 0.2", axis);
        parts.push(text.replace("</joint>", &format!("{more}</joint>")));
        if ends[1] != "base" {
            parts.push(crate::support::link(ends[1], &body));
        }
    };
    joint("floats", "floating", ["world", "base"], "");
    joint("waist", "revolute", ["base", "torso"], "");
    for side in ["left", "right"] {
        let name = |what: &str| format!("{side}_{what}");
        let mut before = "torso".to_owned();
        for what in ["shoulder", "elbow", "wrist"] {
            joint(&name(what), "revolute", [&before, &name(&format!("{what}_link"))], "");
            before = name(&format!("{what}_link"));
        }
        joint(&name("flange"), "fixed", [&before, &name("tool0")], "");
        joint(&name("finger"), "prismatic", [&before, &name("finger_link")], "");
        let follows = format!("<mimic joint=\"{side}_finger\" multiplier=\"-2\" offset=\"0.5\"/>");
        joint(&name("other_finger"), "prismatic", [&before, &name("other_finger_link")], &follows);
    }
    format!("<robot name=\"two\">{}</robot>", parts.concat())
}

#[test]
fn chains_end_before_the_fingers_and_the_longest_comes_first() {
    let chains = Robot::chains_of_text(&two_arms(), "two").unwrap();
    let found: Vec<_> = chains.iter().map(|c| (&*c.base, &*c.tip, c.joints.len())).collect();
    assert_eq!(found, [("base", "left_tool0", 4), ("base", "right_tool0", 4)]);
    assert_eq!(chains[1].joints, ["waist", "right_shoulder", "right_elbow", "right_wrist"]);
}

#[test]
fn a_finger_from_its_root_on_is_an_arm_of_all_its_joints() {
    let body = crate::support::inertial(1.0, [0.1; 3], [0.1, 0.0, 0.0, 0.1, 0.0, 0.1]);
    let of = |names: [&str; 3]| {
        let (mut parts, mut before) = (vec![crate::support::link("root", "")], "root".to_owned());
        for name in names {
            let link = format!("{name}_link");
            let ends = [&*before, &*link];
            parts.push(crate::support::joint(name, "revolute", ends, "0 0 0.2", "0 1 0"));
            parts.push(crate::support::link(&link, &body));
            before = link;
        }
        let text = format!("<robot name=\"one\">{}</robot>", parts.concat());
        let chains = Robot::chains_of_text(&text, "one").unwrap();
        chains.into_iter().map(|chain| chain.joints.len()).collect::<Vec<_>>()
    };
    assert_eq!(of(["finger_base", "finger_middle", "finger_tip"]), [3]);
    assert_eq!(of(["thumb_a", "thumb_b", "thumb_c"]), [3]);
    // What is carried by an arm stays behind its end.
    assert_eq!(of(["elbow", "wrist", "finger"]), [2]);
    assert_eq!(of(["elbow", "finger_near", "finger_far"]), [1]);
}

#[test]
fn what_follows_stands_where_its_leader_puts_it() {
    let text = two_arms();
    let at = |finger: f64, other: Option<f64>| {
        let mut part = named("torso", "left_tool0", &[("left_finger", finger)]);
        part.locked.extend(other.map(|other| ("left_other_finger".to_owned(), other)));
        Robot::part_of_text(&text, &part, "two").unwrap()
    };
    let followed = at(0.1, None);
    assert_eq!(followed.tip, "left_tool0");
    for (a, b) in torque(&followed).iter().zip(torque(&at(0.1, Some(0.3)))) {
        assert!((a - b).abs() < 1e-12, "{a} {b}");
    }
    assert_ne!(torque(&followed), torque(&at(0.1, Some(0.0))));
    let all = Robot::from_text(&text, None, "two").unwrap();
    assert_eq!(all.joints.len(), 1 + 2 * 4);
    let told = all.warnings.join("\n");
    assert!(told.contains("2 joint(s) following others") && told.contains("floating"), "{told}");
}

#[test]
fn what_cannot_be_cut_is_named() {
    let text = two_arms();
    for (part, clues) in [
        (named("torso", "left_tool", &[]), ["\"left_tool\"", "did you mean \"left_tool0\"?"]),
        (named("left_elbow_link", "right_tool0", &[]), ["\"right_tool0\"", "not carried"]),
        (named("left_wrist_link", "left_tool0", &[]), ["no joint moves", "\"left_tool0\""]),
        (named("torso", "left_tool0", &[("waits", 0.0)]), ["\"waits\"", "\"waist\"?"]),
        (named("torso", "left_tool0", &[("waist", 99.0)]), ["\"waist\"", "outside its limits"]),
        (named("torso", "left_tool0", &[("floats", 0.0)]), ["\"floats\"", "no position"]),
        (
            Part { joints: Some(vec!["left_other_finger".to_owned()]), ..Part::default() },
            ["\"left_other_finger\"", "follows"],
        ),
    ] {
        let message = Robot::part_of_text(&text, &part, "two").unwrap_err().to_string();
        assert!(clues.iter().all(|clue| message.contains(clue)), "{message}");
    }
}

#[test]
fn a_tip_that_stands_still_is_no_tip() {
    let toml = |tip: &str| {
        let joints = ["waist", "left_shoulder", "left_elbow", "left_wrist", "left_finger"];
        let more = ["right_shoulder", "right_elbow", "right_wrist", "right_finger"];
        format!(
            "name = \"two\"\ndescription = \"\"\nurdf = \"two.urdf\"\ntip = \"{tip}\"\nlicence = \"\"\nprovenance = \
             \"\"\njoints = {:?}\n",
            [&joints[..], &more].concat()
        )
    };
    let read = |tip: &str| Robot::from_text(&two_arms(), Some(&toml(tip)), "two");
    let why = read("base").unwrap_err().to_string();
    assert!(
        why.contains("tip: no joint moves link \"base\"") && why.contains("left_tool0"),
        "{why}"
    );
    // One arm locked, with the waist: the other still moves, but not this arm's tip.
    let two = read("left_tool0").unwrap();
    let lock = |names: &[&str]| {
        let at = |name: &&str| ((*name).to_owned(), 0.0);
        two.clone().lock(&names.iter().map(at).collect::<Vec<_>>())
    };
    let left = ["left_shoulder", "left_elbow", "left_wrist", "waist"];
    assert_eq!(lock(&left[..3]).unwrap().joints.len(), 6);
    let why = lock(&left).unwrap_err().to_string();
    assert!(why.contains("\"waist\"") && why.contains("tip \"left_tool0\""), "{why}");
}
