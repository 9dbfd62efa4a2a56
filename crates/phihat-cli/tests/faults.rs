//! The fault matrix: resumable, the same bytes whatever the threads and interruptions, each run repeatable.

use std::fs;
use std::path::Path;

use crate::support::{Running, folder, phihat};

/// A folder with the arms of the matrix beside the project's studies.
fn with_arms(name: &str) -> std::path::PathBuf {
    let folder = folder(name);
    let arms = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../studies/faults");
    for entry in fs::read_dir(arms).unwrap() {
        let path = entry.unwrap().path();
        fs::copy(&path, folder.join("studies").join(path.file_name().unwrap())).unwrap();
    }
    folder
}

/// The middle severity of every fault.
const QUICK: [&str; 5] = ["faults", "studies/planar3r.toml", "--quick", "--only", "/2/1"];

fn summary(folder: &Path, out: &str) -> String {
    fs::read_to_string(folder.join(out).join("faults.json")).unwrap()
}

#[test]
fn killed_at_any_time_and_on_any_threads_the_answer_is_the_same_bytes() {
    let folder = with_arms("faults-killed");
    let whole = phihat(&folder, &[&QUICK[..], &["--out", "whole", "--threads", "1"]].concat());
    assert_eq!(whole.code, 0, "{}{}", whole.out, whole.err);
    for lines in [1, 10, 25] {
        let out = format!("killed-{lines}");
        // However late it is killed, it does not come further than to its answer.
        let arguments = [&QUICK[..], &["--out", &out, "--threads", "2"]].concat();
        let mut running = Running::of(&folder, &arguments, Some("pause 1 faults.json"));
        let journal = folder.join(&out).join("journal.jsonl");
        let written = || fs::read_to_string(&journal).map_or(0, |text| text.lines().count());
        assert!(running.until("so many runs are in the journal", || written() >= lines));
        assert!(running.kill() && !folder.join(&out).join("faults.json").exists());
        let resumed = phihat(&folder, &[&QUICK[..], &["--out", &out]].concat());
        assert_eq!(resumed.code, whole.code, "{}", resumed.err);
        assert_eq!(summary(&folder, &out), summary(&folder, "whole"));
    }
}

#[test]
fn the_quick_matrix_keeps_its_bars_on_two_arms() {
    let folder = with_arms("faults-quick");
    let arms = ["faults", "studies/planar3r.toml", "studies/panda.toml", "--quick", "--json"];
    let answer = phihat(&folder, &arms);
    assert_eq!(answer.code, 0, "{}{}", answer.out, answer.err);
    let text = summary(&folder, "out/faults");
    let summary: serde_json::Value = serde_json::from_str(&text).unwrap();
    let totals = &summary["totals"];
    assert!(totals["runs"].as_u64().unwrap() >= 2 * 30 * 3, "{totals}");
    for none in ["panicked", "not_finite", "beyond_limits", "bad_stops", "wrong_ends"] {
        assert_eq!(totals[none], 0, "{none}: {totals}");
    }
    let stopped = summary["runs"].as_array().unwrap().iter();
    let stopped = stopped.filter(|run| !run["ended"]["with"]["stopped"].is_null()).count();
    assert!(stopped > 20, "faults do stop the arm: {stopped}");
}

#[test]
fn a_run_is_repeated_with_its_trace_by_the_command_in_the_report() {
    let folder = with_arms("faults-trace");
    let name = "planar3r/m2/push/3/2";
    let only = ["faults", "studies/planar3r.toml", "--only", name];
    let first = phihat(&folder, &only);
    assert_eq!(first.code, 0, "{}{}", first.out, first.err);
    let out = folder.join("out/planar3r/faults");
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    let command = format!("phihat faults studies/planar3r.toml --only {name} --trace");
    assert!(page.contains(&command), "{page}");
    let words: Vec<_> = command.split(' ').skip(1).collect();
    assert_eq!(phihat(&folder, &words).code, 0);
    let run = out.join("runs").join(name);
    let trace = fs::read(run.join("trace.parquet")).unwrap();
    // The study left behind is the run: `phihat run` makes the same trace, bit for bit.
    let study = format!("out/planar3r/faults/runs/{name}/study.toml");
    let gains = format!("out/planar3r/faults/runs/{name}/gains.json");
    let again = phihat(&folder, &["simulate", &study, "--gains", &gains, "--out", "again"]);
    assert!(again.code < 2, "{}", again.err);
    assert_eq!(fs::read(folder.join("again/trace.parquet")).unwrap(), trace);
}

#[test]
fn bad_words_are_refused_with_what_would_be_right() {
    let folder = with_arms("faults-refused");
    for (words, told) in [
        (&["faults", "studies/planar3r.toml", "--only", "gremlins"][..], "no run's name contains"),
        (&["faults", "studies/planar3r.toml", "--orders", "5"], "orders are 1 to 4"),
        (&["faults", "studies/planar3r.toml", "studies/planar3r.toml"], "same name"),
        (&["faults", "studies/planar3r.toml", "--trace"], "choose 20 at most"),
        (&["faults", "studies/absent.toml"], "absent.toml"),
    ] {
        let answer = phihat(&folder, words);
        assert_eq!(answer.code, 2, "{words:?}");
        assert!(answer.err.contains(told), "{words:?}: {}", answer.err);
        assert!(!folder.join("out").exists(), "{words:?}");
    }
}
