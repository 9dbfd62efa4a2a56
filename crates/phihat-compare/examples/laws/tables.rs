//! What was measured, as Markdown.

use core::fmt::Write as _;

use serde::Serialize;

use crate::work::{Run, Try, largest};

/// The least error that each form reaches on an arm.
#[derive(Debug, Serialize)]
pub(crate) struct ArmRow {
    pub(crate) arm: String,
    /// Largest change of torque per sample that is allowed \[N·m\].
    pub(crate) step_allowed: f64,
    /// Positions, then observer.
    pub(crate) forms: Vec<Least>,
}

/// The least certified error of a form.
#[derive(Debug, Serialize)]
pub(crate) struct Least {
    pub(crate) form: String,
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

/// A world, and what the laws do there: positions, then observer.
#[derive(Debug, Serialize)]
pub(crate) struct WorldRow {
    pub(crate) world: String,
    /// `None`: there are no gains.
    pub(crate) runs: Vec<Option<Run>>,
}

/// What a gains document of the worlds was designed for.
#[derive(Debug, Serialize)]
pub(crate) struct Designed {
    pub(crate) form: String,
    pub(crate) bits: u32,
    /// \[rad\]
    pub(crate) asked: f64,
    pub(crate) proved: bool,
    /// Certified errors \[rad\] per joint.
    pub(crate) errors: Option<Vec<f64>>,
    /// What is not proved.
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

/// The table of arms.
pub(crate) fn arms(rows: &[ArmRow]) -> String {
    let mut text = "| arm | step allowed [N·m] | positions: certified [mrad] | observer | ratio | certified steps [N·m] | \
                    measured [mrad] |\n|---|---|---|---|---|---|---|\n"
        .to_owned();
    for row in rows {
        let [new, old] = row.forms.as_slice() else { continue };
        let step = |form: &Least| form.step.map_or_else(|| "–".to_owned(), |s| format!("{s:.2}"));
        let run = |form: &Least| mrad(form.run.as_ref().map(|run| largest(&run.errors)));
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {}, {} | {}, {} |",
            row.arm,
            row.step_allowed,
            mrad(new.worst()),
            mrad(old.worst()),
            ratio(new.worst(), old.worst()),
            step(new),
            step(old),
            run(new),
            run(old)
        );
    }
    text += "\nEvery design, certified error of the worst joint [mrad] at its certified step [N·m]:\n\n";
    for row in rows {
        for form in &row.forms {
            let one = |one: &Try| match one.step {
                Some(step) => format!("{} at {step:.2}", mrad(one.error)),
                None => "none".to_owned(),
            };
            let all: Vec<String> = form.tried.iter().map(one).collect();
            let _ = writeln!(text, "- {}, {}: {}.", row.arm, form.form, all.join("; "));
        }
    }
    text
}

/// The table of worlds, and below it every joint.
pub(crate) fn worlds(rows: &[WorldRow]) -> String {
    let mut text =
        "| world | positions [mrad] | observer | ratio | samples limited | largest Δτ [N·m] |\n\
                    |---|---|---|---|---|---|\n"
            .to_owned();
    for row in rows {
        let [new, old] = row.runs.as_slice() else { continue };
        let worst = |run: &Option<Run>| {
            let ended = run.as_ref().filter(|run| run.diverged.is_none());
            ended.map(|run| largest(&run.errors))
        };
        let shown = |run: &Option<Run>| match run.as_ref().and_then(|run| run.diverged) {
            Some(t) => format!("diverged at {t:.2} s"),
            None => mrad(worst(run)),
        };
        let dash = || "–".to_owned();
        let limited =
            |run: &Option<Run>| run.as_ref().map_or_else(dash, |run| run.limited.to_string());
        let step =
            |run: &Option<Run>| run.as_ref().map_or_else(dash, |run| format!("{:.2}", run.step));
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {}, {} | {}, {} |",
            row.world,
            shown(new),
            shown(old),
            ratio(worst(new), worst(old)),
            limited(new),
            limited(old),
            step(new),
            step(old)
        );
    }
    text += "\nEvery joint, positions / observer [mrad]:\n\n";
    let joints =
        rows.iter().flat_map(|row| row.runs.iter().flatten()).map(|run| run.errors.len()).max();
    let numbers = 1..=joints.unwrap_or(0);
    let head: Vec<String> = numbers.clone().map(|joint| format!("joint {joint}")).collect();
    let rule: Vec<&str> = numbers.map(|_| "---").collect();
    let _ = writeln!(text, "| world | {} |\n|---|{}|", head.join(" | "), rule.join("|"));
    for row in rows {
        let [new, old] = row.runs.as_slice() else { continue };
        let of = |run: &Option<Run>, joint: usize| mrad(run.as_ref().map(|run| run.errors[joint]));
        let pair = |joint: usize| format!("{} / {}", of(new, joint), of(old, joint));
        let pairs: Vec<String> = (0..joints.unwrap_or(0)).map(pair).collect();
        let _ = writeln!(text, "| {} | {} |", row.world, pairs.join(" | "));
    }
    text
}

/// What the gains of the worlds were designed for.
pub(crate) fn designs(rows: &[Designed]) -> String {
    let mut text = String::new();
    for row in rows {
        let _ = writeln!(
            text,
            "- {}, {} bits: designed for {} mrad, certified {} mrad{}.",
            row.form,
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
    fn a_form_without_a_tube_is_a_dash_and_has_no_ratio() {
        let least = |errors: Option<Vec<f64>>| Least {
            form: String::new(),
            step: errors.as_ref().map(|_| 0.5),
            errors,
            tried: vec![
                Try { asked: 1e-3, error: Some(7e-4), step: Some(1.2) },
                Try { asked: 1e-3, error: None, step: None },
            ],
            run: None,
        };
        let row = |new, old| ArmRow {
            arm: "a".to_owned(),
            step_allowed: 1.0,
            forms: vec![least(new), least(old)],
        };
        let text =
            arms(&[row(Some(vec![1e-4, 3e-4]), Some(vec![6e-4])), row(None, Some(vec![1e-3]))]);
        let lines: Vec<&str> = text.lines().skip(2).collect();
        assert_eq!(lines[0], "| a | 1 | 0.300 | 0.600 | 0.50 | 0.50, 0.50 | –, – |");
        assert_eq!(lines[1], "| a | 1 | – | 1.000 | – | –, 0.50 | –, – |");
        assert!(text.ends_with("- a, : 0.700 at 1.20; none.\n"), "{text}");
    }
}
