//! A fourth hypothesis for the gains of m = 2: the printed 69.6 is no `b_0` but a misprinted `a_1 = K̃ + 1/γ²`.

use phihat::Form;
use phihat_design::claims::weights::{conditions, q_diagonal};
use phihat_design::claims::{Optimality, UnitLaw};
use phihat_design::prelude::*;
use phihat_study::LawRequest;

use super::claims::{estimates_better, keeps_bounds, peaks_more, same_torque};
use super::run::Run;
use super::runs::Runs;
use super::studies::{GainSetting, Studies, StudyKind};
use crate::compose::{number, statement, three};
use crate::gains::{K_TILDE, law, second_h4};
use crate::item::{self, Item};
use crate::part::PartError;
use crate::record::{PaperNumber, Statement, Verdict};

/// Other `a_0` beside that of the double pole \[1/s²\].
const OTHERS: [f64; 3] = [600.0, 1800.0, 2390.0];
/// Steps of the bisection for the largest `a_0` with a certificate.
const STEPS: u32 = 40;
/// Tolerance of our own figures on another machine.
const AGAIN: f64 = 1e-2;

/// Truth of the statements of Figs. 5 to 8 on m = 2, for one run: the overshoot, (49), the mismatch, (50).
fn figures(run: &Run, first: &Run) -> [bool; 4] {
    [
        peaks_more(run, first),
        keeps_bounds(run, GainSetting::H4),
        estimates_better(run, first),
        same_torque(run, first),
    ]
}

/// Returns true if A1 to A3 hold at the printed `K̃`, and Theorem 2 gives its certificate.
fn proved(law: &UnitLaw) -> Result<bool, PartError> {
    let met = conditions(law, K_TILDE).iter().all(|condition| condition.left > condition.right);
    Ok(met && Optimality::at(law, K_TILDE)?.certified().is_some())
}

fn with(a_0: f64) -> UnitLaw {
    law(&[a_0, second_h4().a_top()])
}

/// The largest `a_0` at which A1 to A3 hold.
fn largest() -> Result<f64, PartError> {
    let (mut low, mut high) = (second_h4().a[0], 4.0 * second_h4().a[0]);
    for _ in 0..STEPS {
        let middle = 0.5 * (low + high);
        if proved(&with(middle))? {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(low)
}

/// Returns true if all statements of [`figures`] hold with another `a_0`.
fn other(studies: &Studies, first: &Run, a_0: f64) -> Result<bool, PartError> {
    let mut study = studies.study(StudyKind::Simulation, GainSetting::H4, Form::Literal)?;
    if let Some(LawRequest::Coefficients { a, .. }) =
        study.gains.as_mut().map(|gains| &mut gains.law)
    {
        *a = with(a_0).a;
    }
    Ok(figures(&Run::of(study)?, first).iter().all(|holds| *holds))
}

/// The hypothesis against everything that is printed of m = 2.
pub(crate) fn hypothesis(runs: &Runs, studies: &Studies) -> Result<Statement, PartError> {
    let (first, run) =
        (runs.get(GainSetting::First, Form::Literal)?, runs.get(GainSetting::H4, Form::Literal)?);
    let law = second_h4();
    let (conditions, drawn) = (proved(&law)?, figures(run, first));
    let all = drawn.iter().all(|holds| *holds);
    let q44 = q_diagonal(&law, K_TILDE).last().copied();
    let gamma = (law.a_top() - K_TILDE).sqrt().recip();
    let bound = largest()?;
    let mut held = Vec::new();
    for a_0 in OTHERS {
        let holds = other(studies, first, a_0)? && proved(&with(a_0))?;
        held.push(format!("{a_0:.0}: {}", if holds { "yes" } else { "no" }));
    }
    let percent = |run: &Run| format!("{:.0}", run.overshoot(1) * 1e2);
    let left = |run: &Run| run.mismatch()[1];
    let said = [
        ("more overshoot (Figs. 5, 6)", drawn[0]),
        ("(49) kept (Fig. 7)", drawn[1]),
        ("less mismatch (Fig. 8)", drawn[2]),
        ("one torque (50)", drawn[3]),
    ]
    .map(|(what, holds)| format!("{what}: {}", if holds { "yes" } else { "no" }));
    let whole = statement(
        [
            "gains-h4",
            "Table 2 (C), Figs. 5 to 8",
            "The gains of m = 2 that were used meet A1 to A3 at the printed K̃, if 69.6 is a_1 = K̃ + 1/γ² and no b_0.",
            "K̃ = 68.9, b_0 = 69.6",
        ],
        if conditions && all { Verdict::WithCorrection } else { Verdict::Refuted },
        (
            format!(
                "Q_44 = {}, γ = {}; overshoot of joint 2 {} against {} %, mismatch {} against {} N·m; {}",
                three(q44),
                three(Some(gamma)),
                percent(run),
                percent(first),
                three(Some(left(run))),
                three(Some(left(first))),
                said.join("; ")
            ),
            "One misprint, of a name, in place of gains that break A3: 69.6 = K̃ + 1/γ² is also what a_0 is at m = 1. \
             a_0 is then not printed at all. H1 to H3 take 69.6 for b_0 and have no certificate at the printed K̃; \
             which one was used the paper does not tell."
                .to_owned(),
        ),
        numbers([first, run], (q44, gamma, bound)),
    );
    Ok(whole
        .read_as("a_1 = 69.6 and a_0 = 34.8², both poles of the estimator at 34.8 rad/s; printed form in simulation.")
        .varying(format!("a_0, with conditions and figures together: {}.", held.join("; ")))
        .turning(format!("A3 asks for a_0 below {} at a_1 = 69.6.", three(Some(bound))))
        .covering(&[Item { kind: item::Kind::Table, number: 2 }])
        .ours())
}

fn numbers(
    [first, run]: [&Run; 2],
    (q44, gamma, bound): (Option<f64>, f64, f64),
) -> Vec<PaperNumber> {
    let left = |run: &Run| run.mismatch()[1];
    vec![
        number("Q_44 at the printed K̃", "", q44, 1e-9),
        number("γ at the printed K̃", "", gamma, 1e-9),
        number("largest a_0 with A1 to A3", "1/s²", bound, 1e-6),
        number("overshoot of joint 2, m = 1", "", first.overshoot(1), AGAIN),
        number("overshoot of joint 2, H4", "", run.overshoot(1), AGAIN),
        number("mismatch, rms, m = 1", "N·m", left(first), AGAIN),
        number("mismatch, rms, H4", "N·m", left(run), AGAIN),
    ]
}
