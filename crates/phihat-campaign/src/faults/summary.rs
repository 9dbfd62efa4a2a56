//! The answer of a fault matrix: every run against its bar.

use serde::{Deserialize, Serialize};

use super::case::FaultCase;
use super::catalogue::{Bar, FAULTS, RequiredEnd};
use super::cell::{FaultCell, STOP_SAMPLES};
use super::matrix::{FaultMatrix, FaultedArm};
use crate::runner::RunEnded;

/// Value of `format` in every summary.
pub const FORMAT: &str = "phihat-faults";

/// Share of runs that must keep their excursion.
pub const EXCURSION_SHARE: f64 = 0.99;

/// The whole answer, `faults.json`: the same bytes for the same matrix, however it was run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Always `"phihat-faults"`.
    pub format: String,
    /// Version of phihat.
    pub phihat_version: String,
    /// The arms.
    pub arms: Vec<FaultArmRecord>,
    /// The faults of the matrix.
    pub faults: Vec<FaultRecord>,
    /// Every run.
    pub runs: Vec<FaultRunRecord>,
    /// All of it in figures.
    pub totals: Totals,
}

/// An arm of the matrix.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FaultArmRecord {
    /// The study's name.
    pub name: String,
    /// The study's file, as it was named.
    pub study: String,
    /// SHA-256 of its text.
    pub study_sha256: String,
}

impl FaultArmRecord {
    fn of(arm: &FaultedArm) -> Self {
        Self {
            name: arm.name.clone(),
            study: arm.path.display().to_string(),
            study_sha256: arm.sha256.clone(),
        }
    }
}

/// A fault of the matrix.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FaultRecord {
    /// Its name.
    pub name: String,
    /// The failure mode it stands for.
    pub row: String,
    /// Description of the fault.
    pub what: String,
    /// The severities.
    pub levels: Vec<f64>,
    /// Their unit.
    pub unit: String,
    /// Required outcome of each severity.
    pub bars: Vec<Bar>,
}

/// A run and its verdict.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FaultRunRecord {
    /// Its name.
    pub name: String,
    /// Its id in the journal.
    pub id: String,
    /// The arm's name.
    pub arm: String,
    /// The estimator's order.
    pub order: usize,
    /// The fault's name.
    pub fault: String,
    /// Severity, 1 to 3.
    pub severity: usize,
    /// Seed.
    pub seed: u64,
    /// Result of the run.
    pub ended: RunEnded<FaultCell>,
    /// Bars that were missed, in words; empty: all kept.
    pub missed: Vec<Miss>,
}

impl FaultRunRecord {
    /// Result of the run; `None` if the program panicked.
    pub fn cell(&self) -> Option<&FaultCell> {
        match &self.ended {
            RunEnded::With(cell) => Some(cell),
            RunEnded::Panicked(_) => None,
        }
    }
}

/// A bar that a run can miss.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Miss {
    /// The program panicked.
    Panic,
    /// The study cannot be run with the fault in it.
    Refused,
    /// Something was not finite, or the arm diverged.
    NotFinite,
    /// A drive was commanded more than the torque limit.
    TorqueLimit,
    /// A drive was commanded to change its torque faster than the rate limit.
    RateLimit,
    /// The arm stopped before anything went wrong.
    FalseAlarm,
    /// The arm stopped later than it may after the reason to.
    SlowStop,
    /// The arm stopped, and should have gone on.
    Stopped,
    /// The arm went on, and should have stopped.
    WentOn,
    /// The stop came later after the onset than its bar.
    Late,
    /// The excursion was larger than its bar.
    Excursion,
}

impl Miss {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Panic => "the program panicked",
            Self::Refused => "cannot be run",
            Self::NotFinite => "not finite, or diverged",
            Self::TorqueLimit => "beyond the torque limit",
            Self::RateLimit => "beyond the torque-rate limit",
            Self::FalseAlarm => "stopped before the onset",
            Self::SlowStop => "stopped late after its reason",
            Self::Stopped => "stopped, should go on",
            Self::WentOn => "went on, should stop",
            Self::Late => "stopped late after the onset",
            Self::Excursion => "excursion beyond its bar",
        }
    }
}

/// The matrix in figures.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Totals {
    /// All runs.
    pub runs: usize,
    /// Runs that kept every bar.
    pub kept: usize,
    /// Runs that panicked or could not be run.
    pub panicked: usize,
    /// Runs with something not finite.
    pub not_finite: usize,
    /// Runs beyond a torque or rate limit.
    pub beyond_limits: usize,
    /// Runs in which the arm stopped before the onset, or later than it may after the stop's reason.
    pub bad_stops: usize,
    /// Runs that stopped and should not, went on and should not, or stopped late after the onset.
    pub wrong_ends: usize,
    /// Runs beyond their excursion's bar.
    pub beyond_excursion: usize,
    /// True if the matrix as a whole passes: no bar is missed but that of the excursion, and that by at most
    /// one run in a hundred.
    pub good: bool,
}

impl Summary {
    /// The answer from every run's record, in the order of the matrix's cases.
    pub fn new(matrix: &FaultMatrix, ended: Vec<RunEnded<FaultCell>>) -> Self {
        let runs: Vec<_> = matrix
            .cases
            .iter()
            .zip(ended)
            .map(|(case, ended)| record(matrix, case, ended))
            .collect();
        let used = |name: &str| matrix.cases.iter().any(|case| case.fault.name == name);
        let fault = |fault: &super::CatalogueFault| FaultRecord {
            name: fault.name.to_owned(),
            row: fault.row.to_owned(),
            what: fault.what.to_owned(),
            levels: fault.levels.to_vec(),
            unit: fault.unit.to_owned(),
            bars: fault.bars.to_vec(),
        };
        Self {
            format: FORMAT.to_owned(),
            phihat_version: env!("CARGO_PKG_VERSION").to_owned(),
            arms: matrix.arms.iter().map(FaultArmRecord::of).collect(),
            faults: FAULTS.iter().filter(|f| used(f.name)).map(fault).collect(),
            totals: Totals::of(&runs),
            runs,
        }
    }
}

fn record(matrix: &FaultMatrix, case: &FaultCase, ended: RunEnded<FaultCell>) -> FaultRunRecord {
    let missed = match &ended {
        RunEnded::Panicked(_) => vec![Miss::Panic],
        RunEnded::With(cell) => misses(cell, &case.fault.bars[case.severity]),
    };
    FaultRunRecord {
        name: matrix.name(case).to_string(),
        id: matrix.id(case),
        arm: matrix.arms[case.arm].name.clone(),
        order: case.order,
        fault: case.fault.name.to_owned(),
        severity: case.severity + 1,
        seed: case.seed,
        ended,
        missed,
    }
}

/// Bars that a run misses.
fn misses(cell: &FaultCell, bar: &Bar) -> Vec<Miss> {
    if cell.refused.is_some() {
        return vec![Miss::Refused];
    }
    let beyond = bar.excursion_rad.is_some_and(|most| cell.excursion_rad > most);
    let stopped = cell.stopped.as_ref().map(|(_, ms)| *ms);
    let false_alarm = stopped.is_some_and(|ms| ms < 0.0);
    let ended = stopped.is_some() || cell.robot_stopped.is_some();
    let late = bar.noticed_ms.zip(stopped).is_some_and(|(most, ms)| ms > most);
    let all = [
        (Miss::NotFinite, !cell.finite),
        (Miss::TorqueLimit, !cell.torque_kept),
        (Miss::RateLimit, !cell.rate_kept),
        (Miss::FalseAlarm, false_alarm),
        (Miss::SlowStop, cell.stop_delay.is_some_and(|samples| samples > STOP_SAMPLES)),
        (Miss::Stopped, bar.end == RequiredEnd::Following && ended && !false_alarm),
        (Miss::WentOn, bar.end == RequiredEnd::Stopped && !ended),
        (Miss::Late, late),
        (Miss::Excursion, beyond),
    ];
    all.into_iter().filter_map(|(miss, so)| so.then_some(miss)).collect()
}

impl Totals {
    fn of(runs: &[FaultRunRecord]) -> Self {
        let count = |any: &[Miss]| {
            runs.iter().filter(|run| run.missed.iter().any(|m| any.contains(m))).count()
        };
        let beyond_excursion = count(&[Miss::Excursion]);
        let other = runs.iter().filter(|run| run.missed.iter().any(|m| *m != Miss::Excursion));
        let inside = (runs.len() - beyond_excursion) as f64;
        Self {
            runs: runs.len(),
            kept: runs.iter().filter(|run| run.missed.is_empty()).count(),
            panicked: count(&[Miss::Panic, Miss::Refused]),
            not_finite: count(&[Miss::NotFinite]),
            beyond_limits: count(&[Miss::TorqueLimit, Miss::RateLimit]),
            bad_stops: count(&[Miss::FalseAlarm, Miss::SlowStop]),
            wrong_ends: count(&[Miss::Stopped, Miss::WentOn, Miss::Late]),
            beyond_excursion,
            good: other.count() == 0 && inside >= EXCURSION_SHARE * runs.len() as f64,
        }
    }
}
