//! A study run with gains.

use phihat_design::{Gains, GainsError};
use phihat_sim::{SimError, SimulationOutcome};
use phihat_study::Study;
use thiserror::Error;

use crate::phase;

/// Why a study cannot run with gains.
#[derive(Debug, Error)]
pub enum NoRun {
    /// The gains are none of this study.
    #[error(transparent)]
    Gains(#[from] GainsError),
    /// It cannot be simulated.
    #[error(transparent)]
    Sim(#[from] SimError),
}

/// Runs a study with gains, whatever is claimed of them; its encoders displaced by shares of a quantum, if any.
///
/// # Errors
///
/// [`NoRun`]: the gains are none of this study, or it cannot be simulated.
pub fn run(study: &Study, gains: &Gains, shares: &[f64]) -> Result<SimulationOutcome, NoRun> {
    let mut study = study.clone();
    gains.complete(&mut study)?;
    let names = study.robot.joint_names();
    let period = study.control.period_ns;
    let law = gains.joint_gains(&names, period, study.control.form)?;
    Ok(phase::run(&study, &law, shares)?)
}
