//! Outcome of a run, in symbols and words.

use phihat_report::kit::number::stated;
use phihat_report::kit::text::line;

use crate::cost::LIMITED;
use crate::record::Comparison;
use crate::row::LawCell;
use crate::run_outcome::RunOutcome;
use crate::world::SATURATION;

/// Outcome of a run as a symbol and a word, so that no colour is needed.
pub(super) fn symbol_and_word(outcome: &RunOutcome) -> (&'static str, &'static str) {
    match outcome {
        RunOutcome::Followed => ("✓", "followed"),
        RunOutcome::Lost { .. } => ("▲", "did not follow"),
        RunOutcome::Diverged { .. } => ("✗", "diverged"),
        RunOutcome::NotFinite { .. } => ("⊘", "not a number"),
        RunOutcome::Refused(_) => ("–", "does not apply"),
        RunOutcome::Panicked(_) => ("‼", "program fault"),
    }
}

/// Defect of an arm that followed, in short and in full: its torque is noisier than tuned gains may be in
/// training, or it stays at limits that leave room for the motion, as in a limit cycle.
pub(super) fn unrest(comparison: &Comparison, cell: &LawCell) -> Option<(&'static str, String)> {
    let figures = cell.worst.as_ref().filter(|_| cell.outcome.followed())?;
    // There the limits are drawn in on purpose.
    let limited = figures.saturated > LIMITED && cell.world != SATURATION;
    let (noise, cap) = (figures.noise, comparison.fairness.noise_cap);
    if limited {
        let share = two_digits(100.0 * figures.saturated);
        return Some(("≈ at limits", format!("≈ {share} % of samples at a torque limit")));
    }
    (noise > cap)
        .then(|| ("≈ noisy", format!("≈ {} times the cap on noise", two_digits(noise / cap))))
}

/// Two significant digits.
pub(super) fn two_digits(value: f64) -> String {
    stated(format!("{value:.1e}").parse().unwrap_or(value))
}

/// Outcome of a run in words, with time, joint or reason.
pub(super) fn outcome_in_full(of: &RunOutcome) -> String {
    let word = symbol_and_word(of).1;
    match of {
        RunOutcome::Followed => word.to_owned(),
        RunOutcome::Lost { joint } => format!("{word}: {}", line(joint)),
        RunOutcome::Diverged { t, joint } | RunOutcome::NotFinite { t, joint } => {
            format!("{word} at {} s: {}", stated(*t), line(joint))
        }
        RunOutcome::Refused(why) | RunOutcome::Panicked(why) => format!("{word}: {}", line(why)),
    }
}
