//! A run folder is one record, or none: what does not belong together is refused by name, a trace is its study's, and a
//! folder or journal that another process holds is left as it is.

use std::fs;
use std::path::{Path, PathBuf};

use crate::support::{files_of, folder, phihat, small};
use phihat_campaign::Journal;
use phihat_session::disk::Lock;
use phihat_session::sha256;

/// A folder with two studies that differ, and the record of each under its name.
fn two_records(name: &str) -> PathBuf {
    let folder = folder(name);
    for (name, amplitude, bandwidth) in [("a", 0.3, 5.0), ("b", 0.2, 4.0)] {
        let file = format!("{name}.toml");
        fs::write(folder.join(&file), small(name, amplitude, bandwidth)).unwrap();
        let run = phihat(&folder, &["run", &file, "--out", name]);
        assert_eq!(run.code, 0, "{}", run.err);
    }
    folder
}

/// The error of `phihat report`, which must be one and leave everything as it was.
fn refusal(folder: &Path, trace: &str) -> String {
    let before = files_of(folder);
    let answer = phihat(folder, &["report", trace]);
    assert_eq!(answer.code, 2, "{}{}", answer.out, answer.err);
    assert_eq!(answer.err.matches("error: ").count(), 1, "{}", answer.err);
    assert!(files_of(folder) == before, "{}", answer.err);
    answer.err
}

#[test]
fn files_of_two_runs_are_no_record() {
    let folder = two_records("records-mixed");
    for name in ["study.toml", "gains.json", "metrics.json", "trace.parquet"] {
        let own = fs::read(folder.join("a").join(name)).unwrap();
        fs::copy(folder.join("b").join(name), folder.join("a").join(name)).unwrap();
        let told = refusal(&folder, "a/trace.parquet");
        let words = format!("a/{name}: is not the file that the run left: its SHA-256 is ");
        assert!(
            told.contains(&words) && told.contains("make the record again: phihat run a.toml"),
            "{told}"
        );
        fs::write(folder.join("a").join(name), own).unwrap();
        assert_eq!(phihat(&folder, &["report", "a/trace.parquet"]).code, 0, "whole again");
    }
    fs::remove_file(folder.join("a/metrics.json")).unwrap();
    assert!(refusal(&folder, "a/trace.parquet").contains("a/metrics.json: is missing"));
    fs::remove_file(folder.join("b/run.json")).unwrap();
    assert!(
        refusal(&folder, "b/trace.parquet")
            .contains("b/run.json: is missing: the files beside it are no whole record")
    );
    // What earlier versions left says nothing of its files.
    let old =
        fs::read_to_string(folder.join("a/run.json")).unwrap().replace("\"files\"", "\"filed\"");
    fs::write(folder.join("a/run.json"), old).unwrap();
    assert!(
        refusal(&folder, "a/trace.parquet").contains("a/run.json: is not what this version leaves")
    );
    fs::copy(folder.join("b/trace.parquet"), folder.join("b/copy.parquet")).unwrap();
    assert!(refusal(&folder, "b/copy.parquet").contains("is not the trace of a run"));
}

/// Puts another trace into a record, as if the run had left it.
fn with_trace(record: &Path, trace: &str) {
    let sum = |text: &str| sha256(&mut text.as_bytes()).unwrap();
    let path = record.join("trace.csv");
    let (old, run) = (fs::read_to_string(&path).unwrap(), record.join("run.json"));
    let text = fs::read_to_string(&run).unwrap();
    fs::write(&run, text.replace(&sum(&old), &sum(trace))).unwrap();
    fs::write(path, trace).unwrap();
}

/// A study whose gains are designed from a trace.
fn from_a_trace(study: &str) -> String {
    let (start, rest) = study.split_once("[gains]").unwrap();
    let (_, reference) = rest.split_once("[reference]").unwrap();
    let design =
        "[design]\nphi_from = \"trace\"\ninertia_from = \"trace\"\ntrace = \"out/trace.csv\"\n";
    format!("{start}{design}[reference]{reference}")
}

/// The record of an arm of two joints in `out`, its trace as a text, a study that is designed from its trace,
/// and the trace.
fn two_joints(name: &str) -> (PathBuf, String) {
    let folder = folder(name);
    let two = small("two", 0.2, 4.0).replace("joint2 = 0.0, ", "");
    fs::write(folder.join("from.toml"), from_a_trace(&two)).unwrap();
    fs::write(folder.join("two.toml"), two).unwrap();
    let run = phihat(&folder, &["run", "two.toml", "--out", "out", "--csv"]);
    assert_eq!(run.code, 0, "{}", run.err);
    let trace = fs::read_to_string(folder.join("out/trace.csv")).unwrap();
    (folder, trace)
}

#[test]
fn a_trace_has_its_studys_joints_period_and_samples() {
    let (folder, whole) = two_joints("records-traces");
    let (head, rows) = whole.split_once('\n').unwrap();
    let lines = |keep: &dyn Fn(usize) -> bool| -> String {
        let kept = rows.lines().enumerate().filter(|(k, _)| keep(*k)).map(|(_, line)| line);
        [head].into_iter().chain(kept).fold(String::new(), |text, line| text + line + "\n")
    };
    let third = |line: &str| line.replacen("joint2", "joint3", 1);
    let more = rows.lines().fold(format!("{head}\n"), |text, line| {
        let extra = if line.contains("joint2") { third(line) + "\n" } else { String::new() };
        text + line + "\n" + &extra
    });
    let first = rows.lines().next().unwrap();
    let many: String =
        (0..60_000).map(|k| first.replacen("joint1", &format!("n{k}"), 1) + "\n").collect();
    let next = "is not the next one";
    for (trace, told) in [
        (
            whole.replace("joint2", "elbow"),
            format!(
                "line 3: joint \"elbow\" {next}, \"joint2\"; the study's arm has 2, in this order: joint1, joint2"
            ),
        ),
        (lines(&|k| k % 2 == 0), format!("line 3: joint \"joint1\" {next}, \"joint2\"")),
        (lines(&|k| k % 2 == 1), format!("line 2: joint \"joint2\" {next}, \"joint1\"")),
        (
            whole.replace("joint1", "j").replace("joint2", "joint1").replace(",j,", ",joint2,"),
            format!("line 2: joint \"joint2\" {next}"),
        ),
        (more, format!("line 4: joint \"joint3\" {next}, \"joint1\"")),
        (format!("{head}\n{many}"), format!("line 2: joint \"n0\" {next}")),
        (
            format!("{head}\n"),
            "no sample follows; a trace has one row per sample and joint".to_owned(),
        ),
        (
            lines(&|k| k / 2 % 2 == 0),
            "line 4: time 0.002 s does not follow 0.0 s by the study's period, 0.001 s".to_owned(),
        ),
        (lines(&|k| k < 5), "the last sample has no row for joint joint2".to_owned()),
    ] {
        with_trace(&folder.join("out"), &trace);
        let error = refusal(&folder, "out/trace.csv");
        assert!(error.contains("out/trace.csv: ") && error.contains(&told), "{told}\n{error}");
        // The same where gains are designed from it.
        let answer = phihat(&folder, &["design", "from.toml"]);
        assert_eq!(answer.code, 2, "{}{}", answer.out, answer.err);
        assert!(answer.err.contains(&told), "{told}\n{}", answer.err);
    }
    with_trace(&folder.join("out"), &whole);
    assert_eq!(phihat(&folder, &["report", "out/trace.csv"]).code, 0);
}

/// As a run that diverged may end.
#[test]
fn a_trace_with_values_that_are_no_numbers_has_its_page_and_nothing_is_designed_from_it() {
    let (folder, whole) = two_joints("records-diverged");
    let last = whole.trim_end().rsplit_once('\n').unwrap().1;
    let value = last.split(',').nth(4).unwrap();
    let diverged = whole.replace(last, &last.replacen(value, "NaN", 1));
    with_trace(&folder.join("out"), &diverged);
    assert_eq!(phihat(&folder, &["report", "out/trace.csv"]).code, 0);
    let answer = phihat(&folder, &["design", "from.toml"]);
    assert_eq!(answer.code, 2, "{}{}", answer.out, answer.err);
    let told = "out/trace.csv: ddq_rad_s2 of joint joint2 at 0.049 s is no number";
    assert!(answer.err.contains(told), "{}", answer.err);
}

#[test]
fn of_an_older_page_nothing_stays_and_of_the_users_files_all() {
    let folder = two_records("records-pages");
    fs::write(folder.join("a/figures/bode.svg"), "of an older certificate").unwrap();
    fs::write(folder.join("a/figures/mine.svg"), "the user's").unwrap();
    fs::write(folder.join("a/notes.txt"), "the user's").unwrap();
    assert_eq!(phihat(&folder, &["run", "b.toml", "--out", "a"]).code, 0);
    let (now, fresh) = (files_of(&folder.join("a")), files_of(&folder.join("b")));
    let mut of_users = now.clone();
    of_users.retain(|name, _| !fresh.contains_key(name));
    let names: Vec<_> = of_users.keys().map(|name| name.to_str().unwrap()).collect();
    assert_eq!(names, ["figures/mine.svg", "notes.txt"]);
    // Without a page there is none.
    assert_eq!(phihat(&folder, &["simulate", "a.toml", "--out", "b"]).code, 0);
    let names: Vec<_> = files_of(&folder.join("b")).into_keys().collect();
    let whole =
        [".phihat.lock", "gains.json", "metrics.json", "run.json", "study.toml", "trace.parquet"];
    assert_eq!(names, whole.map(PathBuf::from));
}

#[test]
fn a_record_has_one_trace_and_either_kind_is_read_by_all() {
    let folder = two_records("records-kinds");
    let record = |name: &str| {
        let (done, trace) = phihat_session::recorded(&folder.join(name)).unwrap();
        (done.figures(), trace)
    };
    let traces = || -> Vec<_> {
        let all = files_of(&folder.join("a")).into_keys();
        all.filter(|path| path.starts_with("trace.parquet") || path.starts_with("trace.csv"))
            .collect()
    };
    let (page, first) = (fs::read(folder.join("a/report.html")).unwrap(), record("a"));
    assert_eq!(traces(), [PathBuf::from("trace.parquet")]);
    for (more, file) in [(&["--csv"][..], "trace.csv"), (&[], "trace.parquet")] {
        let run = [&["run", "a.toml", "--out", "a"], more].concat();
        assert_eq!(phihat(&folder, &run).code, 0);
        assert_eq!(traces(), [PathBuf::from(file)]);
        assert!(record("a") == first, "{file}");
        for named in ["a".to_owned(), format!("a/{file}")] {
            fs::remove_file(folder.join("a/report.html")).unwrap();
            let made = phihat(&folder, &["report", &named]);
            assert_eq!((made.code, made.out.as_str()), (0, "report: a/report.html\n"));
            assert!(fs::read(folder.join("a/report.html")).unwrap() == page, "{named}");
        }
        assert_eq!(phihat(&folder, &["verify", "--run", "a"]).code, 0, "{file}");
    }
    // One that is not of the record is refused, wherever it came from.
    fs::write(folder.join("a/trace.csv"), "t_s,joint\n").unwrap();
    assert!(refusal(&folder, "a/trace.csv").contains("a/trace.csv: is not named in run.json"));
    assert_eq!(phihat(&folder, &["report", "a"]).code, 0);
    assert!(refusal(&folder, "studies").contains("studies/trace.parquet: cannot be read"));
}

#[test]
fn a_folder_at_work_is_left_as_it_is() {
    let folder = two_records("records-busy");
    let arm = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../studies/faults/planar3r.toml");
    fs::copy(arm, folder.join("arm.toml")).unwrap();
    let _held = Lock::take(&folder.join("a")).unwrap();
    let mut journal = Journal::open(&folder.join("journal.jsonl")).unwrap();
    journal.append("run", &1).unwrap();
    let before = files_of(&folder);
    let rivals = ["--only", "pd", "--worlds", "exact", "--quick", "--out", "."];
    for words in [
        &["run", "b.toml", "--out", "a"][..],
        &["simulate", "b.toml", "--out", "a"],
        &["report", "a/trace.parquet"],
        &["reproduce", "--only", "table 2", "--out", "a"],
        &["faults", "arm.toml", "--quick", "--only", "push/2", "--out", "."],
        &["faults", "arm.toml", "--quick", "--only", "push/2", "--out", ".", "--fresh"],
        &[&["compare", "studies/table1.toml", "--fresh"], &rivals[..]].concat(),
    ] {
        let answer = phihat(&folder, words);
        assert_eq!(answer.code, 2, "{words:?}: {}{}", answer.out, answer.err);
        let told =
            ["another phihat is at work in this folder", "another campaign writes to this journal"];
        assert!(told.iter().any(|told| answer.err.contains(told)), "{words:?}: {}", answer.err);
        assert!(files_of(&folder) == before, "{words:?}");
    }
}

#[test]
fn a_journal_begun_afresh_is_emptied_and_a_held_one_is_not() {
    let folder = folder("records-fresh");
    let path = folder.join("journal.jsonl");
    let mut journal = Journal::open(&path).unwrap();
    journal.append("run", &1).unwrap();
    assert!(Journal::afresh(&path).is_err());
    assert_eq!(fs::read_to_string(&path).unwrap().lines().count(), 1);
    journal.append("another", &2).unwrap();
    drop(journal);
    assert_eq!(Journal::open(&path).unwrap().len(), 2);
    let mut journal = Journal::afresh(&path).unwrap();
    assert!(journal.is_empty());
    journal.append("new", &3).unwrap();
    drop(journal);
    assert_eq!(Journal::open(&path).unwrap().entry("new"), Some("3"));
}

/// Wrong if a link that somebody put where a file is prepared leads the command out of its folder.
#[cfg(unix)]
#[test]
fn links_are_not_followed() {
    let folder = two_records("records-links");
    fs::write(folder.join("victim"), "precious").unwrap();
    for name in ["trace.parquet", "trace.csv", "run.json", "study.toml", "report.html"] {
        for place in [format!("{name}.partial"), format!(".{name}.partial"), name.to_owned()] {
            let _ = fs::remove_file(folder.join("a").join(&place));
            std::os::unix::fs::symlink("../victim", folder.join("a").join(place)).unwrap();
        }
    }
    assert_eq!(phihat(&folder, &["run", "b.toml", "--out", "a"]).code, 0);
    assert_eq!(fs::read_to_string(folder.join("victim")).unwrap(), "precious");
    assert!(!folder.join("a/trace.parquet").is_symlink());
    assert!(fs::symlink_metadata(folder.join("a/trace.csv")).is_err(), "of another kind");
    std::os::unix::fs::symlink("victim", folder.join("gains.json.partial")).unwrap();
    assert!(folder.join("a/.phihat.lock").is_file());
    fs::remove_file(folder.join("a/.phihat.lock")).unwrap();
    std::os::unix::fs::symlink("../victim", folder.join("a/.phihat.lock")).unwrap();
    let refused = phihat(&folder, &["run", "b.toml", "--out", "a"]);
    assert_eq!(refused.code, 2);
    assert!(
        refused.err.contains(".phihat.lock: cannot be written: it is not a file"),
        "{}",
        refused.err
    );
}

/// Files that a shell makes are read by all whom the user's mask lets; so are these.
#[cfg(unix)]
#[test]
fn files_have_the_mode_of_any_other_file() {
    use std::os::unix::fs::PermissionsExt;
    let folder = two_records("records-mode");
    fs::write(folder.join("plain"), "").unwrap();
    let mode = |path: &str| fs::metadata(folder.join(path)).unwrap().permissions().mode();
    for name in ["a/trace.parquet", "a/run.json", "a/report.html", "a/figures/error.svg"] {
        assert_eq!(mode(name), mode("plain"), "{name}");
    }
}

/// A study whose robot is a file elsewhere, and the record of it.
fn with_a_robot_file(name: &str) -> PathBuf {
    let folder = folder(name);
    let robots = Path::new(env!("CARGO_MANIFEST_DIR")).join("../phihat-model/robots");
    fs::create_dir_all(folder.join("arms/below")).unwrap();
    let toml = fs::read_to_string(robots.join("planar3r.toml")).unwrap();
    let toml = toml.replace("\"planar3r.urdf\"", "\"below/planar3r.urdf\"");
    fs::write(folder.join("arms/planar3r.toml"), toml).unwrap();
    fs::copy(robots.join("planar3r.urdf"), folder.join("arms/below/planar3r.urdf")).unwrap();
    let study = small("elsewhere", 0.3, 5.0)
        .replace("name = \"planar3r\"", "file = \"../arms/planar3r.toml\"");
    fs::write(folder.join("studies/elsewhere.toml"), study).unwrap();
    let run = phihat(&folder, &["run", "studies/elsewhere.toml", "--out", "out"]);
    assert_eq!(run.code, 0, "{}", run.err);
    folder
}

#[test]
fn a_record_holds_what_its_study_names_and_can_be_moved() {
    let folder = with_a_robot_file("records-inputs");
    let page = fs::read(folder.join("out/report.html")).unwrap();
    fs::remove_dir_all(folder.join("arms")).unwrap();
    fs::rename(folder.join("out"), folder.join("moved")).unwrap();
    let again = phihat(&folder, &["report", "moved/trace.parquet"]);
    assert_eq!(again.code, 0, "{}", again.err);
    assert!(fs::read(folder.join("moved/report.html")).unwrap() == page, "another page");
    let urdf = folder.join("moved/inputs/below/planar3r.urdf");
    let text = fs::read_to_string(&urdf).unwrap();
    fs::write(&urdf, text.replacen("mass value=\"", "mass value=\"1", 1)).unwrap();
    let told = refusal(&folder, "moved/trace.parquet");
    assert!(
        told.contains("inputs/below/planar3r.urdf: is not the file that the run left"),
        "{told}"
    );
}

#[test]
fn inputs_of_an_older_run_do_not_stay_in_the_record() {
    let folder = with_a_robot_file("records-older-inputs");
    fs::write(folder.join("plain.toml"), small("plain", 0.3, 5.0)).unwrap();
    assert_eq!(phihat(&folder, &["run", "plain.toml", "--out", "out"]).code, 0);
    let left = files_of(&folder.join("out"));
    assert!(!left.keys().any(|name| name.starts_with("inputs")), "{:?}", left.keys());
}

#[test]
fn a_record_may_name_no_file_outside_of_it() {
    let folder = two_records("records-outside");
    let run = fs::read_to_string(folder.join("a/run.json")).unwrap();
    let sum = sha256(&mut fs::read(folder.join("b.toml")).unwrap().as_slice()).unwrap();
    let run = run.replacen("\"files\": {", &format!("\"files\": {{ \"../b.toml\": \"{sum}\","), 1);
    fs::write(folder.join("a/run.json"), run).unwrap();
    let told = refusal(&folder, "a/trace.parquet");
    assert!(told.contains("names \"../b.toml\", which is no file of a record"), "{told}");
}

#[test]
fn verify_takes_a_record_and_refuses_what_does_not_follow_from_its_trace() {
    let folder = two_records("records-verified");
    let good = phihat(&folder, &["verify", "--run", "a"]);
    assert_eq!(good.code, 0, "{}", good.err);
    assert!(good.out.contains("its figures follow from its trace"), "{}", good.out);
    // A forger who makes the hashes fit.
    let path = folder.join("a/metrics.json");
    let own = fs::read_to_string(&path).unwrap();
    let place = own.find("\"error_peak_rad\": ").unwrap() + "\"error_peak_rad\": ".len();
    let forged =
        format!("{}1e-9{}", &own[..place], &own[own[place..].find(',').unwrap() + place..]);
    let sum = |text: &str| sha256(&mut text.as_bytes()).unwrap();
    let run = fs::read_to_string(folder.join("a/run.json")).unwrap();
    fs::write(folder.join("a/run.json"), run.replace(&sum(&own), &sum(&forged))).unwrap();
    fs::write(&path, forged).unwrap();
    let bad = phihat(&folder, &["verify", "--run", "a"]);
    assert_eq!(bad.code, 2, "{}", bad.out);
    assert!(
        bad.err.contains("a/metrics.json: does not say what follows from the trace"),
        "{}",
        bad.err
    );
    let missing = phihat(&folder, &["verify", "--run", "nowhere"]);
    assert_eq!(missing.code, 2);
    assert!(missing.err.contains("run.json: is missing"), "{}", missing.err);
    assert_eq!(phihat(&folder, &["verify"]).code, 2, "gains or a record");
}
