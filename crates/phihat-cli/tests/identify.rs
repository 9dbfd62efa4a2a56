//! An arm without a description: known joint by joint, simulated as joints that do not push each other, and
//! identified from records. Wrong if the intervals from a record did not contain the recorded joints, if a
//! design from them did not hold in a run, if the simulated arm were not stated, or if a record that cannot
//! be used went through.

use std::fs;
use std::path::Path;

use crate::support::{folder, json, phihat};
use phihat_model::Workspace;
use phihat_sim::{Observed, Trace};
use phihat_study::Study;

/// Even draws from 0 to 1: a sequence of the golden ratio.
fn share(k: u32) -> f64 {
    (0.5 + 0.618_033_988_749_895 * f64::from(k)).fract()
}

fn between(low: f64, high: f64, k: u32) -> f64 {
    low * (high / low).powf(share(k))
}

/// A joint's inertia \[kg·m²\] and half of its jump \[N·m\].
type Truth = [(f64, f64); 2];

/// Two joints on two sines each, under gains that nobody designed.
fn study(truth: &Truth, k: u32, more: &str) -> String {
    let joints: Vec<String> = ["first", "second"]
        .iter()
        .zip(truth)
        .map(|(name, (inertia, coulomb))| {
            format!(
                "[[joint]]\nname = \"{name}\"\ninertia_min_kg_m2 = {inertia}\ninertia_max_kg_m2 = {inertia}\n\
                 phi_rate_max_nm_s = 1e3\nphi_jump_max_nm = {}\n",
                2.0 * coulomb
            )
        })
        .collect();
    let (slow, fast) = (between(0.2, 0.4, k + 40), between(0.9, 1.8, k + 50));
    let bits = 16 + k % 5;
    let inertia = [truth[0].0 * 0.8, truth[1].0 * 1.2];
    format!(
        "duration_s = 8.0\n{}[spec]\nsettle_s = 1.0\n[gains]\nbandwidth_rad_s = 20.0\nestimator_bandwidth_rad_s = \
         60.0\ninertia_kg_m2 = {inertia:?}\n[loop]\ndelay_samples = 1\n[sensor]\nencoder_bits = {bits}\nvelocity = \
         \"differenced\"\nvelocity_filter_hz = 100.0\n[reference]\nkind = \"sines\"\ncenter_rad = 0.0\n{more}\
         [[reference.sine]]\namplitude_rad = 0.4\nfrequency_hz = [{slow}, {}]\n\
         [[reference.sine]]\namplitude_rad = 0.1\nfrequency_hz = [{fast}, {}]\nphase_rad = [0.3, 1.1]\n",
        joints.concat(),
        1.3 * slow,
        1.2 * fast,
    )
}

/// Cost of a jump and a rate of φ, as in the search of bounds.
fn cost(rate: f64, jump: f64) -> f64 {
    0.02 * rate + jump
}

#[test]
fn records_tell_what_their_joints_are() {
    let folder = folder("identify");
    let (mut wide, mut off, mut least) = (0.0_f64, 0.0_f64, f64::INFINITY);
    for k in 0..8 {
        let truth: Truth =
            [0, 20].map(|j| (between(0.03, 2.0, k + j), between(0.05, 2.0, k + j + 10)));
        let text = study(&truth, k, "");
        fs::write(folder.join("arm.toml"), &text).unwrap();
        let run = phihat(&folder, &["run", "arm.toml"]);
        assert!(run.code == 0 && run.err.contains("do not push each other"), "{}", run.err);
        let told = json(&folder, &["identify", "out/arm", "--from", "1", "--json"]);
        let read = Study::read(&folder.join("arm.toml")).unwrap();
        let file = fs::File::open(folder.join("out/arm/trace.parquet")).unwrap();
        let observed = Observed::of(&Trace::read(file, &read).unwrap(), 1.0);
        for (joint, (inertia, coulomb)) in truth.iter().enumerate() {
            let found = &told["joints"][joint];
            let number = |key: &str| found[key].as_f64().unwrap();
            let end = |key: &str| found["inertia"][key].as_f64().unwrap();
            let (low, high) = (end("low_kg_m2"), end("high_kg_m2"));
            assert!(low <= *inertia && *inertia <= high, "{k}: {inertia} not in {low} … {high}");
            wide = wide.max(high / low);
            let dry = |key: &str| found["dry_friction"][key].as_f64().unwrap();
            println!(
                "{k}: dry friction {coulomb:.4} in {:.4} … {:.4}",
                dry("low_nm"),
                dry("high_nm")
            );
            off = off.max((dry("level_nm") / coulomb - 1.0).abs());
            assert!(dry("low_nm") <= 1.01 * coulomb && *coulomb <= 1.01 * dry("high_nm"));
            // φ as it truly was, against what the record, seen through its encoder and a filter, says of it.
            let truly = observed.phi(joint, (low * high).sqrt());
            let claimed = cost(number("phi_rate_max_nm_s"), number("phi_jump_max_nm"));
            least = least.min(claimed / cost(truly.rate, truly.jump));
        }
    }
    println!("inertia within a factor of {wide:.2}; φ claimed over true: {least:.2} at least");
    println!("levels of dry friction within {:.1} %", 100.0 * off);
    assert!(wide < 5.0 && least >= 1.0 && off < 0.1, "{wide} {least} {off}");
}

#[test]
fn a_record_becomes_a_design_that_holds() {
    let folder = folder("identify-design");
    let truth: Truth = [(0.6, 0.8), (0.2, 0.4)];
    fs::write(folder.join("arm.toml"), study(&truth, 3, "")).unwrap();
    assert_eq!(phihat(&folder, &["run", "arm.toml"]).code, 0);
    let identified = |record: &str| {
        let identify = ["identify", record, "--from", "1", "--margin", "2", "--out", "joints.toml"];
        let told = phihat(&folder, &identify);
        assert!(told.code == 0 && told.out.contains("an estimate, not a proof"), "{}", told.out);
        fs::read_to_string(folder.join("joints.toml")).unwrap()
    };
    let joints = identified("out/arm/trace.parquet");
    assert_eq!(phihat(&folder, &["simulate", "arm.toml", "--out", "text", "--csv"]).code, 0);
    assert_eq!(identified("text/trace.csv"), joints, "of either kind");
    let again = |end: &str| {
        format!(
            "duration_s = 8.0\n{joints}\n[spec]\nsettle_s = 2.0\nerror_bound_rad = \
             5e-3\n[design]\n[world]\njoint_inertia = \"{end}\"\n[loop]\nform = \"observer\"\ndelay_samples = \
             1\n[sensor]\nencoder_bits = 18\nvelocity = \"differenced\"\nvelocity_filter_hz = \
             \"design\"\n[reference]\nkind = \"sines\"\ncenter_rad = 0.0\n[[reference.sine]]\namplitude_rad = \
             0.3\nfrequency_hz = [0.3, 0.4]\n"
        )
    };
    let ends =
        if std::env::var_os("PHIHAT_ALL").is_some() { &["high", "low"][..] } else { &["low"] };
    for end in ends {
        let name = format!("{end}.toml");
        fs::write(folder.join(&name), again(end)).unwrap();
        let run = phihat(&folder, &["run", &name]);
        assert_eq!(run.code, 0, "{end}: {}{}", run.out, run.err);
        let other = if *end == "high" { "low" } else { "high" };
        assert!(run.err.contains(&format!("world.joint_inertia = \"{other}\"")), "{}", run.err);
        // Bounded joint by joint, and measured below it.
        let read = |name: &str| -> serde_json::Value {
            let path = folder.join("out").join(end).join(name);
            serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
        };
        let (gains, metrics) = (read("gains.json"), read("metrics.json"));
        for joint in 0..2 {
            let bound = gains["certificate"]["joints"][joint]["bounds"]["error_bound_rad"].as_f64();
            let measured = metrics["joints"][joint]["error_steady_max_rad"].as_f64().unwrap();
            assert!(measured <= bound.unwrap(), "{end}, joint {joint}: {measured} {bound:?}");
        }
        let gains = format!("out/{end}/gains.json");
        assert_eq!(phihat(&folder, &["verify", &gains, "--study", &name]).code, 0);
        let export = ["export", &gains, "--format", "c-header", "--out", "law.h"];
        assert_eq!(phihat(&folder, &export).code, 0);
    }
}

/// A study like that of a drive: a Panda, one sine per joint, friction that falls with speed, and an unknown payload.
/// Intervals of this record once excluded the inertia of all seven joints, without a warning.
#[test]
fn one_sine_per_joint_gives_no_false_interval() {
    let folder = folder("identify-one-sine");
    let text = "duration_s = 10.0\n[robot]\nname = \"panda\"\n[spec]\nsettle_s = 1.0\n[gains]\nbandwidth_rad_s = 15.0\n\
                estimator_bandwidth_rad_s = 30.0\ninertia_kg_m2 = [1.2, 1.7, 1.1, 1.1, 0.35, 0.35, \
                0.2]\n[loop]\ndelay_samples = 1\n[sensor]\nencoder_bits = 18\nvelocity = \
                \"differenced\"\nvelocity_filter_hz = 100.0\n[world]\nfriction = \"robot\"\ncoulomb_extra_nm = \
                0.3\nsubsteps = 12\npayload = { frame = \"panda_link8\", mass_kg = 0.5, com_m = [0.0, 0.0, 0.05] \
                }\nstiction = { breakaway_ratio = 1.5, stribeck_velocity_rad_s = 0.05, stiffness_nm_rad = 2000.0 \
                }\n[start]\ntorque_nm = \"gravity\"\n[reference]\nkind = \"sines\"\ncenter = \"ready\"\nfade_in_s = \
                1.0\n[[reference.sine]]\namplitude_rad = 0.25\nfrequency_hz = [0.30, 0.15, 0.20, 0.12, 0.25, 0.35, \
                0.18]\n";
    fs::write(folder.join("arm.toml"), text).unwrap();
    let run = phihat(&folder, &["run", "arm.toml", "--uncertified"]);
    assert!(run.code < 2, "{}", run.err);
    let study = Study::read(&folder.join("arm.toml")).unwrap();
    let file = fs::File::open(folder.join("out/arm/trace.parquet")).unwrap();
    let trace = Trace::read(file, &study).unwrap();
    let body = study.world.payload.as_ref().unwrap();
    let model = study.robot.plant_model().with_payload_on(&body.frame, &body.body()).unwrap();
    let mut truth = [(f64::INFINITY, 0.0_f64); 7];
    let mut m = [0.0; 49];
    for k in (1000..trace.len()).step_by(10) {
        let q: Vec<f64> = trace.joints.iter().map(|joint| joint.q[k]).collect();
        model.mass_matrix(&mut Workspace::new(&model), &q, &mut m);
        for (i, (low, high)) in truth.iter_mut().enumerate() {
            (*low, *high) = (low.min(m[8 * i]), high.max(m[8 * i]));
        }
    }
    let command = ["identify", "out/arm", "--from", "1", "--json"];
    let told = phihat(&folder, &command);
    let document: serde_json::Value = serde_json::from_str(&told.out).unwrap();
    let names: Vec<&str> = trace.joints.iter().map(|joint| &*joint.name).collect();
    for found in document["joints"].as_array().unwrap() {
        let at = names.iter().position(|name| found["name"] == *name).unwrap();
        let end = |key: &str| found["inertia"][key].as_f64().unwrap();
        println!("{}: {:?} in {} … {}", names[at], truth[at], end("low_kg_m2"), end("high_kg_m2"));
        assert!(end("low_kg_m2") <= truth[at].0 && truth[at].1 <= end("high_kg_m2"), "{found}");
    }
    let lacking = document["undetermined"].as_array().unwrap();
    assert!(lacking.iter().any(|joint| joint["name"] == names[0]), "{document:#}");
    assert_eq!(told.code, 1);
    let told = phihat(&folder, &["identify", "out/arm", "--from", "1"]);
    let line = told.out.lines().find(|line| line.contains(names[0]) && line.contains("no record"));
    let line = line.unwrap_or_else(|| panic!("{}", told.out));
    assert!(line.contains("one sine of 0.30 Hz") && line.contains("excite it so"), "{line}");
}

/// The numbers of a joint that slides mean m and N; they move alike.
#[test]
fn a_joint_that_slides_is_one_that_turns_with_other_units() {
    let folder = folder("identify-slides");
    let turns = study(&[(0.6, 0.8), (0.2, 0.4)], 3, "");
    let slides = turns.replacen("name = \"first\"\n", "name = \"first\"\nslides = true\n", 1);
    let run = |name: &str, text: &str| {
        fs::write(folder.join(format!("{name}.toml")), text).unwrap();
        let run = phihat(&folder, &["run", &format!("{name}.toml")]);
        assert_eq!(run.code, 0, "{}", run.err);
        let trace = fs::read(folder.join(format!("out/{name}/trace.parquet"))).unwrap();
        (run.out, trace)
    };
    let ((turned, one), (slid, other)) = (run("turns", &turns), run("slides", &slides));
    assert!(one == other, "the numbers differ");
    assert!(!turned.contains("mm/s") && slid.contains("mm/s"), "{slid}");
    let identify = ["identify", "out/slides/trace.parquet", "--from", "1", "--slides", "first"];
    let told = phihat(&folder, &identify).out;
    assert!(told.contains(" kg ") && told.contains(" N/s"), "{told}");
    let sections: Vec<&str> = told.lines().skip_while(|line| *line != "[[joint]]").collect();
    assert_eq!(sections[..3], ["[[joint]]", "name = \"first\"", "slides = true"]);
    assert_eq!(told.matches("slides = true").count(), 1, "{told}");
    let unknown = ["identify", "out/slides/trace.parquet", "--slides", "third"];
    refused(&folder, &unknown, &["trace.parquet", "\"third\"", "first, second"]);
}

fn refused(folder: &Path, arguments: &[&str], says: &[&str]) {
    let told = phihat(folder, arguments);
    assert!(told.code == 2 && (told.out.is_empty() || arguments[0] == "check"), "{}", told.err);
    assert_eq!(told.err.trim_end().lines().count(), 1, "{}", told.err);
    for part in says {
        assert!(told.err.contains(part), "`{part}` is not in {}", told.err);
    }
}

#[test]
fn what_cannot_be_used_is_told() {
    let folder = folder("identify-refused");
    let record = |name: &str, header: &str, rows: &[&str]| {
        fs::write(folder.join(name), format!("{header}\n{}\n", rows.join("\n"))).unwrap();
    };
    let header = "t_s,joint,q_rad,tau_nm";
    record("torque.csv", "t_s,joint,q_rad,current_a", &["0,a,1,2"]);
    refused(&folder, &["identify", "torque.csv"], &["torque.csv", "tau_nm or tau_applied_nm"]);
    record("text.csv", header, &["0,a,1,2", "0.001,a,one,2"]);
    refused(&folder, &["identify", "text.csv"], &["line 3", "q_rad is \"one\"", "finite number"]);
    record("gap.csv", header, &["0,a,1,2", "0.001,a,1,2", "0.002,a,1,2", "0.013,a,1,2"]);
    refused(&folder, &["identify", "gap.csv"], &["t_s = 0.002", "0.01", "cut the record there"]);
    record("short.csv", header, &["0,a,1,2", "0.001,a,1,2", "0.002,a,1,2"]);
    refused(&folder, &["identify", "short.csv"], &["too short", "0.04 s"]);
    record("uneven.csv", header, &["0,a,1,2", "0,b,1,2", "0.001,a,1,2"]);
    refused(&folder, &["identify", "uneven.csv"], &["joint b has 1 rows and joint a has 2"]);
    refused(&folder, &["identify", "short.csv", "--margin", "0.5"], &["--margin 0.5", "1 to 100"]);
    let still: Vec<String> =
        (0..9000).map(|k| format!("{},a,1.0,2.0", f64::from(k) * 1e-3)).collect();
    let still: Vec<&str> = still.iter().map(String::as_str).collect();
    record("still.csv", header, &still);
    let told = phihat(&folder, &["identify", "still.csv"]);
    assert!(told.code == 1 && told.err.is_empty(), "{}", told.err);
    assert!(told.out.contains("joint a: no record tells its inertia: it moves by"), "{}", told.out);
    // In a study.
    let text = study(&[(0.6, 0.8), (0.2, 0.4)], 3, "");
    let mistake = |from: &str, to: &str, says: &[&str]| {
        assert!(text.contains(from));
        fs::write(folder.join("arm.toml"), text.replacen(from, to, 1)).unwrap();
        refused(&folder, &["check", "arm.toml"], says);
    };
    let first = "inertia_min_kg_m2 = 0.6";
    mistake(first, "inertia_min_kg_m2 = 0.7", &["joint[0].inertia_min_kg_m2", "0.7", "is above"]);
    mistake("\"second\"", "\"first\"", &["joint[1].name", "another"]);
    mistake("phi_jump_max_nm = 1.6\n", "", &["joint[0].phi_jump_max_nm", "missing key"]);
    mistake("[spec]", "[robot]\nname = \"panda\"\n[spec]", &["robot", "keep one of them"]);
    mistake(
        "[spec]",
        "[world]\npayload = { mass_kg = 1.0 }\n[spec]",
        &["world.payload", "inertia"],
    );
    let ends = "phi_jump_max_nm = 1.6\nposition_min_rad = -1.0\n";
    mistake("phi_jump_max_nm = 1.6\n", ends, &["joint[0].position_max_rad", "missing key"]);
}
