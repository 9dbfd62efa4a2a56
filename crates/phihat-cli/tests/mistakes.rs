//! Mistakes of users: each gives one line with its place, its value and the valid values; exit code 2;
//! nothing is written.
//!
//! Wrong if a mistake passes, or gives several lines, points to another line, does not show its value or says
//! no remedy.

use std::fs;
use std::path::Path;

use crate::support::{Answer, files_of, folder, phihat};

/// A study that is right, what is done to it, where the mistake then is, and what the line has to say: value
/// and remedy.
struct Mistake {
    what: &'static str,
    study: Base,
    /// Replaced text, and its replacement; an empty text is the end of the study.
    edit: (&'static str, &'static str),
    /// The text on the line that is meant; empty: no line of the study.
    at: &'static str,
    says: &'static [&'static str],
}

#[derive(Clone, Copy, PartialEq)]
enum Base {
    /// The first study of the repository.
    First,
    /// An own arm that holds still.
    Own,
    /// Samples from a file.
    Samples,
}
use Base::{First, Own, Samples};

const fn mistake(
    what: &'static str,
    study: Base,
    edit: (&'static str, &'static str),
    at: &'static str,
    says: &'static [&'static str],
) -> Mistake {
    Mistake { what, study, edit, at, says }
}

const IN_KEYS: [Mistake; 10] = [
    mistake(
        "wrong unit in a key",
        First,
        ("rate_hz = 1000.0", "rate_khz = 1.0"),
        "rate_khz",
        &["loop.rate_khz", "the unit here is Hz", "write `rate_hz`"],
    ),
    mistake(
        "no unit in a key",
        First,
        ("duration_s =", "duration ="),
        "duration =",
        &["the unit here is s", "write `duration_s`"],
    ),
    mistake(
        "misspelt key",
        First,
        ("encoder_bits", "encodr_bits"),
        "encodr",
        &["sensor.encodr_bits", "did you mean `encoder_bits`?"],
    ),
    mistake(
        "misspelt section",
        First,
        ("[loop]", "[lop]"),
        "[lop]",
        &["lop: unknown key", "did you mean `loop`?"],
    ),
    mistake(
        "key of another section",
        First,
        ("[sensor]", "[sensor]\nrate_hz = 500.0"),
        "rate_hz = 500",
        &["sensor.rate_hz", "belongs in [loop]"],
    ),
    mistake(
        "the same key twice",
        First,
        ("seed = 1 ", "seed = 1\nseed = 2 #"),
        "seed = 2",
        &["duplicate key `seed`", "keep one of them"],
    ),
    mistake(
        "the same section twice",
        First,
        ("", "\n[loop]\nrate_hz = 500.0\n"),
        "[loop]\nrate_hz = 500",
        &["duplicate key `loop`", "keep one of them"],
    ),
    mistake(
        "no [spec] for a design",
        Own,
        (
            "[spec]\nsettle_s = 1.0\nerror_bound_rad = 0.05\n\n[gains]\ninertia_kg_m2 = 0.3\nbandwidth_rad_s = \
                15.0\nestimator_bandwidth_rad_s = 60.0",
            "[design]",
        ),
        "",
        &["spec.error_bound_rad is missing", "a design needs the largest error you can live with"],
    ),
    mistake(
        "no [gains] and no [design]",
        Own,
        (
            "[gains]\ninertia_kg_m2 = 0.3\nbandwidth_rad_s = 15.0\nestimator_bandwidth_rad_s = 60.0",
            "",
        ),
        "",
        &["missing section [gains]", "`[design]`"],
    ),
    mistake(
        "a required key is left out",
        Own,
        ("duration_s = 2.0", ""),
        "title",
        &["duration_s: missing key", "Simulated time [s]"],
    ),
];

const IN_VALUES: [Mistake; 16] = [
    mistake(
        "degrees for radians",
        Own,
        ("q_rad = [0.2, 0.4]", "q_rad = [12, 0.4]"),
        "q_rad",
        &[
            "reference.q_rad[0]",
            "joint `shoulder`: 12 is outside its limits -2 to 2",
            "if these are degrees: 12 deg = 0.2094 rad",
        ],
    ),
    mistake(
        "not a number",
        First,
        ("duration_s = 7.0", "duration_s = nan"),
        "duration_s = nan",
        &["NaN is not a finite number", "above 0"],
    ),
    mistake(
        "infinite",
        First,
        ("rate_hz = 1000.0", "rate_hz = inf"),
        "rate_hz = inf",
        &["loop.rate_hz", "inf is not a finite number", "1 to 20000"],
    ),
    mistake(
        "rate 0",
        First,
        ("rate_hz = 1000.0", "rate_hz = 0.0"),
        "rate_hz = 0",
        &["0 is out of range", "1 to 20000"],
    ),
    mistake(
        "negative seed",
        First,
        ("seed = 1 ", "seed = -1 "),
        "seed = -1",
        &["-1 is out of range", "0 to"],
    ),
    mistake(
        "delay beyond what there is",
        First,
        ("delay_samples = 1", "delay_samples = 1000"),
        "delay_samples",
        &["1000 is out of range", "0 to"],
    ),
    mistake(
        "encoder of 0 bits",
        First,
        ("encoder_bits = 18", "encoder_bits = 0"),
        "encoder_bits",
        &["0 is out of range", " to "],
    ),
    mistake(
        "negative mass",
        First,
        ("mass_kg = 0.3", "mass_kg = -0.3"),
        "mass_kg",
        &["world.payload.mass_kg", "-0.3 is out of range", "above 0"],
    ),
    mistake(
        "negative inertia",
        First,
        ("[0.42, 0.18, 0.14]", "[0.42, -0.18, 0.14]"),
        "inertia_kg_m2 = [",
        &["gains.inertia_kg_m2[1]", "-0.18 is out of range", "above 0"],
    ),
    mistake(
        "array too short",
        First,
        ("[0.42, 0.18, 0.14]", "[0.42, 0.18]"),
        "inertia_kg_m2 = [",
        &["2 entries for 3 joints", "joint1, joint2, joint3"],
    ),
    mistake(
        "array too long",
        First,
        ("[0.42, 0.18, 0.14]", "[0.42, 0.18, 0.14, 0.1]"),
        "inertia_kg_m2 = [",
        &["4 entries for 3 joints", "joint1, joint2, joint3"],
    ),
    mistake(
        "table without a joint",
        First,
        ("[0.42, 0.18, 0.14]", "{ joint1 = 0.42, joint2 = 0.18 }"),
        "inertia_kg_m2 = {",
        &["no value for joint `joint3`", "names every joint once"],
    ),
    mistake(
        "a string for a number",
        First,
        ("duration_s = 7.0", "duration_s = \"7\""),
        "duration_s = \"7\"",
        &["expected a number, found a string", "\"7\"", "without quotes"],
    ),
    mistake(
        "a decimal comma",
        First,
        ("duration_s = 7.0", "duration_s = 7,0"),
        "duration_s = 7,0",
        &["not TOML", "7,0", "decimal point"],
    ),
    mistake(
        "a word without quotes",
        First,
        ("name = \"planar3r\"", "name = planar3r"),
        "name = planar3r",
        &["not TOML", "planar3r", "quotes"],
    ),
    mistake(
        "a word that is not known",
        First,
        ("\"differenced\"", "\"difference\""),
        "velocity = \"difference\"",
        &["\"difference\" is not known here", "did you mean `differenced`?"],
    ),
];

const IN_NAMES: [Mistake; 11] = [
    mistake(
        "misspelt joint",
        First,
        ("joint = \"joint2\"", "joint = \"jiont2\""),
        "jiont2",
        &["world.push[0].joint", "no joint `jiont2`", "did you mean `joint2`?"],
    ),
    mistake(
        "misspelt joint of a table",
        First,
        ("[0.42, 0.18, 0.14]", "{ joint1 = 0.4, joint2 = 0.2, joint3 = 0.1, join3 = 0.1 }"),
        "join3",
        &["no joint `join3`", "did you mean `joint3`?"],
    ),
    mistake(
        "misspelt robot",
        First,
        ("\"planar3r\"", "\"planar3\""),
        "planar3\"",
        &["no built-in robot `planar3`", "did you mean `planar3r`?"],
    ),
    mistake(
        "unknown frame",
        First,
        ("mass_kg = 0.3", "mass_kg = 0.3, frame = \"tol\""),
        "tol\"",
        &["the robot has no frame `tol`", "did you mean `tool`?"],
    ),
    mistake(
        "unknown pose",
        First,
        ("seed = \"ready\"", "seed = \"redy\""),
        "redy",
        &["the robot has no pose `redy`", "ready"],
    ),
    mistake(
        "wrong base",
        Own,
        ("file = \"arm.urdf\"", "file = \"arm.urdf\"\nbase = \"bace\"\ntip = \"tool\""),
        "file = ",
        &["there is no link \"bace\"", "did you mean \"base\"?"],
    ),
    mistake(
        "wrong tip",
        Own,
        ("file = \"arm.urdf\"", "file = \"arm.urdf\"\ntip = \"tol\""),
        "file = ",
        &["there is no link \"tol\"", "did you mean \"tool\"?"],
    ),
    mistake(
        "locked joint misspelt",
        Own,
        ("file = \"arm.urdf\"", "file = \"arm.urdf\"\nlocked = { elbo = 0.0 }"),
        "elbo =",
        &["no joint `elbo`", "did you mean `elbow`?"],
    ),
    mistake(
        "name and file",
        First,
        ("name = \"planar3r\"", "name = \"planar3r\"\nfile = \"arm.urdf\""),
        "file = \"arm",
        &["both `name` and `file` are given", "keep one of them"],
    ),
    mistake(
        "unknown kind",
        First,
        ("kind = \"curve\"", "kind = \"curves\""),
        "kind = \"curves\"",
        &["unknown kind \"curves\"", "did you mean `curve`?"],
    ),
    mistake(
        "unknown torque interface",
        First,
        ("", "\n[profile]\nname = \"frankas\"\n"),
        "frankas",
        &["\"frankas\" is not known here", "did you mean `franka`?"],
    ),
];

const TOGETHER: [Mistake; 10] = [
    mistake(
        "motion beyond the limits",
        Own,
        ("q_rad = [0.2, 0.4]", "q_rad = [0.2, 2.6]"),
        "q_rad",
        &["joint `elbow`: 2.6 is outside its limits -2.5 to 2.5"],
    ),
    mistake(
        "settled after the end",
        First,
        ("settle_s = 1.5", "settle_s = 8.0"),
        "settle_s = 8",
        &["8 s is not before the end of the run at 7 s", "smaller than duration_s"],
    ),
    mistake(
        "push after the end",
        First,
        ("start_s = 4.0", "start_s = 40.0"),
        "start_s = 40",
        &["40 s is not before the end of the run at 7 s", "duration_s"],
    ),
    mistake(
        "two ways to say the law",
        First,
        ("damping = 1.0\n", "damping = 1.0\nkp_per_s2 = 400.0\n"),
        "kp_per_s2",
        &["cannot be mixed with", "by bandwidths or by coefficients"],
    ),
    mistake(
        "gains stated, and a filter left to the design",
        First,
        (
            "velocity = \"differenced\"",
            "velocity = \"differenced\"\nvelocity_filter_hz = \"design\"",
        ),
        "velocity_filter_hz",
        &["left to the design, while the study states its [gains]", "give a cut-off"],
    ),
    mistake(
        "gains stated, and a search told what to look for",
        First,
        ("[gains]", "[design]\norders = [2]\n\n[gains]"),
        "orders",
        &["while the study states its [gains]", "leave out [gains] to have them found"],
    ),
    mistake(
        "filter above half of the rate",
        First,
        ("velocity = \"differenced\"", "velocity = \"differenced\"\nvelocity_filter_hz = 800.0"),
        "velocity_filter_hz",
        &["800 Hz is above half of the loop's rate of 1000 Hz", "at most 500 Hz"],
    ),
    mistake(
        "interval of payloads reversed",
        Own,
        ("", "\n[design]\npayload_kg = [2.0, 0.5]\n"),
        "payload_kg",
        &["2 kg is above 0.5 kg", "the lighter one comes first"],
    ),
    mistake(
        "world's payload outside of the design's",
        Own,
        ("", "\n[design]\npayload_max_kg = 0.1\n[world]\npayload = { mass_kg = 0.3 }\n"),
        "payload_max_kg",
        &["0.1 kg, while world.payload has 0.3 kg", "at least 0.3 kg"],
    ),
    mistake(
        "a run that nobody can keep",
        First,
        ("duration_s = 7.0", "duration_s = 80000.0"),
        "duration_s",
        &["80000000 control samples", "1 to 4000000", "duration_s"],
    ),
];

const FILES: [Mistake; 8] = [
    mistake(
        "reference that is not there",
        Samples,
        ("motion.csv", "notion.csv"),
        "notion.csv",
        &["reference.file", "notion.csv", "relative to the study's folder"],
    ),
    mistake(
        "folder for a reference",
        Samples,
        ("motion.csv", "inputs"),
        "inputs",
        &["reference.file", "a folder", "a file is needed"],
    ),
    mistake(
        "arm that is not there",
        Own,
        ("arm.urdf", "arms.urdf"),
        "arms.urdf",
        &["robot.file", "arms.urdf", "relative to the study"],
    ),
    mistake(
        "folder for an arm",
        Own,
        ("arm.urdf", "inputs"),
        "inputs",
        &["robot.file", "a folder", "a file is needed"],
    ),
    mistake(
        "path of Windows",
        Own,
        ("\"arm.urdf\"", "\"C:\\robots\\arm.urdf\""),
        "C:\\robots",
        &["not TOML", "\\r", "single quotes"],
    ),
    mistake(
        "arm cut short",
        Own,
        ("arm.urdf", "short.urdf"),
        "short.urdf",
        &["robot.file", "short.urdf", "does not end"],
    ),
    mistake(
        "arm without joints",
        Own,
        ("arm.urdf", "stiff.urdf"),
        "stiff.urdf",
        &["robot.file", "stiff.urdf", "joint"],
    ),
    mistake(
        "link with a negative mass",
        Own,
        ("arm.urdf", "light.urdf"),
        "light.urdf",
        &["robot.file", "light.urdf", "-3", "mass"],
    ),
];

const OWN: &str = r#"title = "Own arm"
duration_s = 2.0

[robot]
file = "arm.urdf"

[spec]
settle_s = 1.0
error_bound_rad = 0.05

[gains]
inertia_kg_m2 = 0.3
bandwidth_rad_s = 15.0
estimator_bandwidth_rad_s = 60.0

[loop]
rate_hz = 1000.0

[reference]
kind = "hold"
q_rad = [0.2, 0.4]
"#;

const ARM: &str = r#"<robot name="arm">
<link name="base"/>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
  <limit lower="-2" upper="2" effort="60" velocity="3"/></joint>
<link name="upper"><inertial><origin xyz="0.2 0 0"/><mass value="3"/>
  <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.14" iyz="0" izz="0.14"/></inertial></link>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="tool"/><origin xyz="0.4 0 0"/><axis xyz="0 1 0"/>
  <limit lower="-2.5" upper="2.5" effort="30" velocity="3"/></joint>
<link name="tool"><inertial><origin xyz="0.15 0 0"/><mass value="1.5"/>
  <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.12" iyz="0" izz="0.12"/></inertial></link>
</robot>
"#;

const MOTION: &str = "t_s,shoulder,elbow\n0,0.2,0.4\n1,0.2,0.4\n2,0.2,0.4\n";

fn place(name: &str) -> std::path::PathBuf {
    let folder = folder(name);
    let arms = [
        ("arm.urdf", ARM.to_owned()),
        ("short.urdf", ARM[..ARM.len() / 2].to_owned()),
        ("stiff.urdf", ARM.replace("revolute", "fixed")),
        ("light.urdf", ARM.replace("<mass value=\"3\"/>", "<mass value=\"-3\"/>")),
        ("motion.csv", MOTION.to_owned()),
    ];
    for (name, text) in arms {
        fs::write(folder.join(name), text).unwrap();
    }
    fs::create_dir(folder.join("inputs")).unwrap();
    folder
}

fn text(base: Base) -> String {
    let samples = || {
        OWN.replace("kind = \"hold\"\nq_rad = [0.2, 0.4]", "kind = \"csv\"\nfile = \"motion.csv\"")
    };
    match base {
        First => include_str!("../../../studies/first.toml").to_owned(),
        Own => OWN.to_owned(),
        Samples => samples(),
    }
}

/// Deviations from the expected answer: one line that says these words, exit code 2, nothing written.
fn wrong(folder: &Path, (what, says): (&str, &[&str]), answer: &Answer) -> Vec<String> {
    let lines: Vec<&str> = answer.err.lines().collect();
    let [line] = lines[..] else {
        return vec![format!("{what}: {} lines:\n{}{}", lines.len(), answer.out, answer.err)];
    };
    let mut wrong = Vec::new();
    let mut hold = |holds: bool, why: String| {
        if !holds {
            wrong.push(format!("{what}: {why}\n  {line}"));
        }
    };
    hold(answer.code == 2, format!("exit code {}", answer.code));
    hold(line.starts_with("error: "), "does not begin with `error: `".to_owned());
    hold(!folder.join("out").exists(), "something was written".to_owned());
    for part in says {
        hold(line.contains(part), format!("`{part}` is not in"));
    }
    wrong
}

fn none(wrong: &[String]) {
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn each_is_one_line_with_place_value_and_remedy() {
    let folder = place("mistakes");
    for base in [First, Own, Samples] {
        fs::write(folder.join("study.toml"), text(base)).unwrap();
        let good = phihat(&folder, &["check", "study.toml"]);
        assert_eq!(good.code, 0, "{}", good.err);
    }
    let all = IN_KEYS.iter().chain(&IN_VALUES).chain(&IN_NAMES).chain(&TOGETHER).chain(&FILES);
    let mut found = Vec::new();
    let mut count = 0;
    for Mistake { what, study, edit: (from, to), at, says } in all {
        let good = text(*study);
        let bad = if from.is_empty() { good.clone() + to } else { good.replacen(from, to, 1) };
        assert_ne!(good, bad, "{what} changes nothing");
        fs::write(folder.join("study.toml"), &bad).unwrap();
        let before = files_of(&folder);
        let check = phihat(&folder, &["check", "study.toml"]);
        let number = bad.find(at).map_or(0, |at| bad[..at].matches('\n').count() + 1);
        let there =
            if at.is_empty() { "study.toml".to_owned() } else { format!("study.toml:{number}:") };
        let says = [&[there.as_str()], *says].concat();
        found.extend(wrong(&folder, (what, &says), &check));
        // A run is refused for the same reason, at the same place.
        let run = phihat(&folder, &["run", "study.toml"]);
        let fact = run
            .err
            .lines()
            .next()
            .and_then(|line| line.strip_prefix("error: "))
            .unwrap_or("nothing");
        if run.code != 2 || !check.err.contains(fact.trim_start_matches("study.toml: ")) {
            found.push(format!(
                "{what}: a run ends with {}\n  {}  {}",
                run.code, check.err, run.err
            ));
        }
        assert!(files_of(&folder) == before, "{what}: something was written");
        count += 1;
    }
    none(&found);
    assert!(count >= 54, "{count}");
}

#[test]
#[expect(clippy::too_many_lines, reason = "a list of cases")]
fn rows_of_a_file_are_told_with_their_line() {
    let folder = place("mistaken-rows");
    fs::write(folder.join("study.toml"), text(Samples)).unwrap();
    let mut found = Vec::new();
    for (what, from, to, says) in [
        (
            "missing column",
            "t_s,shoulder,elbow",
            "t_s,shoulder",
            &["motion.csv:1:", "no column `elbow`", "t_s,shoulder,elbow"][..],
        ),
        (
            "misspelt column",
            "elbow",
            "elbo",
            &["motion.csv:1:", "no joint `elbo`", "did you mean `elbow`?"],
        ),
        ("time without its unit", "t_s", "time", &["motion.csv:1:", "`time`", "`t_s`"]),
        (
            "no header",
            "t_s,shoulder,elbow\n",
            "",
            &["motion.csv:1:", "no joint `0`", "the first line names the columns"],
        ),
        ("semicolons", ",", ";", &["motion.csv:1:", "separated by commas"]),
        (
            "a word in a row",
            "1,0.2,0.4",
            "1,x,0.4",
            &["motion.csv:3:", "`x` is not a number", "a finite number"],
        ),
        (
            "a cell too few",
            "1,0.2,0.4",
            "1,0.2",
            &["motion.csv:3:", "2 columns, the first line has 3"],
        ),
        (
            "time that goes back",
            "\n2,",
            "\n0.5,",
            &["motion.csv:4:", "0.5 s is not after the row before it, at 1 s"],
        ),
        ("degrees", "1,0.2,0.4", "1,12,23", &["motion.csv:3:", "12 is outside its limits -2 to 2"]),
        (
            "too fast",
            "1,0.2,0.4",
            "1,0.2,-2.4\n1.1,0.2,2.4",
            &["motion.csv:4:", "48.0000 rad/s since the row before, beyond its limit 3"],
        ),
        (
            "too short",
            "2,0.2,0.4\n",
            "",
            &["study.toml:21:", "the samples end at 1 s, the run at 2 s"],
        ),
    ] {
        let bad = MOTION.replace(from, to);
        assert_ne!(bad, MOTION, "{what}");
        fs::write(folder.join("motion.csv"), bad).unwrap();
        let check = phihat(&folder, &["check", "study.toml"]);
        found.extend(wrong(&folder, (what, says), &check));
    }
    none(&found);
}

#[test]
#[expect(clippy::too_many_lines, reason = "a list of cases")]
fn files_that_are_not_what_they_are_taken_for() {
    let folder = place("mistaken-files");
    let text = text(Own);
    let write = |name: &str, bytes: &[u8]| fs::write(folder.join(name), bytes).unwrap();
    write("study.toml", text.as_bytes());
    // A byte-order mark is nobody's mistake.
    write("bom.toml", format!("\u{feff}{text}").as_bytes());
    assert_eq!(phihat(&folder, &["check", "bom.toml"]).code, 0);
    let wide: Vec<u8> =
        [0xfeff].into_iter().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    write("wide.toml", &wide);
    write("My Arm.toml", text.as_bytes());
    write("empty.toml", b"");
    let joint = |name: &str| {
        format!(
            r#"{{"name": "{name}", "inertia_kg_m2": 0.3, "kp_per_s2": 225.0, "kd_per_s": 30.0, "a": [60.0]}}"#
        )
    };
    let gains = |names: [&str; 2], rate: f64| {
        format!(
            r#"{{"format": "phihat-gains", "version": 3, "study": "s", "study_sha256": "0",
            "rate_hz": {rate:?}, "method": "typed", "joints": [{}, {}]}}"#,
            joint(names[0]),
            joint(names[1])
        )
    };
    let good = gains(["shoulder", "elbow"], 1000.0);
    write("good.json", good.as_bytes());
    let fits = phihat(&folder, &["check", "study.toml", "--gains", "good.json"]);
    assert_eq!(fits.code, 0, "{}", fits.err);
    write("other.json", gains(["panda_joint1", "panda_joint2"], 1000.0).as_bytes());
    write("slow.json", gains(["shoulder", "elbow"], 500.0).as_bytes());
    write("short.json", &good.as_bytes()[..good.len() / 2]);
    let check = |gains| vec!["check", "study.toml", "--gains", gains];
    let cases: [(&str, Vec<&str>, &[&str]); 15] = [
        ("UTF-16", vec!["check", "wide.toml"], &["wide.toml: ", "UTF-16", "save it as UTF-8"]),
        (
            "a name that no study has",
            vec!["check", "My Arm.toml"],
            &["My Arm.toml: ", "a-z, 0-9, _ and -"],
        ),
        (
            "nothing in it",
            vec!["check", "empty.toml"],
            &["empty.toml", "is empty", "studies/first.toml"],
        ),
        (
            "not there",
            vec!["check", "nowhere.toml"],
            &["nowhere.toml: ", "No such file", "a study is a TOML file"],
        ),
        ("a folder", vec!["check", "inputs"], &["inputs: ", "a folder", "a study is a TOML file"]),
        ("an arm for a study", vec!["check", "arm.urdf"], &["arm.urdf", "URDF", "[robot]"]),
        ("gains for a study", vec!["check", "good.json"], &["good.json", "JSON", "--gains"]),
        (
            "gains of another robot",
            check("other.json"),
            &[
                "other.json: ",
                "for joints panda_joint1, panda_joint2",
                "the robot has shoulder, elbow",
            ],
        ),
        ("gains of another rate", check("slow.json"), &["slow.json: ", "500 Hz", "1000 Hz"]),
        ("gains cut short", check("short.json"), &["short.json: ", "EOF", "line 2"]),
        ("gains that are not there", check("none.json"), &["none.json: ", "cannot be read"]),
        ("a study for gains", check("study.toml"), &["study.toml: ", "not gains", "phihat design"]),
        (
            "a study for gains, verified",
            vec!["verify", "study.toml"],
            &["study.toml: ", "not gains", "phihat design"],
        ),
        (
            "gains for a trace",
            vec!["report", "good.json"],
            &["good.json: ", "is not the trace of a run"],
        ),
        (
            "an arm that is not built in",
            vec!["robots", "pandas"],
            &["\"pandas\"", "did you mean \"panda\"?"],
        ),
    ];
    let mut found = Vec::new();
    for (what, arguments, says) in cases {
        found.extend(wrong(&folder, (what, says), &phihat(&folder, &arguments)));
    }
    none(&found);
}

#[test]
fn all_of_a_study_at_once_in_the_order_of_the_file() {
    let folder = place("all-mistakes");
    let bad = text(First)
        .replace("rate_hz = 1000.0", "rate_khz = 1.0")
        .replace("[0.42, 0.18, 0.14]", "[0.42, 0.18]")
        .replace("encoder_bits = 18", "encoder_bits = 0")
        .replace("joint = \"joint2\"", "joint = \"jiont2\"")
        .replace("mass_kg = 0.3", "mass_kg = 0.3, frame = \"tol\"")
        .replace("seed = \"ready\"", "seed = \"redy\"")
        .replace("settle_s = 1.5", "settle_s = 8.0");
    fs::write(folder.join("study.toml"), &bad).unwrap();
    let answer = phihat(&folder, &["check", "study.toml"]);
    let expected = [
        "spec.settle_s",
        "gains.inertia_kg_m2",
        "loop.rate_khz",
        "sensor.encoder_bits",
        "world.payload.frame",
        "world.push[0].joint",
        "reference.seed",
    ];
    let lines: Vec<&str> = answer.err.lines().collect();
    assert_eq!((answer.code, lines.len()), (2, expected.len()), "{}", answer.err);
    for (line, key) in lines.iter().zip(expected) {
        assert!(line.contains(&format!(": {key}: ")), "{key}: {line}");
    }
    assert_eq!(answer.out, "study.toml: 7 errors\n");
    let document =
        crate::support::json(&folder, &["check", "study.toml", "studies/first.toml", "--json"]);
    assert_eq!((&document["valid"], &document["exit_code"]), (&false.into(), &2.into()));
    let errors = document["studies"][0]["errors"].as_array().unwrap();
    let keys: Vec<&str> = errors.iter().map(|error| error["key"].as_str().unwrap()).collect();
    assert_eq!(keys, expected);
    for error in errors {
        let line = error["line"].as_u64().unwrap();
        let key = error["key"].as_str().unwrap().rsplit('.').next().unwrap();
        assert!(
            bad.lines().nth(usize::try_from(line).unwrap() - 1).unwrap().contains(key),
            "{error}"
        );
        assert!(error["message"].is_string() && error["column"].as_u64() > Some(0), "{error}");
    }
    assert_eq!(document["studies"][1]["valid"], true);
    // Mended one by one, they are the errors of a run in turn: none is told of that is none.
    for (from, to) in [
        ("settle_s = 8.0", "settle_s = 1.5"),
        ("[0.42, 0.18]", "[0.42, 0.18, 0.14]"),
        ("rate_khz = 1.0", "rate_hz = 1000.0"),
        ("encoder_bits = 0", "encoder_bits = 18"),
        (", frame = \"tol\"", ""),
        ("jiont2", "joint2"),
        ("redy", "ready"),
    ] {
        let left = bad.replace(from, to);
        fs::write(folder.join("study.toml"), left).unwrap();
        let answer = phihat(&folder, &["check", "study.toml"]);
        assert_eq!(answer.err.lines().count(), 6, "without {from}:\n{}", answer.err);
    }
}
