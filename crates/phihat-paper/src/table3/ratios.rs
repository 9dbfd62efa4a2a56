//! Ratios of (51) between the laws, per joint and arm.

use super::arm::ArmScores;
use super::bench::Score;
use super::printed::PRINTED;
use crate::compose::{number, three};
use crate::record::PaperNumber;

/// (51) of law `over` divided by that of law `under`, per joint.
pub(super) fn ratios(scores: &[Score], over: usize, under: usize) -> Vec<f64> {
    let pairs = scores[over].square.iter().zip(&scores[under].square);
    pairs.map(|(over, under)| over / under).collect()
}

pub(super) fn printed_ratios(over: usize, under: usize) -> Vec<f64> {
    PRINTED.iter().map(|row| row[over] / row[under]).collect()
}

pub(super) fn span(ratios: &[f64]) -> [f64; 2] {
    ratios.iter().fold([f64::INFINITY, 0.0], |[low, high], r| [low.min(*r), high.max(*r)])
}

pub(super) fn written([low, high]: [f64; 2]) -> String {
    format!("{} … {}", three(low.into()), three(high.into()))
}

/// Spans on every arm, and the smallest ratio of all.
pub(super) fn on_arms(arms: &[ArmScores], of: impl Fn(&ArmScores) -> Vec<f64>) -> (String, f64) {
    let spans: Vec<_> = arms.iter().map(|arm| (arm.name(), span(&of(arm)))).collect();
    let text: Vec<_> = spans.iter().map(|(arm, s)| format!("{arm} {}", written(*s))).collect();
    (text.join("; "), spans.iter().fold(f64::INFINITY, |least, (_, s)| least.min(s[0])))
}

/// Ratios of one arm, as numbers: least and largest.
pub(super) fn ends(arm: &ArmScores, what: &str, of: &[f64], tolerance: f64) -> [PaperNumber; 2] {
    let [least, largest] = span(of);
    [("least", least), ("largest", largest)]
        .map(|(end, value)| number(&format!("{end} {what}, {}", arm.name()), "", value, tolerance))
}

/// (51) of a comparator over that of the proposed law, per joint.
pub(super) fn over_proposed(arm: &ArmScores, comparator: &Score) -> Vec<f64> {
    let pairs = comparator.square.iter().zip(&arm.stated[2].square);
    pairs.map(|(over, under)| over / under).collect()
}
