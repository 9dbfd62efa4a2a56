//! "The gains can be reduced during the transient": m = 1 with less `a_0` until the mismatch has settled.

use phihat_study::{LawRequest, Study};

use super::claims::verdict;
use super::order_switch::switched;
use super::run::Run;
use crate::compose::{number, statement, three};
use crate::part::PartError;
use crate::record::{PaperNumber, Statement};

/// `a_0` of the start \[rad/s\].
const REDUCED: [f64; 3] = [40.0, 20.0, 10.0];

/// The steady error may be so many times that of the full gain from the start.
const AS_GOOD: f64 = 1.2;

/// `full` from the start against a start with less, in the printed form; φ̂ is handed over at the change.
pub(crate) fn start(full: &Run) -> Result<Statement, PartError> {
    let mut runs = Vec::new();
    for a0 in REDUCED {
        runs.push((a0, switched(&with(&full.study, a0), &full.study)?));
    }
    let as_good = |run: &Run| run.steady_rms() <= AS_GOOD * full.steady_rms();
    let softer = runs.iter().all(|(_, run)| run.torque_max() < full.torque_max());
    let flatter = runs.iter().all(|(_, run)| run.overshoot(1) < full.overshoot(1));
    let steady = runs.iter().all(|(_, run)| as_good(run));
    let later = runs.iter().all(|(_, run)| match (run.settled_at(), full.settled_at()) {
        (Some(reduced), Some(full)) => reduced > full,
        (reduced, _) => reduced.is_none(),
    });
    let list = |of: &dyn Fn(&Run) -> String| -> String {
        runs.iter().map(|(_, run)| of(run)).collect::<Vec<_>>().join(", ")
    };
    let percent = |run: &Run| format!("{:.0}", run.overshoot(1) * 1e2);
    let torque = |run: &Run| format!("{:.0}", run.torque_max());
    let time = |run: &Run| three(run.settled_at());
    let what = match (flatter, softer) {
        (true, true) => "Less a_0 at the start asks for less torque and overshoots less",
        (false, true) => "Less a_0 at the start asks for less torque, but does not overshoot less",
        (true, false) => "Less a_0 at the start overshoots less, but does not ask for less torque",
        (false, false) => "Less a_0 at the start helps neither overshoot nor torque",
    };
    let what = format!("{what}{}", if later { ", and it settles later" } else { "" });
    let after = if steady {
        "after the change the error is that of the full gain"
    } else {
        "the error of the full gain is not reached after the change in every case"
    };
    Ok(statement(
        [
            "gains-in-transient",
            "Sec. VII-D",
            "The estimator's gains can be reduced during the transient for a better response.",
            "in words, for seven joints",
        ],
        verdict(flatter && softer && steady, softer && steady),
        (
            format!(
                "three-joint arm, m = 1, a_0 = 40, 20, 10 at the start: overshoot of joint 2 {} % (69.6 throughout: \
                 {}); largest torque {} N·m ({}); |e| < 0.01 rad from {} s ({})",
                list(&percent),
                percent(full),
                list(&torque),
                torque(full),
                list(&time),
                time(full)
            ),
            format!(
                "{what}; {after}. Printed form, a_0 = 69.6 once the mismatch has settled, with φ̂ handed over. The \
                 paper says it of its seven-joint arm and gives neither gains nor figures; here it is tried where the \
                 start is off the path."
            ),
        ),
        numbers(&runs, full),
    )
    .read_as("Better: less torque at the start, less overshoot; then the steady error of the full gain.")
    .varying("a_0 of the start: 40, 20, 10 rad/s, on the three-joint arm.")
    .turning("As printed where the overshoot falls too; with the correction where the torque alone does."))
}

fn numbers(runs: &[(f64, Run)], full: &Run) -> Vec<PaperNumber> {
    let mut numbers = Vec::new();
    for (a0, run) in runs.iter().map(|(a0, run)| (Some(*a0), run)).chain([(None, full)]) {
        let name = |what: &str| match a0 {
            Some(a0) => format!("{what}, a_0 = {a0} at the start"),
            None => format!("{what}, a_0 = 69.6 from the start"),
        };
        numbers.push(number(&name("overshoot of joint 2"), "", run.overshoot(1), 1e-3));
        numbers.push(number(&name("largest torque"), "N·m", run.torque_max(), 1e-3));
        numbers.push(number(&name("|e| < 0.01 rad from"), "s", run.settled_at(), 1e-2));
        numbers.push(number(&name("steady e, rms"), "rad", run.steady_rms(), 1e-2));
    }
    numbers
}

fn with(study: &Study, a0: f64) -> Study {
    let mut study = study.clone();
    if let Some(LawRequest::Coefficients { a, .. }) =
        study.gains.as_mut().map(|gains| &mut gains.law)
    {
        *a = vec![a0];
    }
    study
}
