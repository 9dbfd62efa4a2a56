//! Times of steps and tests, compared with the file of times in the repository.
//!
//! Machines differ: each processor time is divided by the stored one, and the median of these ratios is that
//! of the machine. A step or a test whose ratio exceeds the median by [`SLOWER`] is named.

use std::collections::BTreeMap;
use std::fmt::{self, Write as _};
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use crate::shell::{gate_folder, read, write};

/// Ratio to the stored processor time above which a step or a test is named.
const SLOWER: f64 = 1.5;
/// Processor time below which a step or a test is not compared \[s\].
const LEAST_S: f64 = 1.0;
/// Tests that the table shows.
const SLOWEST: usize = 10;

/// The file of times that the repository keeps.
const KEPT: &str = "xtask/times.json";

/// Wall time and processor time \[s\].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cost {
    pub(super) wall: f64,
    pub(super) processor: f64,
}

impl fmt::Display for Cost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.0} s of wall time, {:.0} s of processor time", self.wall, self.processor)
    }
}

/// Processor time \[s\] of every process that this one has waited for, and of those that they have waited for.
pub(super) fn processor_of_children() -> f64 {
    #[cfg(unix)]
    {
        use nix::sys::resource::{UsageWho, getrusage};
        use nix::sys::time::TimeValLike as _;
        getrusage(UsageWho::RUSAGE_CHILDREN).map_or(0.0, |usage| {
            let all = usage.user_time() + usage.system_time();
            all.num_microseconds() as f64 * 1e-6
        })
    }
    #[cfg(not(unix))]
    0.0
}

/// The file to which each test adds a line.
pub(super) fn tests_file(root: &Path) -> Result<PathBuf, String> {
    Ok(gate_folder(root)?.join("tests.txt"))
}

/// Leaves what a step cost, for [`left`].
pub(super) fn leave(root: &Path, name: &str, wall: f64) -> Result<(), String> {
    let text = json!({ "wall_s": wall, "processor_s": processor_of_children() }).to_string();
    write(&gate_folder(root)?.join(format!("{name}.json")), &text)
}

/// Times of a step; the file is removed, so that it is not taken for one of another run.
pub(super) fn left(root: &Path, name: &str) -> Result<Cost, String> {
    let path = gate_folder(root)?.join(format!("{name}.json"));
    let text = read(&path)?;
    std::fs::remove_file(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    let value: Value =
        serde_json::from_str(&text).map_err(|e| format!("{}: {e}", path.display()))?;
    let number = |key: &str| value[key].as_f64().unwrap_or_default();
    Ok(Cost { wall: number("wall_s"), processor: number("processor_s") })
}

/// The figures of one run.
#[derive(Debug, Default)]
pub(super) struct GateTimes {
    steps: Vec<(String, Cost)>,
    /// Processor time of each test \[s\].
    tests: BTreeMap<String, f64>,
}

impl GateTimes {
    /// Those of steps that have ended, in their order, and of the tests if they are among them.
    pub(super) fn of(
        root: &Path,
        steps: Vec<(String, Cost)>,
        with_tests: bool,
    ) -> Result<Self, String> {
        let text =
            if with_tests { read(&tests_file(root)?).unwrap_or_default() } else { String::new() };
        Ok(Self { steps, tests: tests(&text) })
    }

    /// The table of steps, the slowest tests, and what became slower.
    pub(super) fn table(&self, root: &Path, wall: f64) -> Result<String, String> {
        let kept: Value = match std::fs::read_to_string(root.join(KEPT)) {
            Ok(text) => serde_json::from_str(&text).map_err(|e| format!("{KEPT}: {e}"))?,
            Err(_) => Value::Null,
        };
        let mut text =
            format!("\n{:<44}{:>9}{:>14}{:>9}\n", "step", "wall s", "processor s", "kept s");
        for (name, cost) in &self.steps {
            let before =
                kept["steps"][name].as_f64().map_or_else(String::new, |s| format!("{s:.0}"));
            let _ =
                writeln!(text, "{name:<44}{:>9.0}{:>14.0}{before:>9}", cost.wall, cost.processor);
        }
        let processor: f64 = self.steps.iter().map(|(_, cost)| cost.processor).sum();
        let _ = writeln!(text, "{:<44}{wall:>9.0}{processor:>14.0}", "all");
        let mut slow: Vec<_> = self.tests.iter().collect();
        slow.sort_by(|a, b| b.1.total_cmp(a.1));
        if !slow.is_empty() {
            let _ = writeln!(text, "\n{:<67}{:>9}", "slowest tests", "proc. s");
        }
        for (name, processor) in slow.into_iter().take(SLOWEST) {
            let _ = writeln!(text, "{name:<67}{processor:>9.1}");
        }
        for line in self.slower(&kept) {
            let _ = writeln!(text, "SLOWER: {line}");
        }
        text.push('\n');
        Ok(text)
    }

    /// Processor times of this run, by the kind and name of what they are of.
    fn figures(&self) -> impl Iterator<Item = (&'static str, &str, f64)> {
        let steps = self.steps.iter().map(|(name, cost)| ("steps", name.as_str(), cost.processor));
        steps.chain(self.tests.iter().map(|(name, processor)| ("tests", name.as_str(), *processor)))
    }

    /// One line for each step and test that is [`SLOWER`] than the kept figure, on a machine as fast as this one.
    fn slower(&self, kept: &Value) -> Vec<String> {
        let pairs: Vec<_> = self
            .figures()
            .filter_map(|(kind, name, now)| Some((kind, name, now, kept[kind][name].as_f64()?)))
            .filter(|(.., now, before)| now.max(*before) >= LEAST_S && *before > 0.0)
            .collect();
        let mut ratios: Vec<f64> = pairs.iter().map(|(.., now, before)| now / before).collect();
        ratios.sort_by(f64::total_cmp);
        let Some(machine) = ratios.get(ratios.len().saturating_sub(1) / 2).copied() else {
            return Vec::new();
        };
        let slow = pairs.into_iter().filter(|(.., now, before)| now / before > SLOWER * machine);
        slow.map(|(kind, name, now, before)| {
            let kind = kind.trim_end_matches('s');
            format!(
                "{kind} {name}: {now:.1} s of processor time, {:.1} s are expected here",
                before * machine
            )
        })
        .collect()
    }

    /// Leaves the figures in the folder of the gate.
    pub(super) fn write(&self, root: &Path) -> Result<(), String> {
        let steps: BTreeMap<_, _> = self
            .steps
            .iter()
            .map(|(name, cost)| {
                (name, json!({ "wall_s": cost.wall, "processor_s": cost.processor }))
            })
            .collect();
        let document = json!({ "steps": steps, "tests_processor_s": self.tests });
        write(&gate_folder(root)?.join("times.json"), &format!("{document:#}\n"))
    }

    /// Makes the figures those that later runs are compared with.
    pub(super) fn keep(&self, root: &Path) -> Result<(), String> {
        let mut kept: BTreeMap<&str, BTreeMap<&str, f64>> = BTreeMap::new();
        for (kind, name, processor) in self.figures() {
            if processor >= LEAST_S || kind == "steps" {
                kept.entry(kind).or_default().insert(name, (processor * 10.0).round() / 10.0);
            }
        }
        write(&root.join(KEPT), &format!("{:#}\n", json!(kept)))
    }
}

/// The processor time of each test, from the lines that `xtask measured` leaves.
fn tests(text: &str) -> BTreeMap<String, f64> {
    let one = |line: &str| {
        let (seconds, name) = line.split_once(' ')?;
        Some((name.to_owned(), seconds.parse().ok()?))
    };
    text.lines().filter_map(one).collect()
}

#[cfg(test)]
mod unit {
    use super::{Cost, GateTimes, json, tests};

    fn times(steps: &[(&str, f64)]) -> GateTimes {
        let cost = |processor| Cost { wall: 1.0, processor };
        let steps = steps.iter().map(|(name, s)| ((*name).to_owned(), cost(*s))).collect();
        GateTimes {
            steps,
            tests: tests("12.5 phihat::tests laws::one\nnonsense\n3.0 phihat laws::two\n"),
        }
    }

    #[test]
    fn lines_of_tests_are_read_and_others_are_not() {
        let all = tests("12.5 phihat::tests laws::one\n\nnot a number\n");
        assert_eq!(
            all.into_iter().collect::<Vec<_>>(),
            [("phihat::tests laws::one".to_owned(), 12.5)]
        );
    }

    #[test]
    fn what_is_slower_than_on_this_machine_is_named_and_a_slow_machine_is_not() {
        let kept = json!({ "steps": { "a": 10.0, "b": 10.0, "c": 10.0, "d": 0.01 },
                           "tests": { "phihat::tests laws::one": 2.0 } });
        let named = times(&[("a", 30.0), ("b", 30.0), ("c", 30.0), ("d", 0.5)]).slower(&kept);
        assert_eq!(named.len(), 1, "{named:?}");
        assert!(named[0].starts_with("test phihat::tests laws::one: 12.5 s"), "{named:?}");
        let named = times(&[("a", 10.0), ("b", 16.0), ("c", 10.0)]).slower(&kept);
        assert!(named.iter().any(|line| line.starts_with("step b: 16.0 s")), "{named:?}");
        assert_eq!(times(&[("new", 99.0)]).slower(&json!(null)), [""; 0]);
    }
}
