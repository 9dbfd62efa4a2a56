//! One rival, one choice of gains, one study: a run.

use std::sync::Arc;

use phihat_baselines::{Entry, Refusal, Tuning};
use phihat_sim::{Outcome, SimError, Simulation};
use phihat_study::Study;
use thiserror::Error;

use super::adapter::{Adapter, Broken, supply};
use super::ground::Ground;

/// Link masses of the nominal model over the arm's.
pub const NOMINAL_MASSES: f64 = 0.8;

/// Why a run cannot begin.
#[derive(Debug, Error)]
pub(crate) enum TrialError {
    #[error("{0}")]
    Refused(#[from] Refusal),
    #[error("{0}")]
    Sim(#[from] SimError),
    #[error("the nominal model cannot be made: {0}")]
    Model(#[from] phihat_model::ModelError),
}

/// What a run leaves, and when and at which joint the rival's torque was no number, if it was.
#[derive(Debug)]
pub(crate) struct Trial {
    pub(crate) outcome: Outcome,
    pub(crate) broken: Option<(f64, usize)>,
}

/// Runs a rival.
///
/// # Errors
///
/// [`TrialError`]: the rival does not apply to this arm or task, or the study cannot be simulated.
pub(crate) fn run(
    ground: &Ground,
    entry: &Entry,
    values: &[f64],
    study: &Study,
) -> Result<Trial, TrialError> {
    let period = study.control.period_ns as f64 * 1e-9;
    let tuning = Tuning::new(values, &ground.units, period)?;
    let rival = entry.build(&tuning, &supply(study, &ground.units, NOMINAL_MASSES)?)?;
    let broken = Broken::default();
    let driver = Adapter::watched(rival, ground.joints(), Arc::clone(&broken));
    let outcome = Simulation::driven(study, driver, &ground.units)?.run(|_| ());
    Ok(Trial { outcome, broken: broken.get().copied() })
}
