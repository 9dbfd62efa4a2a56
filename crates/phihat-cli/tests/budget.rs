//! Advice on a study that no gains serve. Wrong if advice did not lead to gains when it is followed as typed,
//! if it requested what the robot's interface does not take, if a run had more error than its part, or if the
//! page were not whole.

use std::fs;
use std::path::Path;

use crate::support::{folder, json, phihat};
use serde_json::Value;

/// A planar arm of two joints that is to keep an error \[rad\]; `more` goes to the end of the file.
fn planar(error: f64, more: &str) -> String {
    format!(
        "duration_s = 2.0\n[robot]\nname = \"planar3r\"\nlocked = {{ joint2 = 0.8 }}\n[spec]\nsettle_s = \
         1.0\nerror_bound_rad = {error:e}\n[design]\norders = [1]\npayload_max_kg = 0.3\n[loop]\nform = \
         \"observer\"\nrate_hz = 500.0\ndelay_samples = 1\n[sensor]\nencoder_bits = 18\nvelocity = \
         \"differenced\"\nvelocity_filter_hz = 60.0\n[reference]\nkind = \"sines\"\ncenter = \"ready\"\nfade_in_s = \
         0.5\n[[reference.sine]]\namplitude_rad = 0.2\nfrequency_hz = 0.5\n{more}"
    )
}

/// An error a little below what is possible.
fn just_too_small(folder: &Path, text: &dyn Fn(f64) -> String) -> (f64, Value) {
    let mut error = 1e-6;
    let mut told = Value::Null;
    for share in [1.0, 0.8, 0.5, 0.3] {
        fs::write(folder.join("small.toml"), text(error)).unwrap();
        told = json(folder, &["design", "small.toml", "--json"]);
        if told["outcome"] == "infeasible" && share < 1.0 {
            return (error, told);
        }
        let clauses = told["reason"]["clauses"].as_array().cloned().unwrap_or_default();
        let possible = clauses.iter().find_map(|clause| clause["possible"].as_f64());
        error = possible.map_or(error * 0.7, |possible| 0.8 * possible);
    }
    panic!("never infeasible: {told:#}");
}

/// The study with a change as it is told.
fn followed(text: &str, change: &Value) -> Option<String> {
    let (key, value) = (change["key"].as_str().unwrap(), change["value"].as_str().unwrap());
    let name = key.rsplit('.').next().unwrap();
    if key == "reference" {
        let factor: f64 = value.split('×').nth(1)?.split(',').next()?.trim().parse().ok()?;
        return Some(
            text.replace("fade_in_s = 0.5", &format!("fade_in_s = {}", 0.5 * factor))
                .replace("frequency_hz = 0.5", &format!("frequency_hz = {}", 0.5 / factor))
                .replace("duration_s = 2.0", &format!("duration_s = {}", 2.0 * factor)),
        );
    }
    let mut lines: Vec<String> = text
        .lines()
        .filter(|line| !line.starts_with(&format!("{name} ")))
        .map(str::to_owned)
        .collect();
    let section = format!("[{}]", key.split('.').next().unwrap());
    let at = lines.iter().position(|line| *line == section)?;
    lines.insert(at + 1, format!("{name} = {value}"));
    Some(lines.join("\n"))
}

/// The nearest law, joint by joint: parts that are not within others add up to the whole.
fn assert_parts_add_up(budget: &Value) {
    for joint in budget["joints"].as_array().unwrap() {
        let total = joint["total_rad"].as_f64().unwrap();
        assert!(total > 0.0 && joint["error_bound_rad"].as_f64().unwrap() > 0.0);
        let parts = joint["parts"].as_array().unwrap();
        let sum: f64 = parts
            .iter()
            .filter(|p| p["within"] == false)
            .map(|p| p["error_rad"].as_f64().unwrap())
            .sum();
        assert!((sum / total - 1.0).abs() < 1e-9, "{joint:#}");
    }
}

#[test]
fn advice_leads_to_gains_as_typed_and_the_page_is_there() {
    let folder = folder("budget");
    // Its dry friction is between nothing and somewhat more than the world's.
    let unsure = |error: f64| {
        let friction = "payload_max_kg = 0.3\ncoulomb_max_nm = 1.0";
        planar(error, "").replacen("payload_max_kg = 0.3", friction, 1)
    };
    let (error, told) = just_too_small(&folder, &unsure);
    let budget = &told["budget"];
    let changes = budget["changes"].as_array().unwrap();
    println!("{error:e}\n{budget:#}");
    assert!(changes.iter().any(|change| change["helps"] == true), "{changes:#?}");
    for change in changes.iter().filter(|change| change["helps"] == true) {
        let text = followed(&unsure(error), change).unwrap();
        fs::write(folder.join("followed.toml"), &text).unwrap();
        let again = json(&folder, &["design", "followed.toml", "--json"]);
        assert_eq!(again["outcome"], "designed", "{change:#}\n{text}");
        let unproved = again["gains"]["certificate"]["unproved"].as_array();
        assert!(unproved.is_none_or(Vec::is_empty), "{change:#}: {unproved:?}");
    }
    assert!(changes.iter().any(|change| change["key"] == "design.coulomb_max_nm"), "{changes:#?}");
    assert_parts_add_up(budget);
    assert!(budget["front"].as_array().unwrap().len() > 1);
    assert!(
        budget["words"][0]
            .as_str()
            .unwrap()
            .contains("with one sample of delay and a 60 Hz filter")
    );
    let page = fs::read_to_string(folder.join("out/small/budget.html")).unwrap();
    let data: Value =
        serde_json::from_str(&fs::read_to_string(folder.join("out/small/budget.json")).unwrap())
            .unwrap();
    assert_eq!(&data, budget);
    for part in
        ["Error budget: small", "dry friction", "encoder", "What one change would buy", "joint3"]
    {
        assert!(page.contains(part), "{part}");
    }
    // The front is drawn: a mark for each law that the document has.
    let picture =
        page.split("<figure").nth(1).and_then(|rest| rest.split("</svg>").next()).unwrap();
    let laws = budget["front"].as_array().unwrap();
    let filled = picture.split("<path class=\"f").skip(1).filter_map(|path| path.split('"').nth(2));
    let marks: usize = filled.map(|path| path.matches('M').count()).sum();
    assert!(marks >= laws.len(), "{picture}");
    // For people: the same, and no inequality unless asked for.
    let plain = phihat(&folder, &["design", "small.toml"]);
    assert_eq!(plain.code, 1);
    assert!(
        plain.out.contains("NO GAINS") && plain.out.contains("out/small/budget.html"),
        "{}",
        plain.out
    );
    assert!(!plain.out.contains("laws tried"), "{}", plain.out);
    let run = phihat(&folder, &["run", "small.toml", "--verbose", "--out", "elsewhere"]);
    assert_eq!(run.code, 1);
    assert!(run.err.contains("laws tried") && run.err.contains("NO GAINS"), "{}", run.err);
    assert!(folder.join("elsewhere/budget.html").is_file());
}

#[test]
fn a_robots_interface_is_not_told_to_be_another() {
    let folder = folder("budget-profile");
    let profile = "[profile]\nname = \"ur\"\n";
    fs::write(folder.join("small.toml"), planar(2e-5, profile)).unwrap();
    let told = json(&folder, &["design", "small.toml", "--json"]);
    assert_eq!(told["outcome"], "infeasible");
    let changes = told["budget"]["changes"].as_array().unwrap();
    assert!(!changes.is_empty());
    for change in changes {
        let key = change["key"].as_str().unwrap();
        assert!(
            !["loop.rate_hz", "loop.delay_samples", "sensor.encoder_bits", "robot.armature_kg_m2"]
                .contains(&key),
            "{key}"
        );
    }
}

#[test]
fn a_design_that_succeeds_has_a_budget_that_runs_keep() {
    let folder = folder("budget-tube");
    let text = planar(2e-2, "").replace("rate_hz = 500.0", "rate_hz = 1000.0");
    fs::write(folder.join("fine.toml"), &text).unwrap();
    let told = json(&folder, &["design", "fine.toml", "--budget", "--json"]);
    assert_eq!(told["outcome"], "designed", "{told:#}");
    let budget = &told["budget"];
    assert_eq!(budget["basis"], "tube", "{budget:#}");
    // The motion alone, run: no friction, exact encoder, the payload in the middle, held at the start.
    let alone = text
        .replace("encoder_bits = 18\n", "")
        .replace("payload_max_kg = 0.3", "payload_max_kg = 0.3\ncoulomb_max_nm = 0.0")
        .replace(
            "[reference]",
            "[world]\nfriction = \"none\"\npayload = { mass_kg = 0.15 }\n[start]\ntorque_nm = \
            \"gravity\"\n[reference]",
        );
    fs::write(folder.join("alone.toml"), alone).unwrap();
    let file = told["file"].as_str().unwrap();
    let run =
        json(&folder, &["simulate", "alone.toml", "--gains", file, "--uncertified", "--json"]);
    let of_part = |joint: &Value, cause: &str| {
        let parts = joint["parts"].as_array().unwrap();
        parts.iter().find(|p| p["cause"] == cause).map(|p| p["error_rad"].as_f64().unwrap())
    };
    let tube = told["gains"]["certificate"]["tube"]["joints"].as_array().unwrap();
    for (i, joint) in budget["joints"].as_array().unwrap().iter().enumerate() {
        let measured = run["metrics"]["joints"][i]["error_steady_max_rad"].as_f64().unwrap();
        let motion = of_part(joint, "motion").unwrap();
        // Viscous friction is out of the run too: a little less than the whole of it.
        assert!(measured <= motion * 1.05, "joint {i}: {measured} {motion}");
        assert!(motion < 8.0 * measured, "joint {i}: {measured} {motion}");
        let total = joint["total_rad"].as_f64().unwrap();
        assert!((total / tube[i]["error_bound_rad"].as_f64().unwrap() - 1.0).abs() < 1e-3);
        assert!(
            of_part(joint, "encoder").unwrap() > 0.0 && of_part(joint, "payload").unwrap() > 0.0
        );
    }
    assert!(folder.join("out/fine/budget.html").is_file());
}
