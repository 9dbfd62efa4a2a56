//! `phihat reproduce`: all of its files or none, one document with `--json`, and one clear error for a bad argument.

use std::fs;
use std::path::Path;

use crate::support::{folder, json, phihat};

/// Every file below a folder, sorted, with its length.
fn files(folder: &Path) -> Vec<String> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
        } else {
            found.push(path.display().to_string());
        }
    }
    found.sort();
    found
}

#[test]
fn it_leaves_data_page_figures_and_studies_and_agrees_with_itself() {
    let folder = folder("reproduce");
    // A part: all of it is held against what the repository keeps by a step of `cargo xtask test`.
    let part = ["reproduce", "--quick", "--only", "arm in simulation"];
    let document = json(&folder, &[&part[..], &["--json"]].concat());
    let out = folder.join("out/reproduction");
    let whole: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(out.join("reproduction.json")).unwrap()).unwrap();
    // The page again, from the data alone: the same bytes.
    let page = fs::read(out.join("report.html")).unwrap();
    fs::remove_file(out.join("report.html")).unwrap();
    let again = phihat(&folder, &["report", "out/reproduction"]);
    assert_eq!((again.code, again.out.as_str()), (0, "report: out/reproduction/report.html\n"));
    assert!(fs::read(out.join("report.html")).unwrap() == page);
    let sections = whole["sections"].as_array().unwrap();
    let in_sections = |key: &str| -> Vec<_> {
        sections.iter().flat_map(|s| s[key].as_array().unwrap()).map(|v| v["id"].clone()).collect()
    };
    let statements = document["statements"].as_array().unwrap();
    let told: Vec<_> = statements.iter().map(|s| s["id"].clone()).collect();
    assert_eq!(told, in_sections("statements"));
    let paper = || statements.iter().filter(|s| s["origin"] == "paper");
    let count = |verdict: &str| paper().filter(|s| s["verdict"] == verdict).count();
    for verdict in ["as_printed", "with_correction", "refuted", "open"] {
        assert_eq!(document["counts"][verdict], count(verdict), "{verdict}");
    }
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    for id in &told {
        assert!(page.contains(&format!("claim-{}", id.as_str().unwrap())), "{id}");
    }
    for id in in_sections("figures") {
        let figure = out.join("figures").join(id.as_str().unwrap());
        assert!(figure.with_extension("svg").exists(), "{id}");
        assert_eq!(figure.with_extension("png").exists(), cfg!(feature = "png"), "{id}");
    }
    for study in statements.iter().flat_map(|s| s["studies"].as_array().into_iter().flatten()) {
        assert!(out.join(study.as_str().unwrap()).exists(), "{study}");
    }
    assert!(!files(&out).iter().any(|name| name.ends_with(".partial")));
    let kept = out.join("reproduction.json").display().to_string();
    let again = ["--out", "again", "--threads", "1", "--against", &kept];
    let again = phihat(&folder, &[&part[..], &again].concat());
    assert_eq!(again.code, 0, "{}{}", again.out, again.err);
    assert!(again.out.contains("agrees with"), "{}", again.out);
    assert_eq!(
        fs::read_to_string(folder.join("again/reproduction.json")).unwrap(),
        fs::read_to_string(kept).unwrap(),
        "the same bytes on any number of threads"
    );
}

#[test]
fn a_bad_argument_is_one_error_and_leaves_nothing() {
    let folder = folder("reproduce-bad");
    fs::write(folder.join("file"), "not a folder").unwrap();
    fs::write(folder.join("other.json"), "{\"format\": 2}").unwrap();
    fs::write(folder.join("older.json"), "{\"format\": 1}").unwrap();
    fs::write(folder.join("comparison.json"), "{\"format\": \"phihat-comparison\"}").unwrap();
    fs::create_dir_all(folder.join("taken/report.html")).unwrap();
    let before = files(&folder);
    for (arguments, words) in [
        (["--only", "no such part"], "parts:"),
        (["--out", "file"], "is not a folder"),
        (["--against", "missing.json"], "cannot be read"),
        (["--against", "other.json"], "no reproduction"),
        (["--against", "older.json"], "a document of format 1"),
        (["--against", "comparison.json"], "found a document of format \"phihat-comparison\""),
        (["--against", "comparison.json"], "expected a reproduction.json"),
        (["--against", "studies/first.toml"], "found no JSON"),
        (["--against", "-x"], "-x: cannot be read"),
        (["--only", "fig. 99"], "parts:"),
        (["--out", "taken"], "it is a folder"),
        (["--threads", "0"], "--threads"),
        (["--threads", "-1"], "-1 is not in 1..="),
    ] {
        let answer = phihat(&folder, &[&["reproduce"], &arguments[..]].concat());
        assert_eq!(answer.code, 2, "{arguments:?}: {}", answer.err);
        assert!(answer.err.contains(words), "{arguments:?}: {}", answer.err);
        assert!(answer.out.is_empty());
    }
    assert_eq!(files(&folder), before);
    assert!(!folder.join("out").exists());
}

#[test]
fn a_part_is_chosen_by_what_is_in_it_and_help_lists_the_parts() {
    let folder = folder("reproduce-part");
    for text in ["Fig. 8", "fig8-order"] {
        let document = json(&folder, &["reproduce", "--quick", "--only", text, "--json"]);
        let statements = document["statements"].as_array().unwrap();
        let ids: Vec<_> = statements.iter().map(|s| s["id"].as_str().unwrap()).collect();
        assert!(ids.contains(&"fig8-order") && ids.contains(&"fig4-start"), "{text}: {ids:?}");
        assert!(!ids.iter().any(|id| id.starts_with("theorem")), "{text}: {ids:?}");
    }
    let help = phihat(&folder, &["reproduce", "--help"]).out;
    let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(help.contains("theory, table 1, arm in simulation, arm in experiment"), "{help}");
}

/// Wrong if a stopped reproduction says nothing, or claims to have kept what it has not.
#[cfg(target_os = "linux")]
#[test]
fn a_stopped_reproduction_says_that_nothing_is_kept() {
    let folder = folder("reproduce-stopped");
    let stopped = crate::support::interrupted(
        &folder,
        &["reproduce", "--threads", "1"],
        "studies/first.toml",
    );
    assert_eq!(stopped.code, 130, "{}", stopped.err);
    assert!(stopped.err.contains("interrupted: nothing was written"), "{}", stopped.err);
    assert!(!folder.join("out").exists());
}

#[test]
fn on_an_own_arm_it_leaves_tables_and_figures_or_one_line() {
    let folder = folder("reproduce-own");
    let document = json(&folder, &["reproduce", "--study", "studies/first.toml", "--json"]);
    let out = folder.join("out/first/reproduction");
    assert_eq!(document["folder"], "out/first/reproduction");
    let beside = |name: &String| name.replace(&format!("{}/", out.display()), "");
    let names: Vec<_> =
        files(&out).iter().map(beside).filter(|name| !name.starts_with(".phihat")).collect();
    let figures = ["figures/own-fig-12.svg", "figures/own-fig-13.svg", "figures/own-fig-14.svg"];
    assert_eq!(names, [&figures[..], &["own.json", "report.html", "study.toml"]].concat());
    let whole: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(out.join("own.json")).unwrap()).unwrap();
    assert_eq!(whole, document["reproduction"]);
    for (arguments, words) in [
        (&["--study", "studies/panda_design.toml"][..], "states no [gains]"),
        (&["--study", "studies/panda_known.toml"], "loop.form"),
        (&["--study", "studies/none.toml"], "studies/none.toml"),
        (&["--study", "studies/first.toml", "--joint", "elbow"], "joints: joint1"),
        (&["--study", "studies/first.toml", "--phi", "studies/panda_csv.csv"], "t_s,phi_nm"),
        (&["--study", "studies/first.toml", "--only", "theory"], "cannot be used with"),
        (&["--phi", "phi.csv"], "--study"),
    ] {
        let answer = phihat(&folder, &[&["reproduce", "--out", "not-there"], arguments].concat());
        assert_eq!(answer.code, 2, "{arguments:?}");
        assert!(answer.err.contains(words), "{arguments:?}: {}", answer.err);
        assert!(!folder.join("not-there").exists());
    }
}
