//! MJCF: what is read, under which names; what is refused, with its line. That the dynamics are MuJoCo's is
//! tested from Python (`crates/phihat-py/tests/test_mjcf.py`), on these files and on random ones. Fails
//! where a value, a name or a limit is read otherwise than MuJoCo's reference has it, where a refusal does
//! not name its element, or where a hostile file is costly.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use phihat_model::{JointKind, Part, Robot, Workspace};

fn files() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/mjcf")
}

fn read(text: &str) -> Robot {
    Robot::from_text(text, None, "arm.xml").unwrap()
}

fn why(text: &str) -> String {
    Robot::from_text(text, None, "arm.xml").unwrap_err().to_string()
}

/// Two joints: everything that a mistake is made in.
const GOOD: &str = r#"<mujoco model="good">
<compiler angle="radian" autolimits="true"/>
<default><joint damping="0.5"/><default class="small"><geom density="500"/></default></default>
<worldbody><body name="upper" childclass="small">
<inertial mass="2" pos="0 0 0.1" diaginertia="0.02 0.02 0.01"/>
<joint name="lift" axis="0 1 0" range="-1 2" armature="0.1" frictionloss="0.3"/>
<body name="fore" pos="0 0 0.4">
<joint name="bend" axis="0 1 0" range="-2 2" pos="0 0 0"/>
<geom name="rod" type="capsule" size="0.04" fromto="0 0 0 0 0 0.3"/><site name="tool" pos="0 0 0.3"/>
</body></body></worldbody>
<actuator><motor joint="lift" gear="50" ctrlrange="-1 1"/>
<position joint="bend" kp="100" ctrlrange="-3 3" forcerange="-12 12"/></actuator>
</mujoco>"#;

#[test]
fn a_plain_file_has_the_numbers_that_it_states() {
    let arm = read(GOOD);
    assert_eq!((&*arm.name, arm.joint_names().join(" ")), ("good", "lift bend".to_owned()));
    assert_eq!(arm.tip, "tool");
    assert_eq!(arm.model.frame_names(), ["world", "upper", "fore", "tool"]);
    let [lift, bend] = &arm.joints[..] else { panic!() };
    assert_eq!((lift.position, bend.position), (Some((-1.0, 2.0)), Some((-2.0, 2.0))));
    assert_eq!((lift.armature, lift.friction.viscous, lift.friction.coulomb), (0.1, 0.5, 0.3));
    // A motor's control times its gear; a servo's force, never its control.
    assert_eq!((lift.torque_max, bend.torque_max), (Some(50.0), Some(12.0)));
    assert!(arm.warnings.is_empty(), "{:?}", arm.warnings);
    // The rod stretched out level, about its joint: a cylinder and two half balls of 500 kg/m³, by hand.
    let (radius, length) = (0.04_f64, 0.3);
    let tube = 500.0 * core::f64::consts::PI * radius * radius * length;
    let ball = 500.0 * core::f64::consts::PI * 4.0 / 3.0 * radius.powi(3);
    let mut tau = [0.0; 2];
    let level = [core::f64::consts::FRAC_PI_2, 0.0];
    arm.model.gravity_torque(&mut Workspace::new(&arm.model), &level, &mut tau);
    assert!((tau[1].abs() - 9.81 * (tube + ball) * 0.5 * length).abs() < 1e-12);
}

/// Mistakes: text of the good one, its replacement, and words of the message.
const MISTAKES: &[(&str, &str, &[&str])] = &[
    ("angle=\"radian\"", "angle=\"turns\"", &["arm.xml:2:", "<compiler>", "radian"]),
    ("angle=\"radian\"", "coordinate=\"global\"", &[":2:", "global"]),
    ("angle=\"radian\"", "eulerseq=\"xyw\"", &[":2:", "eulerseq"]),
    ("childclass=\"small\"", "childclass=\"large\"", &[":4:", "\"upper\"", "\"large\""]),
    ("class=\"small\"><geom", "class=\"main\"><geom", &[":3:", "main"]),
    ("mass=\"2\" ", "", &[":5:", "<inertial>", "mass"]),
    ("mass=\"2\"", "mass=\"two\"", &[":5:", "mass=\"two\"", "numbers"]),
    ("mass=\"2\"", "mass=\"-2\"", &[":4:", "\"upper\"", "-2"]),
    ("0.02 0.02 0.01", "0.02 0.01", &[":5:", "diaginertia", "2 numbers", "3"]),
    ("0.02 0.02 0.01", "0.02 -0.02 0.01", &[":4:", "\"upper\"", "principal"]),
    ("name=\"lift\" axis=\"0 1 0\"", "name=\"lift\" axis=\"0 0 0\"", &[":6:", "\"lift\"", "axis"]),
    ("name=\"lift\" axis", "name=\"lift\" type=\"screw\" axis", &[":6:", "\"lift\"", "screw"]),
    ("armature=\"0.1\"", "armature=\"-0.1\"", &[":6:", "\"lift\"", "armature"]),
    ("armature=\"0.1\"", "class=\"none\"", &[":6:", "\"lift\"", "\"none\""]),
    ("range=\"-1 2\"", "range=\"2 -1\"", &[":6:", "\"lift\"", "below"]),
    ("range=\"-1 2\"", "range=\"2\"", &[":6:", "\"lift\"", "range", "2"]),
    (
        "name=\"lift\" axis",
        "name=\"lift\" type=\"slide\" limited=\"false\" axis",
        &[":6:", "slides without ends"],
    ),
    ("joint name=\"bend\"", "joint name=\"lift\"", &[":8:", "\"lift\"", "another"]),
    ("body name=\"fore\"", "body name=\"upper\"", &["\"upper\""]),
    ("type=\"capsule\"", "type=\"mesh\" mesh=\"m\"", &[":9:", "\"rod\"", "a mesh", "<inertial>"]),
    ("type=\"capsule\"", "type=\"cone\"", &[":9:", "\"rod\""]),
    ("type=\"capsule\"", "type=\"capsule\" shellinertia=\"true\"", &[":9:", "a shell"]),
    ("size=\"0.04\"", "size=\"-0.04\"", &[":9:", "\"rod\"", "above 0"]),
    ("0 0 0 0 0 0.3", "0 0 0.3 0 0 0.3", &[":9:", "fromto"]),
    (
        "<site name=\"tool\"",
        "<replicate count=\"3\"/><site name=\"tool\"",
        &[":9:", "<replicate>", "compile"],
    ),
    (
        "<site name=\"tool\"",
        "<attach model=\"m\" prefix=\"p\"/><site name=\"tool\"",
        &["<attach>", "compile"],
    ),
    ("<site name=\"tool\"", "<composite type=\"cable\"/><site name=\"tool\"", &["<composite>"]),
    ("<site name=\"tool\"", "<flexcomp name=\"f\"/><site name=\"tool\"", &["<flexcomp>", "rigid"]),
    ("<site name=\"tool\"", "<site quat=\"0 0 0 0\" name=\"tool\"", &[":9:", "\"tool\"", "zeros"]),
    (
        "<site name=\"tool\"",
        "<site euler=\"0 0 1\" quat=\"1 0 0 0\" name=\"tool\"",
        &["more than one way"],
    ),
    (
        "<site name=\"tool\"",
        "<include file=\"x.xml\"/><site name=\"tool\"",
        &[":9:", "<include>", "file"],
    ),
    ("gear=\"50\"", "gear=\"a lot\"", &[":11:", "<motor>", "gear"]),
];

#[test]
fn mistakes_are_refused_by_name_and_line() {
    for (right, wrong, words) in MISTAKES {
        assert!(GOOD.contains(right), "{right}");
        let why = why(&GOOD.replacen(right, wrong, 1));
        for word in *words {
            assert!(why.contains(word), "{wrong}: {why}: {word}");
        }
    }
    let part = Robot::from_text("<mujocoinclude/>", None, "part.xml").unwrap_err().to_string();
    assert!(part.contains("the file that includes it"), "{part}");
}

#[test]
fn what_is_left_out_is_said() {
    for (right, written, words) in [
        ("frictionloss", "stiffness=\"3\" frictionloss", "its spring"),
        ("frictionloss", "springdamper=\"1 1\" frictionloss", "its spring"),
        ("body name=\"fore\"", "body gravcomp=\"1\" name=\"fore\"", "gravcomp"),
        ("<default>", "<option gravity=\"0 0 0\"/><default>", "gravity_m_s2"),
        ("<default>", "<option viscosity=\"1\"/><default>", "drag"),
        ("<actuator>", "<tendon><fixed armature=\"1\"/></tendon><actuator>", "tendons"),
        (
            "<actuator>",
            "<equality><weld body1=\"fore\"/></equality><actuator>",
            "<weld> (line 11) of fore",
        ),
        ("gear=\"50\" ctrlrange=\"-1 1\"", "ctrlrange=\"0 9\"", "one way only"),
        ("angle=\"radian\" ", "", "<compiler angle=\"radian\"/>"),
        ("range=\"-1 2\"", "range=\"-57 114\"", "<compiler angle=\"degree\"/>"),
    ] {
        let arm = read(&GOOD.replacen(right, written, 1));
        assert!(arm.warnings.iter().any(|own| own.contains(words)), "{words}: {:?}", arm.warnings);
    }
}

#[test]
fn a_scene_has_its_chains_and_gives_one_by_a_site_a_body_or_a_joint() {
    let arm = |side: &str, y: f64| {
        format!(
            r#"<body name="{side}_base" pos="0 {y} 0"><body name="{side}_arm">
            <joint name="{side}_turn"/><geom size="0.1" pos="0.2 0 0"/>
            <body name="{side}_hand" pos="0.3 0 0"><joint name="{side}_lift" axis="0 1 0"/>
            <geom size="0.05" pos="0.1 0 0"/><site name="{side}_tcp" pos="0.2 0 0"/></body></body></body>"#
        )
    };
    let scene = format!(
        r#"<mujoco><worldbody><geom type="plane" size="1 1 1"/>{}{}
        <body name="cup"><freejoint/><geom size="0.04"/></body></worldbody></mujoco>"#,
        arm("left", 0.3),
        arm("right", -0.3)
    );
    let chains = Robot::chains_of_text(&scene, "scene.xml").unwrap();
    let tips: Vec<&str> = chains.iter().map(|chain| &*chain.tip).collect();
    assert_eq!(tips, ["left_tcp", "right_tcp"]);
    for (asked, tip) in
        [("right_tcp", "right_tcp"), ("right_hand", "right_hand"), ("right_lift", "right_hand")]
    {
        let part = Part { tip: Some(asked.to_owned()), ..Part::default() };
        let robot = Robot::part_of_text(&scene, &part, "scene.xml").unwrap();
        assert_eq!(robot.joint_names(), ["right_turn", "right_lift"]);
        assert_eq!(robot.tip, tip);
        assert!(robot.warnings.iter().any(|own| own.contains("free, held fixed")));
    }
}

#[test]
fn joints_that_no_drive_moves_in_one_way_are_named_inside_of_an_arm() {
    let ball = GOOD.replace("name=\"bend\"", "type=\"ball\" name=\"bend\"");
    let behind = ball.replace(
        "<site",
        "<body name=\"last\"><joint name=\"end\"/><geom size=\"0.1\"/></body><site",
    );
    let why = why(&behind);
    assert!(why.contains("\"bend\"") && why.contains("a ball") && why.contains("\"end\""), "{why}");
    // Behind the last joint it is held.
    let arm = read(&ball);
    assert_eq!(arm.joint_names(), ["lift"]);
    assert!(arm.warnings.iter().any(|own| own.contains("a ball, held fixed")));
}

#[test]
fn names_that_are_missing_are_numbers() {
    let text = GOOD.replace("name=\"fore\"", "").replace("name=\"lift\"", "");
    let arm = read(&text.replace("joint=\"lift\"", "joint=\"none\""));
    assert_eq!(arm.joint_names(), ["joint0", "bend"]);
    assert_eq!(arm.model.frame_names(), ["world", "upper", "body2", "tool"]);
    assert_eq!(arm.joints[0].torque_max, None);
}

#[test]
fn an_anchor_and_a_reference_are_read_as_mujoco_does() {
    // Turned by q − ref about an anchor: by hand, at a quarter turn beyond the reference.
    let text = r#"<mujoco><compiler angle="degree"/><worldbody><body name="arm" pos="1 0 0">
        <joint name="turn" axis="0 0 1" pos="0 0.5 0" ref="30"/><geom size="0.1"/></body></worldbody></mujoco>"#;
    let arm = read(text);
    assert_eq!(arm.joints[0].kind, JointKind::Continuous);
    let mut workspace = Workspace::new(&arm.model);
    let frame = arm.model.frame("arm").unwrap();
    arm.model.forward_kinematics(&mut workspace, &[120.0_f64.to_radians()]);
    let pose = arm.model.pose(&workspace, frame);
    assert!(pose.p.iter().zip([1.5, 0.5, 0.0]).all(|(a, b)| (a - b).abs() < 1e-14), "{:?}", pose.p);
}

#[test]
fn followers_and_postures() {
    let fingers = r#"<mujoco><worldbody><body name="arm"><joint name="lift" axis="0 1 0" range="-90 90"/>
        <geom size="0.1" pos="0.3 0 0"/>
        <body name="a"><joint name="open" type="slide" range="0 0.04"/><geom size="0.02"/></body>
        <body name="b"><joint name="close" type="slide" range="0 0.08" ref="0.01"/><geom size="0.02"/></body>
        </body></worldbody>
        <equality><joint joint1="close" joint2="open" polycoef="0 2 0 0 0"/></equality>
        <keyframe><key name="home" qpos="0.5 0.02 0.05"/><key name="short" qpos="1"/></keyframe></mujoco>"#;
    let part = Part { tip: Some("arm".to_owned()), ..Part::default() };
    let arm = Robot::part_of_text(fingers, &part, "hand.xml").unwrap();
    assert_eq!(arm.joint_names(), ["lift"]);
    assert_eq!((arm.held["open"], arm.held["close"]), (0.0, 0.01));
    assert!(arm.warnings.iter().any(|own| own.contains("(<equality>)")), "{:?}", arm.warnings);
    assert_eq!(arm.poses.keys().collect::<Vec<_>>(), ["home"]);
    assert_eq!(arm.poses["home"], [0.5]);
    let part = Part { locked: [("open".to_owned(), 0.03)].into(), ..part };
    let arm = Robot::part_of_text(fingers, &part, "hand.xml").unwrap();
    assert!((arm.held["close"] - 0.07).abs() < 1e-15);
}

#[test]
fn limits_of_actuators_add_up_and_the_joint_has_the_last_word() {
    let with = |actuators: &str, joint: &str| {
        let text =
            GOOD.replacen("<motor joint=\"lift\" gear=\"50\" ctrlrange=\"-1 1\"/>", actuators, 1);
        read(&text.replacen("armature=\"0.1\"", joint, 1)).joints[0].clone()
    };
    let motor = "<motor joint=\"lift\" gear=\"-10\" ctrlrange=\"-2 3\"/>";
    assert_eq!(with(motor, "").torque_max, Some(20.0));
    assert_eq!(with(&motor.repeat(2), "").torque_max, Some(40.0));
    assert_eq!(with(&motor.repeat(2), "actuatorfrcrange=\"-15 15\"").torque_max, Some(15.0));
    let forced = motor.replace("ctrlrange", "forcerange=\"-1 1\" ctrlrange");
    assert_eq!(with(&forced, "").torque_max, Some(10.0));
    assert_eq!(with("<velocity joint=\"lift\" kv=\"3\" ctrlrange=\"-2 3\"/>", "").torque_max, None);
    let unlimited = motor.replace("ctrlrange", "ctrllimited=\"false\" ctrlrange");
    assert_eq!(with(&(unlimited + motor), "").torque_max, None);
    // A geared rotor and its damping.
    let geared =
        with(&motor.replace("gear", "armature=\"1e-3\" damping=\"0.02\" gear"), "armature=\"0.1\"");
    assert!((geared.armature - 0.2).abs() < 1e-15);
    assert!((geared.friction.viscous - 2.5).abs() < 1e-14);
}

/// A folder of its own, removed when dropped.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str, files: &[(&str, &str)]) -> Self {
        let path = std::env::temp_dir().join(format!("phihat-mjcf-{}-{name}", std::process::id()));
        for (file, text) in files {
            let file = path.join(file);
            fs::create_dir_all(file.parent().unwrap()).unwrap();
            fs::write(file, text).unwrap();
        }
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[test]
fn files_are_included_from_the_main_folder_or_their_own() {
    let body = r#"<body name="fore" pos="0 0 0.4"><joint name="bend" axis="0 1 0"/><include file="rod.xml"/></body>"#;
    let main = GOOD.split("<body name=\"fore\"").next().unwrap().to_owned()
        + "<include file=\"parts/fore.xml\"/></body></worldbody></mujoco>";
    let folder = Folder::new(
        "include",
        &[
            ("arm.xml", &main),
            ("parts/fore.xml", &format!("<mujoco>\n{body}\n</mujoco>")),
            (
                "parts/rod.xml",
                "<mujocoinclude><geom class=\"small\" size=\"0.1\"/></mujocoinclude>",
            ),
            ("lost.xml", "<mujoco><include file=\"none.xml\"/></mujoco>"),
            ("turn.xml", "<mujoco>\n<include file=\"turn.xml\"/></mujoco>"),
            ("above.xml", "<mujoco>\n<include file=\"../arm.xml\"/></mujoco>"),
            ("broken.xml", "<mujoco><include file=\"parts/broken.xml\"/></mujoco>"),
            ("parts/broken.xml", "<mujoco>\n<geom></mujoco>"),
        ],
    );
    let file = folder.0.join("arm.xml");
    let arm = Robot::read(&file).unwrap();
    assert_eq!(arm.joint_names(), ["lift", "bend"]);
    let parts = ["parts/fore.xml", "parts/rod.xml"].map(|part| folder.0.join(part));
    assert_eq!(arm.files, [&[file.clone()][..], &parts].concat());
    assert_eq!(arm.bare_file(), Some(&*file));
    // Put in its place, it is the same arm.
    let (flat, extension) =
        Robot::description_text(&phihat_model::NamedTexts::DISK, &file).unwrap();
    assert_eq!((extension, flat.contains("include")), ("xml", false));
    let again = read(&flat);
    assert_eq!(again.model.dynamic_parameters(), arm.model.dynamic_parameters());
    for (name, words) in [
        ("lost.xml", &["lost.xml:1:", "none.xml", "not there"][..]),
        ("turn.xml", &["inside each other"]),
        ("above.xml", &["above.xml:2:", "<include>", "below it"]),
        ("broken.xml", &["broken.xml:2:"]),
    ] {
        let why = Robot::read(&folder.0.join(name)).unwrap_err().to_string();
        assert!(words.iter().all(|word| why.contains(word)), "{name}: {why}");
    }
}

#[test]
fn a_toml_file_names_an_mjcf_under_either_key() {
    for key in ["urdf", "mjcf"] {
        let toml = format!("{key} = \"arm.xml\"\ntip = \"fore\"\n[encoder]\nbits = 17\n");
        let folder = Folder::new(key, &[("arm.xml", GOOD), ("arm.toml", &toml)]);
        for file in ["arm.toml", "arm.xml"] {
            let arm = Robot::read(&folder.0.join(file)).unwrap();
            assert_eq!((&*arm.tip, arm.joints[1].encoder_bits), ("fore", Some(17)), "{key} {file}");
        }
    }
}

/// Largest difference of the mass matrix and of the bias at three states, over their largest entries.
fn apart(a: &Robot, b: &Robot) -> f64 {
    let n = a.joints.len();
    let mut worst = 0.0_f64;
    for state in 0..3 {
        let x = |scale: f64| -> Vec<f64> {
            (0..n).map(|i| scale * (1.0 + i as f64 + f64::from(state)).sin()).collect()
        };
        let all = |robot: &Robot| {
            let (mut m, mut tau) = (vec![0.0; n * n], vec![0.0; n]);
            let mut workspace = Workspace::new(&robot.model);
            robot.model.mass_matrix(&mut workspace, &x(1.0), &mut m);
            robot.model.bias(&mut workspace, &x(1.0), &x(2.0), &mut tau);
            [m, tau].concat()
        };
        let (a, b) = (all(a), all(b));
        let most = a.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        worst = a.iter().zip(&b).fold(worst, |worst, (a, b)| worst.max((a - b).abs() / most));
    }
    worst
}

#[test]
fn as_urdf_it_is_the_same_arm() {
    let mut files: Vec<PathBuf> =
        fs::read_dir(files()).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "xml"));
    assert!(files.len() >= 5);
    for path in files {
        let part = Robot::chains(&path).unwrap().into_iter().next().unwrap();
        let part = Part { base: Some(part.base), tip: Some(part.tip), ..Part::default() };
        let arm = Robot::read_part(&path, &part).unwrap();
        let mut urdf = Robot::from_text(&arm.as_urdf(), None, "again.urdf").unwrap();
        urdf.model = urdf.model.clone().with_gravity(arm.model.gravity());
        assert_eq!(arm.joint_names(), urdf.joint_names());
        assert!(apart(&arm, &urdf) < 1e-13, "{}: {:e}", path.display(), apart(&arm, &urdf));
        for (own, other) in arm.joints.iter().zip(&urdf.joints) {
            assert_eq!((own.position, own.torque_max), (other.position, other.torque_max));
            assert_eq!(own.friction, other.friction);
        }
        assert_eq!(arm.urdf().unwrap(), arm.as_urdf());
    }
}

#[test]
fn hostile_files_are_cheap() {
    let deep = |tag: &str, times: usize, inner: &str| {
        format!(
            "{}{inner}{}",
            tag.repeat(times),
            format!("</{}>", &tag[1..tag.find([' ', '>']).unwrap()]).repeat(times)
        )
    };
    let body = "<body><joint/><geom size=\"0.1\"/>";
    let classes: String = (0..40).fold(String::new(), |mut text, n| {
        let _ = write!(text, "<default class=\"c{n}\"><joint damping=\"1\"/>");
        text
    });
    let many = "<geom size=\"0.1\"/>".repeat(40_000);
    let joints = "<joint armature=\"1\" damping=\"2\"/>".repeat(20_000);
    let used = "<body><joint/><geom size=\"0.1\"/></body>".repeat(9_000);
    for (text, words) in [
        (deep(body, 70, ""), "inside each other"),
        (format!("{classes}{}", "</default>".repeat(40)), "inside each other"),
        (format!("<body><joint/>{many}</body>"), ""),
        (format!("<default>{joints}</default>{used}"), "links"),
        (
            format!("<keyframe>{}</keyframe>", "<key name=\"a\" qpos=\"1 2\"/>".repeat(20_000)),
            "no joint",
        ),
        (format!("<key qpos=\"{}\"/>", "1 ".repeat(1_000_000)), "no joint"),
    ] {
        let inside = if text.starts_with("<body") {
            format!("<worldbody>{text}</worldbody>")
        } else {
            text.replacen("</default><body>", "</default><worldbody><body>", 1)
        };
        let close = if inside.contains("<worldbody>") && !inside.contains("</worldbody>") {
            "</worldbody>"
        } else {
            ""
        };
        let began = crate::support::processor_time();
        let read = Robot::from_text(&format!("<mujoco>{inside}{close}</mujoco>"), None, "bomb.xml");
        let took = crate::support::processor_time().saturating_sub(began);
        let told = read.map_or_else(|why| why.to_string(), |_| String::new());
        assert!(told.contains(words), "{words}: {told}");
        assert!(took < Duration::from_secs(4), "{words}: {took:?}");
    }
}
