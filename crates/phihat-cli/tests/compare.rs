//! The comparison as a command: resumable with the same bytes, every run again by its name, names that there are not.

use std::fs;

use crate::support::{Running, folder, interrupted_in, json, phihat};
use phihat_sim::Trace;
use phihat_study::Study;

const SMALL: [&str; 9] = [
    "compare",
    "studies/table1.toml",
    "--quick",
    "--only",
    "pd,computed-torque,proposed-2",
    "--worlds",
    "exact",
    "--threads",
    "1",
];

fn small<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&SMALL[..], more].concat()
}

#[test]
fn an_interrupted_comparison_goes_on_to_the_same_bytes_and_its_runs_are_made_again() {
    let folder = folder("compare");
    let whole = phihat(&folder, &small(&["--out", "whole"]));
    assert_eq!(whole.code, 0, "{}{}", whole.out, whole.err);
    for told in ["computed-torque", "proposed-2", "draws", "report: whole/report.html"] {
        assert!(whole.out.contains(told), "{}", whole.out);
    }
    let kept = |out: &str, name: &str| fs::read(folder.join(out).join(name)).unwrap();
    // What a crash leaves: half of the journal, and half a line.
    let journal = String::from_utf8(kept("whole", "journal.jsonl")).unwrap();
    let lines: Vec<_> = journal.lines().collect();
    // Tuning and draws of three rivals, and default and tuned gains of each in one world.
    assert_eq!(lines.len(), 12);
    fs::create_dir(folder.join("cut")).unwrap();
    let cut = format!("{}\n{}", lines[..7].join("\n"), &lines[7][..40]);
    fs::write(folder.join("cut/journal.jsonl"), cut).unwrap();
    let resumed = phihat(&folder, &small(&["--out", "cut"]));
    assert_eq!(resumed.code, 0, "{}", resumed.err);
    assert!(resumed.err.contains("line 8 is damaged and passed over"), "{}", resumed.err);
    assert_eq!(kept("cut", "compare.json"), kept("whole", "compare.json"));
    document_has_every_row_and_the_losses(&json(&folder, &small(&["--out", "cut", "--json"])));

    let page = String::from_utf8(kept("whole", "report.html")).unwrap();
    let name = "table1/pd/exact/tuned/1";
    let command = format!("phihat compare studies/table1.toml --quick --out whole --trace {name}");
    assert!(page.contains(&command));
    let words: Vec<_> = command.split(' ').skip(1).collect();
    let again = phihat(&folder, &words);
    assert_eq!(again.code, 0, "{}{}", again.out, again.err);
    // The trace has the error that the comparison has: worst joint, after the settling time.
    let run = folder.join("whole/runs").join(name);
    let study = Study::read(&run.join("study.toml")).unwrap();
    let read = |file: &str| Trace::read(fs::File::open(run.join(file)).unwrap(), &study).unwrap();
    let trace = read("trace.parquet");
    assert_eq!(phihat(&folder, &[&words[..], &["--csv"]].concat()).code, 0);
    assert!(read("trace.csv") == trace && !run.join("trace.parquet").exists());
    assert_eq!(phihat(&folder, &words).code, 0);
    assert!(read("trace.parquet") == trace && !run.join("trace.csv").exists());
    let largest = largest_error(&trace, 2.0);
    let all: serde_json::Value = serde_json::from_slice(&kept("whole", "compare.json")).unwrap();
    let row = all["rows"].as_array().unwrap().iter().find(|row| row["rival"] == "pd").unwrap();
    let cells = row["cells"].as_array().unwrap();
    let tuned = cells.iter().find(|cell| cell["gains"] == "tuned").unwrap();
    let stated = tuned["worst"]["error_peak_rad"].as_f64().unwrap();
    assert!((largest - stated).abs() < 1e-6 * stated, "{largest} {stated}");
    let report = kept("whole", &format!("runs/{name}/report.html"));
    assert!(String::from_utf8(report).unwrap().contains("bandwidth"));
}

/// Largest |e| of any joint from a time on.
fn largest_error(trace: &Trace, from: f64) -> f64 {
    let from = trace.index_at(from);
    let all = trace.joints.iter().flat_map(|joint| &joint.e[from..]);
    all.fold(0.0, |most, e| e.abs().max(most))
}

fn document_has_every_row_and_the_losses(document: &serde_json::Value) {
    assert_eq!(document["folder"], "cut");
    assert_eq!(document["worlds"], serde_json::json!(["exact"]));
    assert_eq!(document["rows"].as_array().unwrap().len(), 3);
    assert_eq!(document["runs"], 6);
    assert_eq!(document["rows"][0]["tuned"][0]["world"], "exact");
    let losses = document["losses"].as_array().unwrap();
    // A law without memory has less of it than one with an estimator.
    let memory = losses.iter().find(|loss| loss["column"] == "states").unwrap();
    assert_eq!(memory["ours"], "proposed-2");
    assert_eq!(memory["most"]["theirs"], 0.0);
}

#[test]
fn rivals_are_listed_and_shown() {
    let folder = folder("compare-list");
    let list = json(&folder, &["compare", "--list", "--json"]);
    let ids: Vec<_> = list.as_array().unwrap().iter().map(|r| r["id"].as_str().unwrap()).collect();
    assert!(ids.contains(&"pd") && ids.contains(&"proposed-2"), "{ids:?}");
    let table = phihat(&folder, &["compare", "--list"]);
    assert!(ids.iter().all(|id| table.out.contains(id)), "{}", table.out);
    for work in ["[3]", "[16]", "[17]", "[18]", "[19]"] {
        assert!(table.out.contains(work), "{work}: {}", table.out);
    }
    let card = phihat(&folder, &["compare", "--rival", "computed-torque"]);
    assert_eq!(card.code, 0);
    for told in ["grade: A", "not model free", "bandwidth", "rad/s", "source:", "default"] {
        assert!(card.out.contains(told), "{told}: {}", card.out);
    }
    let pd = phihat(&folder, &["compare", "--rival", "pd"]).out;
    assert!(pd.contains("nothing but U") && pd.contains("K_P = U ω²"), "{pd}");
    let designed = phihat(&folder, &["compare", "--rival", "proposed-designed"]).out;
    assert!(designed.contains("`phihat design STUDY`"), "{designed}");
}

#[test]
fn bad_words_are_refused_with_what_would_be_right() {
    let folder = folder("compare-refused");
    let study = "studies/table1.toml";
    for (words, told) in [
        (&["compare"][..], "STUDIES"),
        (&["compare", "--rival", "computed-torqe"], "did you mean `computed-torque`?"),
        (&["compare", study, "--only", "pdd"], "did you mean `pd`?"),
        (&["compare", study, "--worlds", "frction"], "did you mean `friction`?"),
        (&["compare", study, study], "same name"),
        (&["compare", "studies/absent.toml"], "absent.toml"),
        (&["compare", "studies/absent.toml"], "the study cannot be read"),
        (&["compare", study, "--trace", "table1/pd"], "ARM/RIVAL/WORLD"),
        (&["compare", study, "--trace", "table2/pd/exact/tuned/1"], "ARM/RIVAL/WORLD"),
        (&["compare", study, "--trace", "table1/pd/exact/tuned/9"], "ARM/RIVAL/WORLD"),
        (
            &["compare", study, "--trace", "table1/pd/exact/tuned/1", "--only", "pd"],
            "leave out --only",
        ),
        (&["compare", study, "--threads", "0"], "0"),
        (&["compare", study, "--seeds", "-1"], "-1 is not in 1..=1000"),
        (&["compare", study, "--threads", "-1"], "-1 is not in 1..="),
        (&["compare", study, "--seeds", "0"], "0"),
        (&["compare", study, "--list"], "--list"),
    ] {
        let answer = phihat(&folder, words);
        assert_eq!(answer.code, 2, "{words:?}: {}", answer.out);
        assert!(answer.err.contains(told), "{words:?}: {}", answer.err);
        assert!(!answer.err.contains("error: error"), "{words:?}: {}", answer.err);
        assert!(!answer.err.contains("use '--"), "{words:?}: {}", answer.err);
        assert!(!folder.join("out").exists(), "{words:?}");
    }
}

#[test]
fn results_that_cannot_be_written_are_told_before_any_run() {
    let folder = folder("compare-unwritable");
    for name in ["compare.json", "report.html", "journal.jsonl"] {
        let out = folder.join("taken").join(name);
        fs::create_dir_all(&out).unwrap();
        let answer = phihat(&folder, &small(&["--out", "taken"]));
        assert_eq!(answer.code, 2, "{}", answer.out);
        assert!(
            answer.err.contains(name) && answer.err.contains("it is a folder"),
            "{}",
            answer.err
        );
        assert_eq!(fs::read_dir(folder.join("taken")).unwrap().count(), 1, "nothing is left");
        fs::remove_dir(&out).unwrap();
    }
    fs::write(folder.join("file"), "").unwrap();
    let answer = phihat(&folder, &small(&["--out", "file/deeper"]));
    assert_eq!(answer.code, 2, "{}", answer.out);
    assert!(answer.err.contains("file: is not a folder"), "{}", answer.err);
    let answer = phihat(
        &folder,
        &["compare", "studies/table1.toml", "--out", "file", "--trace", "table1/pd/exact/tuned/1"],
    );
    assert_eq!(answer.code, 2, "{}", answer.out);
}

/// Wrong if a stopped comparison says nothing of what it keeps.
#[cfg(unix)]
#[test]
fn a_stopped_comparison_says_what_is_saved_and_how_to_go_on() {
    let folder = folder("compare-stopped");
    // The first line is in the journal; the operation that has the system keep it does not return.
    let running =
        Running::of(&folder, &small(&["--out", "stopped"]), Some("pause 4 journal.jsonl"));
    let stopped = interrupted_in(running, &folder.join("stopped/journal.jsonl"));
    assert_eq!(stopped.code, 130, "{}", stopped.err);
    assert!(
        stopped.err.contains("interrupted: what is done is saved in stopped/journal.jsonl"),
        "{}",
        stopped.err
    );
    assert!(stopped.err.contains("the same command goes on"), "{}", stopped.err);
}
