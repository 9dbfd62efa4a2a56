//! Measured results, as Markdown.

use core::fmt::Write as _;

use serde::Serialize;

use crate::work::{Run, Try, largest};

/// The least error that each kind of law reaches on an arm.
#[derive(Debug, Serialize)]
pub(crate) struct ArmRow {
    pub(crate) arm: String,
    /// Largest change of torque per sample that is allowed \[N·m\].
    pub(crate) step_allowed: f64,
    /// From positions, the same filtered, with a velocity.
    pub(crate) kinds: Vec<Least>,
}

/// The least certified error of a kind of law.
#[derive(Debug, Serialize)]
pub(crate) struct Least {
    pub(crate) kind: String,
    /// Per joint \[rad\]; `None`: nothing with a tube inside the steps.
    pub(crate) errors: Option<Vec<f64>>,
    /// Certified change of torque per sample, of the worst joint \[N·m\].
    pub(crate) step: Option<f64>,
    /// Every design.
    pub(crate) tried: Vec<Try>,
    /// Measured in the study's own world.
    pub(crate) run: Option<Run>,
}

impl Least {
    fn worst(&self) -> Option<f64> {
        self.errors.as_deref().map(largest)
    }
}

/// A world, and what the laws do there, kind by kind.
#[derive(Debug, Serialize)]
pub(crate) struct WorldRow {
    pub(crate) world: String,
    /// `None`: there are no gains.
    pub(crate) runs: Vec<Option<Run>>,
}

/// Design of the gains for the worlds: request and result.
#[derive(Debug, Serialize)]
pub(crate) struct Designed {
    pub(crate) kind: String,
    pub(crate) bits: u32,
    /// \[rad\]
    pub(crate) asked: f64,
    pub(crate) proved: bool,
    /// Certified errors \[rad\] per joint.
    pub(crate) errors: Option<Vec<f64>>,
    /// Clauses that are not proved.
    pub(crate) unproved: Vec<String>,
}

/// A number of milliradians, or a dash.
fn mrad(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{:.3}", 1e3 * value))
}

/// New over old.
fn ratio(new: Option<f64>, old: Option<f64>) -> String {
    match (new, old) {
        (Some(new), Some(old)) if old > 0.0 => format!("{:.2}", new / old),
        _ => "–".to_owned(),
    }
}

/// Results of each kind, in one cell or more.
fn cells<T>(all: &[T], shown: impl Fn(&T) -> String, between: &str) -> String {
    all.iter().map(shown).collect::<Vec<_>>().join(between)
}

fn dash() -> String {
    "–".to_owned()
}

/// The table of arms.
pub(crate) fn arms(rows: &[ArmRow]) -> String {
    let mut text = "| arm | step allowed [N·m] | positions: certified [mrad] | filtered | observer | positions / \
                    observer | filtered / positions | certified steps [N·m] | measured [mrad] \
                    |\n|---|---|---|---|---|---|---|---|---|\n"
        .to_owned();
    for row in rows {
        let [new, filtered, old] = row.kinds.as_slice() else { continue };
        let step = |kind: &Least| kind.step.map_or_else(dash, |s| format!("{s:.2}"));
        let run = |kind: &Least| mrad(kind.run.as_ref().map(|run| largest(&run.errors)));
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} |",
            row.arm,
            row.step_allowed,
            cells(&row.kinds, |kind| mrad(kind.worst()), " | "),
            ratio(new.worst(), old.worst()),
            ratio(filtered.worst(), new.worst()),
            cells(&row.kinds, step, ", "),
            cells(&row.kinds, run, ", ")
        );
    }
    text += "\nEvery design, certified error of the worst joint [mrad] at its certified step [N·m]:\n\n";
    for row in rows {
        for kind in &row.kinds {
            let one = |one: &Try| match one.step {
                Some(step) => format!("{} at {step:.2}", mrad(one.error)),
                None => "none".to_owned(),
            };
            let _ =
                writeln!(text, "- {}, {}: {}.", row.arm, kind.kind, cells(&kind.tried, one, "; "));
        }
    }
    text
}

/// The table of worlds, and below it every joint.
pub(crate) fn worlds(rows: &[WorldRow]) -> String {
    let mut text = "| world | positions [mrad] | filtered | observer | positions / observer | filtered / positions | \
                    samples limited | largest Δτ [N·m] |\n|---|---|---|---|---|---|---|---|\n"
        .to_owned();
    for row in rows {
        let [new, filtered, old] = row.runs.as_slice() else { continue };
        let worst = |run: &Option<Run>| {
            let ended = run.as_ref().filter(|run| run.diverged.is_none());
            ended.map(|run| largest(&run.errors))
        };
        let shown = |run: &Option<Run>| match run.as_ref().and_then(|run| run.diverged) {
            Some(t) => format!("diverged at {t:.2} s"),
            None => mrad(worst(run)),
        };
        let limited =
            |run: &Option<Run>| run.as_ref().map_or_else(dash, |run| run.limited.to_string());
        let step =
            |run: &Option<Run>| run.as_ref().map_or_else(dash, |run| format!("{:.2}", run.step));
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} |",
            row.world,
            cells(&row.runs, shown, " | "),
            ratio(worst(new), worst(old)),
            ratio(worst(filtered), worst(new)),
            cells(&row.runs, limited, ", "),
            cells(&row.runs, step, ", ")
        );
    }
    text += "\nEvery joint, positions / filtered / observer [mrad]:\n\n";
    let joints =
        rows.iter().flat_map(|row| row.runs.iter().flatten()).map(|run| run.errors.len()).max();
    let numbers = 1..=joints.unwrap_or(0);
    let head: Vec<String> = numbers.clone().map(|joint| format!("joint {joint}")).collect();
    let rule: Vec<&str> = numbers.map(|_| "---").collect();
    let _ = writeln!(text, "| world | {} |\n|---|{}|", head.join(" | "), rule.join("|"));
    for row in rows {
        let of = |run: &Option<Run>, joint: usize| mrad(run.as_ref().map(|run| run.errors[joint]));
        let each = |joint: usize| cells(&row.runs, |run| of(run, joint), " / ");
        let each: Vec<String> = (0..joints.unwrap_or(0)).map(each).collect();
        let _ = writeln!(text, "| {} | {} |", row.world, each.join(" | "));
    }
    text
}

/// List of the designs for the worlds.
pub(crate) fn designs(rows: &[Designed]) -> String {
    let mut text = String::new();
    for row in rows {
        let _ = writeln!(
            text,
            "- {}, {} bits: designed for {} mrad, certified {} mrad{}.",
            row.kind,
            row.bits,
            mrad(Some(row.asked)),
            mrad(row.errors.as_deref().map(largest)),
            if row.proved {
                String::new()
            } else {
                format!(", not proved: {}", row.unproved.join("; "))
            }
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kind_without_a_tube_is_a_dash_and_has_no_ratio() {
        let least = |errors: Option<Vec<f64>>| Least {
            kind: String::new(),
            step: errors.as_ref().map(|_| 0.5),
            errors,
            tried: vec![
                Try { asked: 1e-3, error: Some(7e-4), step: Some(1.2) },
                Try { asked: 1e-3, error: None, step: None },
            ],
            run: None,
        };
        let row = |kinds: [Option<Vec<f64>>; 3]| ArmRow {
            arm: "a".to_owned(),
            step_allowed: 1.0,
            kinds: kinds.map(least).into(),
        };
        let text = arms(&[
            row([Some(vec![1e-4, 3e-4]), Some(vec![2.1e-4]), Some(vec![6e-4])]),
            row([None, Some(vec![5e-4]), Some(vec![1e-3])]),
        ]);
        let lines: Vec<&str> = text.lines().skip(2).collect();
        assert_eq!(
            lines[0],
            "| a | 1 | 0.300 | 0.210 | 0.600 | 0.50 | 0.70 | 0.50, 0.50, 0.50 | –, –, – |"
        );
        assert_eq!(lines[1], "| a | 1 | – | 0.500 | 1.000 | – | – | –, 0.50, 0.50 | –, –, – |");
        assert!(text.ends_with("- a, : 0.700 at 1.20; none.\n"), "{text}");
    }
}
