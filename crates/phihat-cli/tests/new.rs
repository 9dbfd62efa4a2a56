//! From a bare URDF to a first run. Wrong if that run were not certified or not within what its study asks
//! for, if the files did not say what was assumed, if a file of somebody were replaced unasked, or if a
//! refusal left one behind.

use std::fs;
use std::path::Path;

use crate::support::{files_of, folder, json, phihat};
use phihat_session::{RunOptions, Session};

/// An arm of two joints with a hand, as a CAD program writes it: nothing but a URDF.
fn urdf(effort: &str, light: bool) -> String {
    let joint = |name: &str, parent: &str, child: &str, x: f64, effort: &str| {
        format!(
            "<joint name=\"{name}\" type=\"revolute\"><parent link=\"{parent}\"/><child link=\"{child}\"/>\
             <origin xyz=\"{x} 0 0\"/><axis xyz=\"0 1 0\"/><limit lower=\"-2\" upper=\"2\" {effort} \
             velocity=\"3\"/></joint>\n"
        )
    };
    let link = |name: &str, mass: f64, x: f64| {
        let i = mass * 0.01;
        format!(
            "<link name=\"{name}\"><inertial><origin xyz=\"{x} 0 0\"/><mass value=\"{mass}\"/>\
             <inertia ixx=\"{i}\" ixy=\"0\" ixz=\"0\" iyy=\"{i}\" iyz=\"0\" izz=\"{i}\"/></inertial></link>\n"
        )
    };
    let (fore, elbow) = if light { (0.003, "effort=\"20\"") } else { (1.5, "effort=\"20\"") };
    let joints = joint("shoulder", "base", "upper", 0.0, effort)
        + &joint("elbow", "upper", "fore", 0.4, elbow);
    let fingers: String = ["left", "right"]
        .map(|side| {
            format!(
                "<joint name=\"finger_{side}\" type=\"prismatic\"><parent link=\"fore\"/><child \
                    link=\"finger_{side}_link\"/>\
                 <origin xyz=\"0.3 0 0\"/><axis xyz=\"0 1 0\"/><limit lower=\"0\" upper=\"0.02\" effort=\"5\" \
                 velocity=\"1\"/></joint>\n"
            ) + &link(&format!("finger_{side}_link"), 0.01, 0.02)
        })
        .concat();
    // A payload out there is what makes a light joint heavy.
    let tool = "<joint name=\"flange\" type=\"fixed\"><parent link=\"fore\"/><child link=\"tool\"/><origin xyz=\"0.3 0 \
        0\"/></joint>\n\
                <link name=\"tool\"/>\n";
    format!(
        "<robot name=\"two\"><link name=\"base\"/>\n{joints}{}{}{}</robot>\n",
        link("upper", 3.0, 0.2),
        link("fore", fore, 0.15),
        if light { tool } else { &fingers }
    )
}

fn write(folder: &Path, name: &str, text: &str) {
    fs::write(folder.join(name), text).unwrap();
}

#[test]
fn a_bare_urdf_comes_to_a_certified_run() {
    let folder = folder("new-bare");
    write(&folder, "two.urdf", &urdf("effort=\"60\"", false));
    fs::create_dir(folder.join("mine")).unwrap();
    let new = ["new", "two.urdf", "--out", "mine/first.toml", "--payload", "0.3", "--json"];
    let told = json(&folder, &new);
    assert_eq!(told["exit_code"], 0, "{told:#}");
    assert_eq!(
        told["joints"],
        serde_json::json!(["shoulder", "elbow"]),
        "fingers are no part of it"
    );
    let notes = told["notes"].to_string();
    assert!(notes.contains("chain from base to fore") && notes.contains("estimates"), "{notes}");
    let arm = fs::read_to_string(folder.join("mine/first_arm.toml")).unwrap();
    for words in
        ["armature_min_kg_m2", "armature_max_kg_m2", "coulomb_max_nm", "data sheet", "Measure"]
    {
        assert!(arm.contains(words), "{arm}");
    }

    let run = json(&folder, &["run", "mine/first.toml", "--out", "run", "--json"]);
    assert_eq!(run["verdict"], "within_spec", "{run:#}");
    assert_eq!(run["metrics"]["limited_steady_share"], 0.0);
    let promised = told["error_bound_rad"][0].as_f64().unwrap();
    let gains: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(folder.join("run/gains.json")).unwrap()).unwrap();
    let certificate = &gains["certificate"];
    for joint in certificate["tube"]["joints"].as_array().unwrap() {
        assert!(joint["error_bound_rad"].as_f64().unwrap() <= promised);
    }
    // What holds for the interval, and what for the value in it, is said.
    let left = certificate["not_counted"].to_string();
    assert!(left.contains("robot.armature_kg_m2") && left.contains("tube_beside_value"), "{left}");
    let verified = phihat(&folder, &["verify", "run/gains.json", "--study", "mine/first.toml"]);
    assert_eq!(verified.code, 0, "{}{}", verified.out, verified.err);
    at_both_ends(&folder);

    // What is there stays, unless one says otherwise.
    let before = files_of(&folder.join("mine"));
    let again = phihat(&folder, &new);
    assert_eq!(again.code, 2);
    assert!(again.err.contains("--force"), "{}", again.err);
    assert!(files_of(&folder.join("mine")) == before);
}

/// From a bare URDF to a tighter promise, with no edit by hand: estimate, first motion, and the study anew.
#[test]
fn a_first_motion_narrows_what_was_estimated() {
    let folder = folder("new-measured");
    write(&folder, "two.urdf", &urdf("effort=\"60\"", false));
    let first = json(&folder, &["new", "two.urdf", "--json"]);
    assert_eq!(first["exit_code"], 0, "{first:#}");
    // What is promised is what the check prints: gains of that study keep its error by both derivations.
    let designed = phihat(&folder, &["design", "two.toml", "--out", "two.json"]);
    assert_eq!(designed.code, 0, "{}{}", designed.out, designed.err);
    let verified = phihat(&folder, &["verify", "two.json", "--study", "two.toml"]);
    assert_eq!(verified.code, 0, "{}{}", verified.out, verified.err);
    let moved =
        phihat(&folder, &["drive", "two.toml", "--on", "sim", "--first-motion", "--out", "moved"]);
    assert_eq!(moved.code, 0, "{}{}", moved.out, moved.err);
    let arm = "moved/two_arm_measured.toml";
    assert!(moved.out.contains(&format!("next: phihat new {arm}")), "{}", moved.out);
    let read = |path: &str| -> toml::Table {
        fs::read_to_string(folder.join(path)).unwrap().parse().unwrap()
    };
    let (before, after) = (read("two_arm.toml"), read(arm));
    let list = |of: &toml::Table, section: &str, key: &str| -> Vec<f64> {
        let list = of[section][key].as_array().unwrap();
        list.iter().map(|value| value.as_float().unwrap()).collect()
    };
    for (section, value, low, high) in [
        ("rotor", "armature_kg_m2", "armature_min_kg_m2", "armature_max_kg_m2"),
        ("friction", "coulomb_nm", "coulomb_min_nm", "coulomb_max_nm"),
    ] {
        // The simulated arm has the value of the first file.
        let truth = list(&before, section, value);
        let ends = |of: &toml::Table| [list(of, section, low), list(of, section, high)];
        let ([least, most], [low, high]) = (ends(&before), ends(&after));
        let mut narrower = 1.0;
        for (i, truth) in truth.iter().enumerate() {
            assert!(
                low[i] <= *truth && *truth <= high[i],
                "{section} {i}: {truth}, {low:?} … {high:?}"
            );
            assert!(least[i] <= low[i] && high[i] <= most[i], "{section} {i}");
            narrower *= (most[i] - least[i]) / (high[i] - low[i]);
        }
        println!("{section}: {narrower:.1} times narrower");
        assert!(narrower > 1.5, "{section}: {narrower}");
    }
    // Whatever else the file says stays, comments too.
    let text = fs::read_to_string(folder.join(arm)).unwrap();
    assert!(text.contains("data sheet") && text.contains("first motion"), "{text}");
    // Where the search for the least error ends with the narrower arm; asked for alone it takes a third of the time.
    let less = "3.3";
    let promised = 1e3 * first["error_bound_rad"][0].as_f64().unwrap();
    println!("promised: {promised} mrad before, {less} after");
    assert!(promised > 1.5 * 3.3, "{promised}");
    let second = json(&folder, &["new", arm, "--error", less, "--json"]);
    assert_eq!(second["exit_code"], 0, "{second:#}");
    // Where no laws keep this and no less, stiffer ones do.
    assert!(second["error_bound_rad"][0].as_f64().unwrap() <= 3.3e-3, "{second:#}");
}

/// The same gains with every rotor at either end of its interval.
fn at_both_ends(folder: &Path) {
    let options = RunOptions { study: folder.join("mine/first.toml"), ..RunOptions::default() };
    let (session, _) = options.open().unwrap();
    let gains = session.into_gains();
    for end in [phihat_model::Rotor::Least, phihat_model::Rotor::Most] {
        let mut study = phihat_session::read(&options.study).unwrap();
        for joint in &mut study.robot.joints {
            let (low, high) = joint.armature_range.unwrap();
            assert!(high > 4.0 * low, "an estimate is no figure");
            joint.armature = joint.armature_at(end);
        }
        // A lighter rotor makes friction stiffer to integrate.
        phihat_sim::derive_substeps(&mut study);
        let given = Some((gains.clone(), Path::new("gains.json")));
        let (done, _) = Session::new(study, &options.study, given, false).unwrap().run(|_| ());
        assert!(done.divergence.is_none() && done.metrics.within_spec, "{end:?}");
    }
}

#[test]
fn without_a_torque_limit_one_that_would_do_is_assumed_and_said() {
    let folder = folder("new-no-limit");
    write(&folder, "two.urdf", &urdf("", false));
    let before = files_of(&folder);
    let told = phihat(&folder, &["new", "two.urdf", "--out", "assumed/first.toml"]);
    assert_eq!(told.code, 0, "{}{}", told.out, told.err);
    let said =
        ["no torque limit is stated for 1 of 2 joints", "assumption: shoulder ", "--torque-max"];
    assert!(said.iter().all(|part| told.out.contains(part)), "{}", told.out);
    // It holds the arm stretched out, by hand: masses times g times their distances.
    let own = folder.join("assumed/first_arm.toml");
    let text = fs::read_to_string(&own).unwrap();
    assert!(text.contains("assumption where the URDF has no limit"), "{text}");
    let limit = phihat_model::Robot::read(&own).unwrap().joints[0].torque_max.unwrap();
    let gravity = 9.81 * (3.0 * 0.2 + 1.5 * 0.55 + 0.02 * 0.72);
    assert!(1.9 * gravity < limit && limit < 4.0 * gravity, "{limit} {gravity}");
    fs::remove_dir_all(folder.join("assumed")).unwrap();
    let weak = phihat(&folder, &["new", "two.urdf", "--out", "first.toml", "--torque-max", "1"]);
    // What is in the way is told as an answer, and the files are there to be changed.
    assert_eq!(weak.code, 1, "{}{}", weak.out, weak.err);
    let said = ["cannot hold itself", "of joint shoulder, whose limit is 1 N·m", "--torque-max"];
    let words = weak.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.iter().all(|part| words.contains(part)), "{words}");
    for name in ["first.toml", "first_arm.toml"] {
        fs::remove_file(folder.join(name)).unwrap();
    }
    let wrong =
        phihat(&folder, &["new", "two.urdf", "--out", "first.toml", "--torque-max", "9,9,9"]);
    assert_eq!(wrong.code, 2);
    assert!(wrong.err.contains("3 values; the arm has 2 joints"), "{}", wrong.err);
    let name = phihat(&folder, &["new", "two.urdf", "--out", "First Study"]);
    assert_eq!(name.code, 2);
    assert!(files_of(&folder) == before, "a refusal leaves nothing");
}

#[test]
fn light_joints_without_a_rotor_are_told_by_name() {
    let folder = folder("new-light");
    write(&folder, "two.urdf", &urdf("effort=\"60\"", true));
    write(&folder, "arm.toml", "urdf = \"two.urdf\"\n[encoder]\nbits = 18\n");
    let told = phihat(&folder, &["new", "arm.toml", "--out", "first.toml", "--payload", "1"]);
    assert_eq!(told.code, 1, "{}{}", told.out, told.err);
    let words = told.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        words.contains("light joints have no rotor") && words.contains("elbow (0.00e0)"),
        "{words}"
    );
    // The figure is true: with it there are gains, and with half of it there are none.
    let figure = words.split("at least ").nth(1).unwrap().split(' ').next().unwrap();
    let figure: f64 = figure.parse().unwrap();
    // Gains for a wide interval of friction come without a proof that they keep the specification: code 3.
    for (share, codes) in [(1.0, [0, 3]), (0.5, [1, 1])] {
        let arm = format!(
            "urdf = \"two.urdf\"\n[rotor]\narmature_kg_m2 = {:e}\n[encoder]\nbits = 18\n",
            share * figure
        );
        write(&folder, "arm.toml", &arm);
        let study = fs::read_to_string(folder.join("first.toml")).unwrap();
        let line = study.lines().find(|line| line.starts_with("error_bound_rad")).unwrap();
        write(&folder, "easy.toml", &study.replace(line, "error_bound_rad = 50.0"));
        let told = phihat(&folder, &["design", "easy.toml", "--out", "gains.json"]);
        assert!(codes.contains(&told.code), "{share}: {}{}", told.out, told.err);
    }
}

#[test]
fn an_arm_is_written_beside_its_urdf() {
    let folder = folder("new-write");
    write(&folder, "two.urdf", &urdf("effort=\"60\"", false));
    let write = ["robots", "two.urdf", "--base", "base", "--tip", "fore", "--write", "arm.toml"];
    let told = phihat(&folder, &write);
    assert_eq!(told.code, 0, "{}{}", told.out, told.err);
    let shown = json(&folder, &["robots", "arm.toml", "--json"]);
    assert_eq!(shown["joints"].as_array().unwrap().len(), 2);
    let own = &shown["joints"][1];
    let armature = own["armature_kg_m2"].as_f64().unwrap();
    let [low, high] = [0, 1].map(|end| own["armature_range_kg_m2"][end].as_f64().unwrap());
    // 20 N·m at 3 rad/s, 0.011 to 0.07 s; two digits, outwards.
    assert!(
        low <= 20.0 / 3.0 * 0.011 && 20.0 / 3.0 * 0.07 <= high && low < armature && armature < high
    );
    let again = phihat(&folder, &write);
    assert_eq!(again.code, 2, "it is there already");
    fs::create_dir(folder.join("beside")).unwrap();
    let beside = phihat(&folder, &["robots", "two.urdf", "--write", "beside/arm.toml"]);
    assert_eq!(beside.code, 2);
    assert!(beside.err.contains("beside this file or below it"), "{}", beside.err);
}

#[test]
fn without_an_arm_and_a_terminal_it_asks_for_one() {
    let folder = folder("new-nothing");
    let told = phihat(&folder, &["new", "--json"]);
    assert_eq!(told.code, 2);
    let document: serde_json::Value = serde_json::from_str(&told.out).unwrap();
    assert!(document["error"].as_str().unwrap().contains("which arm?"));
}
