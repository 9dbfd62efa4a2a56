//! Exit codes and documents of every verb, and units of joints that slide. Wrong if a verb ends with another
//! code than the help promises, if `--json` gives anything but one document, or if a joint that slides is
//! reported in mrad or N·m.

use std::fs;
use std::path::Path;

use crate::support::{folder, phihat, swing};
use serde_json::Value;

/// A study that has answers of every kind, and what is made of it.
fn place(name: &str) -> std::path::PathBuf {
    let folder = folder(name);
    let first = fs::read_to_string(folder.join("studies/first.toml")).unwrap();
    let first = first
        .replace("duration_s = 7.0", "duration_s = 3.0")
        .replace("start_s = 4.0", "start_s = 2.0");
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    write("good.toml", &first);
    write("tight.toml", &first.replace("error_bound_rad = 2e-3", "error_bound_rad = 1e-7"));
    write("bad.toml", &first.replace("rate_hz", "rate_khz"));
    write("designed.toml", &swing(1.5));
    write(
        "impossible.toml",
        &swing(1.5).replace("error_bound_rad = 4e-3", "error_bound_rad = 1e-9"),
    );
    folder
}

#[test]
#[expect(clippy::too_many_lines, reason = "a list of cases")]
fn exit_codes_are_those_of_the_help_and_documents_are_documents() {
    let folder = place("exit-codes");
    let design = phihat(&folder, &["design", "designed.toml", "--out", "gains.json"]);
    assert_eq!(design.code, 0, "{}", design.err);
    let gains = fs::read_to_string(folder.join("gains.json")).unwrap();
    let mut forged: Value = serde_json::from_str(&gains).unwrap();
    forged["joints"][0]["kd_per_s"] = 1.0.into();
    fs::write(folder.join("forged.json"), forged.to_string()).unwrap();
    let cases: [(&[&str], i32); 56] = [
        (&["run", "good.toml"], 0),
        (&["run", "tight.toml"], 1),
        (&["run", "impossible.toml"], 1),
        (&["run", "bad.toml"], 2),
        (&["run", "good.toml", "--gains", "good.toml"], 2),
        (&["simulate", "good.toml"], 0),
        (&["simulate", "tight.toml"], 1),
        (&["simulate", "nowhere.toml"], 2),
        (&["drive", "good.toml"], 2),
        (&["drive", "good.toml", "--accept", "certificate"], 0),
        (&["drive", "tight.toml", "--accept", "certificate"], 1),
        (&["realtime", "--seconds", "0.02"], 0),
        (&["design", "designed.toml"], 0),
        (&["design", "impossible.toml"], 1),
        (&["design", "bad.toml"], 2),
        (&["verify", "gains.json"], 3),
        (&["verify", "gains.json", "--study", "designed.toml"], 0),
        (&["verify", "forged.json"], 1),
        (&["verify", "bad.toml"], 2),
        (&["verify"], 2),
        (&["bound", "motion.csv", "--gains", "gains.json"], 2),
        (&["verify", "--run", "out/good"], 0),
        (&["audit", "out/good"], 0),
        (&["audit", "good.toml"], 2),
        (&["export", "gains.json", "--format", "csv"], 0),
        (&["export", "gains.json", "--format", "csv", "--out", "gains.csv"], 0),
        (&["export", "good.toml", "--format", "csv"], 2),
        (&["report", "out/good/trace.parquet"], 0),
        (&["report", "out/good"], 0),
        (&["report", "good.toml"], 2),
        (&["faults", "bad.toml"], 2),
        (&["sweep", "good.toml", "--vary", "duration_s=3,3.5", "--runs", "2", "--out", "swept"], 0),
        (&["sweep", "good.toml", "--vary", "duration_ms=2,3", "--runs", "2"], 2),
        (&["merge", "swept"], 2),
        (&["compare", "--list"], 0),
        (&["compare", "--rival", "pd"], 0),
        (&["compare", "--rival", "pdd"], 2),
        (&["compare", "bad.toml"], 2),
        (&["fronts", "good.toml", "--quick", "--only", "pd", "--count"], 0),
        (&["fronts", "good.toml", "--only", "pd", "--worlds", "1,2"], 2),
        (&["fronts", "good.toml", "--only", "pd", "--shard", "9/8"], 2),
        (&["fronts", "bad.toml"], 2),
        (&["reproduce", "--only", "nothing of this name"], 2),
        (&["robots"], 0),
        (&["robots", "panda"], 0),
        (&["robots", "atlas"], 2),
        (&["identify", "good.toml"], 2),
        (&["serve", "good.toml", "--fci"], 2),
        (&["studio", "bad.toml"], 2),
        (&["new", "atlas.urdf"], 2),
        (&["check", "good.toml", "designed.toml"], 0),
        (&["check", "good.toml", "bad.toml"], 2),
        (&["schema"], 0),
        (&["completions", "bash"], 0),
        (&["completions", "bsh"], 2),
        (&["man", "walk"], 2),
    ];
    for (arguments, code) in cases {
        // What takes seconds is run once: its own tests look at it without `--json`.
        if code == 2 || !["design", "sweep", "compare", "fronts", "drive"].contains(&arguments[0]) {
            let plain = phihat(&folder, arguments);
            assert_eq!(plain.code, code, "{arguments:?}: {}{}", plain.out, plain.err);
            assert!(code != 2 || plain.err.contains("error:"), "{arguments:?}: {}", plain.err);
        }
        let answer = phihat(&folder, &[arguments, &["--json"]].concat());
        assert_eq!(answer.code, code, "{arguments:?} --json: {}", answer.err);
        let document: Value = serde_json::from_str(&answer.out)
            .unwrap_or_else(|why| panic!("{arguments:?} --json: {why}\n{}", answer.out));
        if code == 2 {
            assert_eq!(document["exit_code"], 2, "{arguments:?}: {document}");
        }
    }
    // Every verb is among them.
    let help = phihat(&folder, &["--help"]).out;
    let verbs = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let verbs =
        verbs.take_while(|line| !line.is_empty()).filter_map(|line| line.strip_prefix("  "));
    let verbs: Vec<&str> =
        verbs.filter_map(|line| line.split(' ').next()).filter(|verb| !verb.is_empty()).collect();
    for verb in verbs.into_iter().filter(|verb| *verb != "help") {
        assert!(cases.iter().any(|(arguments, _)| arguments[0] == verb), "{verb} is not tried");
    }
}

/// A cart on a rail, and an arm on it; both joints are light.
const CART: &str = r#"<robot name="cart">
<link name="base"/>
<joint name="rail" type="prismatic"><parent link="base"/><child link="cart"/><axis xyz="1 0 0"/>
  <limit lower="-1" upper="1" effort="200" velocity="2"/></joint>
<link name="cart"><inertial><mass value="4"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/>
</inertial></link>
<joint name="swing" type="revolute"><parent link="cart"/><child link="tool"/><axis xyz="0 1 0"/>
  <limit lower="-2" upper="2" effort="20" velocity="3"/></joint>
<link name="tool"><inertial><origin xyz="0 0 -0.02"/><mass value="0.2"/>
  <inertia ixx="0.0005" ixy="0" ixz="0" iyy="0.0005" iyz="0" izz="0.0005"/></inertial></link>
</robot>
"#;

const CART_STUDY: &str = r#"title = "A cart and an arm"
duration_s = 3.0

[robot]
file = "cart.urdf"
armature_kg_m2 = [1.0, 0.002]

[spec]
settle_s = 1.0
error_bound_rad = [1e-3, 2e-2]

[design]

[loop]
form = "observer"
rate_hz = 1000.0

[sensor]
encoder_bits = 18
velocity = "differenced"
velocity_filter_hz = 100.0

[reference]
kind = "sines"
center_rad = [0.0, 0.0]
[[reference.sine]]
amplitude_rad = [0.1, 0.2]
frequency_hz = 0.3
"#;

/// Rows of tables that begin with this joint's name, with or without its number.
fn rows<'a>(text: &'a str, joint: &str) -> Vec<&'a str> {
    let named = |line: &&str| {
        let cell = line
            .trim_start_matches('│')
            .trim_start_matches(|c: char| c.is_ascii_digit())
            .trim_start();
        cell.starts_with(joint) && line.starts_with('│')
    };
    text.lines().filter(named).collect()
}

fn in_millimetres(folder: &Path, arguments: &[&str], figures: usize) -> String {
    let answer = phihat(folder, arguments);
    assert!(
        answer.code <= 1 && answer.err.is_empty(),
        "{arguments:?}: {}{}",
        answer.out,
        answer.err
    );
    let rail = rows(&answer.out, "rail");
    assert!(!rail.is_empty(), "{arguments:?}:\n{}", answer.out);
    let units: usize =
        rail.iter().map(|row| row.matches(" mm").count() + row.matches(" N").count()).sum();
    assert!(units >= figures, "{arguments:?}: {units} of {figures} units:\n{}", rail.join("\n"));
    for row in rail {
        // How far it goes where the other one is pushed.
        let row = row.replace("mm per N·m", "");
        assert!(!row.contains("rad") && !row.contains("N·m"), "{arguments:?}: {row}");
    }
    for row in rows(&answer.out, "swing") {
        assert!(!row.contains(" mm ") && !row.contains(" kg "), "{arguments:?}: {row}");
        assert!(
            arguments[0] == "robots"
                || !row.split(['│', ' ']).any(|cell| ["0.000", "0.0000"].contains(&cell)),
            "{arguments:?}: {row}"
        );
    }
    answer.out
}

#[test]
fn joints_that_slide_are_told_of_in_millimetres_and_newtons() {
    let folder = folder("units");
    fs::write(folder.join("cart.urdf"), CART).unwrap();
    fs::write(folder.join("rail.toml"), CART_STUDY).unwrap();
    let shown = in_millimetres(&folder, &["robots", "cart.urdf"], 1);
    assert!(shown.contains("-1.00 … 1.00 m"), "{shown}");
    in_millimetres(&folder, &["design", "rail.toml"], 4);
    in_millimetres(&folder, &["run", "rail.toml"], 6);
    let page = fs::read_to_string(folder.join("out/rail/report.html")).unwrap();
    let cells: Vec<&str> =
        page.split("<tr>").filter(|row| row.contains("<th scope=\"row\">rail</th>")).collect();
    assert!(cells.iter().any(|row| row.contains("mm/s")), "{cells:?}");
    for label in ["error e [mm]", "error e [mrad]", "torque τ [N]", "torque τ [N·m]"] {
        assert!(page.contains(&format!("\"y_label\":\"{label}\"")), "no axis of {label}");
    }
    let told = phihat(&folder, &["verify", "out/rail/gains.json", "--study", "rail.toml"]);
    let own: Vec<&str> = told.out.lines().filter(|line| line.starts_with("  rail: ")).collect();
    assert!(own.iter().any(|line| line.contains(" m")), "{}{}", told.out, told.err);
    for line in own {
        let turns = [" rad", "mrad", "N·m", "kg·m²"].iter().find(|unit| line.contains(**unit));
        assert!(turns.is_none(), "{line}");
    }
    // Out of spec, in its unit.
    let tight = CART_STUDY.replace("[1e-3, 2e-2]", "[1e-6, 2e-2]");
    fs::write(folder.join("tight.toml"), tight).unwrap();
    let gains = "out/rail/gains.json";
    assert_eq!(phihat(&folder, &["run", "tight.toml", "--gains", gains]).code, 1);
    let page = fs::read_to_string(folder.join("out/tight/report.html")).unwrap();
    let verdict =
        page.find("rail: |e| ").map(|at| page[at..].chars().take(60).collect::<String>()).unwrap();
    assert!(verdict.contains(" mm, bound"), "{verdict}");
}
