//! Every operation on the disk fails once, the disk fills up, the process is killed: the older results are
//! there, or the new ones, or none, never a mixture; and the same command again leaves the same bytes as if
//! nothing had been.
#![cfg(debug_assertions)]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::support::{Answer, Files, Running, answer, files_of, folder, leave, phihat, small};

const LOCK: &str = ".phihat.lock";

/// A command that replaces older results.
struct Case<'a> {
    folder: PathBuf,
    command: &'a [&'a str],
    /// Path of its results.
    out: &'a str,
    /// The file without which there are no results; none where one file is all.
    sign: Option<&'a str>,
    /// All files before.
    before: Files,
    /// Returns true if a file is one of the results, and not an intermediate one.
    result: fn(&str) -> bool,
}

/// Some results: their names and bytes.
type Results = BTreeMap<String, Vec<u8>>;

impl Case<'_> {
    fn out(&self) -> PathBuf {
        self.folder.join(self.out)
    }

    fn results(&self) -> Results {
        let text = |path: PathBuf| path.to_str().unwrap().to_owned();
        let all = files_of(&self.out()).into_iter().map(|(path, bytes)| (text(path), bytes));
        all.filter(|(name, _)| (self.result)(name) && !is_partial(name) && name != LOCK).collect()
    }

    fn struck(&self, how: &str) -> Answer {
        let mut command = Command::new(env!("CARGO_BIN_EXE_phihat"));
        command.args(self.command).current_dir(&self.folder).env("PHIHAT_STRIKE", how);
        answer(&mut command)
    }

    /// Strikes the first operation, the second, and so on until there is none left; returns their number.
    /// With `PHIHAT_ALL=1` each of them, otherwise the first three and one in eight.
    fn strike_all(&self, how: &str) -> usize {
        leave(&self.out(), &self.before);
        let old = self.results();
        let clean = phihat(&self.folder, self.command);
        assert!(clean.code < 2, "{}", clean.err);
        let new = self.results();
        assert_ne!(old, new);
        let every = std::env::var_os("PHIHAT_ALL").is_some();
        for number in (1..).filter(|number| every || *number < 4 || number % 8 == 0) {
            leave(&self.out(), &self.before);
            let answer = self.struck(&format!("{how} {number}"));
            let now = self.results();
            let told =
                format!("{how} {number}: code {}: {}{}", answer.code, answer.out, answer.err);
            if !answer.err.contains("struck: ") {
                assert_eq!(answer.code, clean.code, "{told}");
                assert!(now == new, "{told}");
                return number - 1;
            }
            self.judge(&answer, [&old, &new, &now], &told);
            // Where everything is as it was, it was run from there already; half-written files beside it are all alike.
            let mut left = files_of(&self.out());
            let half_written =
                left.extract_if(.., |path, _| is_partial(path.to_str().unwrap())).count();
            if left != self.before || half_written > 0 && number % 8 == 1 {
                let again = phihat(&self.folder, self.command);
                assert_eq!(again.code, clean.code, "{told}\nagain: {}", again.err);
                assert!(self.results() == new, "{told}\nother bytes when it is run again");
                let left = files_of(&self.out()).into_keys();
                let left: Vec<_> = left.filter(|path| is_partial(path.to_str().unwrap())).collect();
                assert!(left.is_empty(), "{told}\n{left:?}");
            }
        }
        unreachable!("there is a last operation")
    }

    /// Checks that the results are whole, or absent, and as the message says.
    fn judge(&self, answer: &Answer, [old, new, now]: [&Results; 3], told: &str) {
        let (is_old, is_new) = (now == old, now == new);
        let unsigned = self.sign.is_some_and(|sign| !now.contains_key(sign));
        assert!(is_old || is_new || unsigned, "a mixture: {told}\n{:?}", now.keys());
        // An older page stands beside older files only.
        let page = "report.html";
        if now.contains_key(page)
            && now.get(page) == old.get(page)
            && now.get(page) != new.get(page)
        {
            let other = |(name, bytes): &(&String, &Vec<u8>)| old.get(*name) != Some(*bytes);
            assert!(!now.iter().any(|file| other(&file)), "beside an older page: {told}");
        }
        if answer.code == 137 {
            return;
        }
        if answer.err.contains("nothing that was there has changed") {
            assert!(is_old, "{told}");
        } else if answer.err.contains("did not confirm it") {
            // Of the gains that are kept on the way, too.
            assert!(is_new || is_old && answer.err.contains("error: out/gains: "), "{told}");
        } else if let Some((_, lists)) = answer.err.split_once("taken away; new: ") {
            assert!(unsigned, "{told}");
            let (there, missing) = lists.split_once("; not written: ").unwrap();
            let list = |text: &str| -> Vec<String> {
                let names = text.split(';').next().unwrap().split(", ");
                names
                    .filter(|name| *name != "none")
                    .map(|n| n.split(" and ").next().unwrap().into())
                    .collect()
            };
            let named = |name: &str| now.keys().find(|path| path.ends_with(name)).cloned();
            for name in list(there) {
                let path = named(&name).unwrap_or_else(|| panic!("{name}: {told}"));
                assert_eq!(now[&path], new[&path], "{name}: {told}");
            }
            assert!(
                list(missing).contains(&self.sign.unwrap().to_owned()) || missing.contains(" more"),
                "{told}"
            );
        } else if answer.code < 2 {
            assert!(is_new, "{told}");
        } else {
            // A journal, a lock: nothing was begun.
            assert!(is_old, "{told}");
        }
    }
}

fn is_partial(name: &str) -> bool {
    name.ends_with(".partial")
}

/// A run over the record of another study, which had another page and a trace of the other kind.
fn run_over_an_older(name: &str) -> Case<'static> {
    let folder = folder(name);
    fs::write(folder.join("old.toml"), small("old", 0.3, 5.0)).unwrap();
    fs::write(folder.join("new.toml"), small("new", 0.2, 4.0)).unwrap();
    let old = phihat(&folder, &["run", "old.toml", "--out", "out", "--csv"]);
    assert_eq!(old.code, 0, "{}", old.err);
    fs::write(folder.join("out/figures/bode.svg"), "of an older certificate").unwrap();
    let before = files_of(&folder.join("out"));
    let command = &["run", "new.toml", "--out", "out"];
    Case { folder, command, out: "out", sign: Some("run.json"), before, result: |_| true }
}

#[test]
fn a_run_leaves_the_older_record_or_the_new_one_or_none() {
    let case = run_over_an_older("struck-run");
    let counts = ["fail", "full", "kill"].map(|how| case.strike_all(how));
    println!("run: {counts:?} operations struck");
    assert!(counts[0] > 50 && counts[2] == counts[0], "{counts:?}");
    assert!(!case.out().join("figures/bode.svg").exists());
}

#[test]
fn a_design_leaves_the_older_gains_or_the_new_ones() {
    let folder = folder("struck-design");
    let design =
        small("new", 0.2, 4.0).replace("0.05", "1.0").replace("settle_s = 0.01", "settle_s = 0.5");
    let (head, rest) = design.split_once("[gains]").unwrap();
    let (_, rest) = rest.split_once("[reference]").unwrap();
    let design = format!("{head}[design]\n[sensor]\nencoder_bits = 18\n[reference]{rest}");
    fs::write(folder.join("new.toml"), design).unwrap();
    fs::write(folder.join("old.toml"), small("old", 0.3, 5.0)).unwrap();
    assert_eq!(phihat(&folder, &["run", "old.toml", "--out", "out"]).code, 0);
    let before = files_of(&folder.join("out"));
    let command = &["design", "new.toml", "--out", "out/gains.json"];
    let result = |name: &str| name == "gains.json";
    let case = Case { folder, command, out: "out", sign: None, before, result };
    let counts = ["fail", "kill"].map(|how| case.strike_all(how));
    println!("design: {counts:?} operations struck");
    assert!(counts[0] >= 6 && counts[1] == counts[0], "{counts:?}");
    // The gains are not those of the run any more: its record is none.
    let refused = phihat(&case.folder, &["report", "out"]);
    assert_eq!(refused.code, 2);
    assert!(
        refused.err.contains("out/gains.json: is not the file that the run left"),
        "{}",
        refused.err
    );
}

/// A campaign with older results, and a journal that lacks one line.
fn campaign<'a>(name: &str, command: &'a [&'a str], sign: &'a str) -> Case<'a> {
    let folder = folder(name);
    let arm = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../studies/faults/planar3r.toml");
    fs::copy(arm, folder.join("studies/arm.toml")).unwrap();
    let first = phihat(&folder, command);
    assert!(first.code < 2, "{}", first.err);
    let out = folder.join("out");
    for name in [sign, "report.html"] {
        fs::write(out.join(name), "older").unwrap();
    }
    let journal = fs::read_to_string(out.join("journal.jsonl")).unwrap();
    let kept =
        journal.trim_end().rsplit_once('\n').map_or(String::new(), |(kept, _)| format!("{kept}\n"));
    fs::write(out.join("journal.jsonl"), kept).unwrap();
    let before = files_of(&out);
    let result = |name: &str| matches!(name, "faults.json" | "compare.json" | "report.html");
    // Of two files the page is the last.
    Case { folder, command, out: "out", sign: Some("report.html"), before, result }
}

#[test]
fn a_fault_matrix_leaves_its_older_answer_or_the_new_one_or_none() {
    let command = ["faults", "studies/arm.toml", "--quick", "--only", "push/2", "--out", "out"];
    let case = campaign("struck-faults", &command, "faults.json");
    let counts = ["fail", "kill"].map(|how| case.strike_all(how));
    println!("faults: {counts:?} operations struck");
    assert!(counts[0] > 15 && counts[1] == counts[0], "{counts:?}");
}

#[test]
fn a_comparison_leaves_its_older_answer_or_the_new_one_or_none() {
    let command = [
        "compare",
        "studies/table1.toml",
        "--quick",
        "--only",
        "pd",
        "--worlds",
        "exact",
        "--threads",
        "1",
        "--out",
        "out",
    ];
    let case = campaign("struck-compare", &command, "compare.json");
    let counts = ["fail", "kill"].map(|how| case.strike_all(how));
    println!("compare: {counts:?} operations struck");
    assert!(counts[0] > 12 && counts[1] == counts[0], "{counts:?}");
}

#[test]
fn a_reproduction_leaves_the_older_one_or_the_new_one_or_none() {
    let folder = folder("struck-reproduce");
    let older = ["reproduce", "--quick", "--only", "figures 12 and 13", "--out", "out"];
    assert_eq!(phihat(&folder, &older).code, 0);
    let before = files_of(&folder.join("out"));
    assert!(before.contains_key(Path::new("figures/fig-12.svg")));
    let command = &["reproduce", "--only", "table 2", "--out", "out"];
    let case =
        Case { folder, command, out: "out", sign: Some("report.html"), before, result: |_| true };
    let count = case.strike_all("fail");
    println!("reproduce: {count} operations struck");
    assert!(count > 50, "{count}");
    assert!(!case.out().join("figures/fig-12.svg").exists(), "a figure of the older reproduction");
}

/// The system's kill, at operations on the disk that are spread over the run, half-done where they are
/// writes, and wherever the process is once it has gone on from one; `PHIHAT_KILLS` says how many.
#[cfg(unix)]
#[test]
fn a_killed_run_leaves_the_older_record_or_the_new_one_or_none() {
    let case = run_over_an_older("struck-kills");
    let kills: usize = std::env::var("PHIHAT_KILLS").map_or(20, |n| n.parse().unwrap());
    let old = case.results();
    assert_eq!(phihat(&case.folder, case.command).code, 0);
    let new = case.results();
    let (mut count, mut killed) = ([0; 3], 0);
    let (mut number, mut first) = (1, 1);
    for kill in 0..kills {
        leave(&case.out(), &case.before);
        let pauses = kill % 2 == 0;
        let strike = format!("{} {number}", if pauses { "pause" } else { "pass" });
        let mut running = Running::of(&case.folder, case.command, Some(&strike));
        if running.is_struck() {
            number += STRIDE;
        } else {
            // There are no operations left: others than before, from the start again.
            first = first % STRIDE + 1;
            number = first;
        }
        let was_killed = running.kill();
        killed += usize::from(was_killed);
        let now = case.results();
        let state = [now == old, now == new, !now.contains_key("run.json")];
        let Some(state) = state.iter().position(|is| *is) else {
            panic!("kill {kill}, {strike}: a mixture: {:?}", now.keys());
        };
        if was_killed && pauses {
            count[state] += 1;
        }
        if state == 2 || kill % 10 == 0 {
            let code = phihat(&case.folder, &["report", "out"]).code;
            assert_eq!(code == 0, state < 2, "kill {kill}, {strike}");
        }
    }
    println!("{killed} of {kills} killed; at an operation: older, new, none: {count:?}");
    assert_eq!(phihat(&case.folder, case.command).code, 0);
    assert!(case.results() == new);
    assert!(files_of(&case.out()).into_keys().all(|path| !is_partial(path.to_str().unwrap())));
    assert!(count[0] > 0 && count[2] > 0, "all at one stage: {count:?}");
}

/// From one operation that a process is killed at to the next.
const STRIDE: usize = 10;

#[test]
fn of_several_processes_at_once_one_wins_whole_and_the_others_say_why() {
    let folder = folder("struck-at-once");
    let names = ["a", "b", "c"];
    let mut whole = BTreeMap::new();
    for (name, amplitude) in names.into_iter().zip([0.1, 0.2, 0.3]) {
        let file = format!("{name}.toml");
        fs::write(folder.join(&file), small(name, amplitude, 4.0).replace("0.05", "0.5")).unwrap();
        assert_eq!(phihat(&folder, &["run", &file, "--out", "out"]).code, 0);
        whole.insert(name, files_of(&folder.join("out")));
    }
    for round in 0..6 {
        let children = names.map(|name| {
            let child = Command::new(env!("CARGO_BIN_EXE_phihat"))
                .args(["run", &format!("{name}.toml"), "--out", "out"])
                .current_dir(&folder)
                .stdout(Stdio::null())
                .stderr(Stdio::piped())
                .spawn();
            (name, child.unwrap())
        });
        let mut done = Vec::new();
        for (name, child) in children {
            let output = child.wait_with_output().unwrap();
            let err = String::from_utf8(output.stderr).unwrap();
            match output.status.code() {
                Some(0) => done.push(name),
                Some(2) => {
                    assert!(err.contains("another phihat is at work in this folder"), "{err}");
                }
                code => panic!("{code:?}: {err}"),
            }
        }
        let now = files_of(&folder.join("out"));
        assert!(done.iter().any(|name| whole[name] == now), "round {round}: {done:?}");
    }
}
