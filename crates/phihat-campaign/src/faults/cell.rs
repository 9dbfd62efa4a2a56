//! What a run came to.

use phihat_sim::{Outcome, Simulation, Survival};
use phihat_study::Study;
use serde::{Deserialize, Serialize};

use super::case::Case;
use super::matrix::Matrix;

/// Most samples from the reason of a stop to the stop.
pub const STOP_SAMPLES: u64 = 3;

/// What a run of the matrix came to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// When the fault began \[s\].
    pub onset_s: f64,
    /// The joint it was about, where it is about one.
    pub joint: String,
    /// Why it could not run at all.
    pub refused: Option<String>,
    /// Whether the arm and every torque stayed finite.
    pub finite: bool,
    /// Whether no drive was told more than the torque limit.
    pub torque_kept: bool,
    /// Whether no drive was told to change its torque faster than the rate limit.
    pub rate_kept: bool,
    /// Largest excursion from the onset on \[rad\].
    pub excursion_rad: f64,
    /// Largest error over the last tenth of the run \[rad\].
    pub error_end_rad: f64,
}

impl Matrix {
    /// Runs a case.
    pub fn run(&self, case: &Case) -> Cell {
        match self.outcome(case) {
            Ok((study, outcome)) => self.observe(case, &study, &outcome),
            Err(why) => Cell { refused: Some(why), ..self.nothing(case) },
        }
    }

    fn outcome(&self, case: &Case) -> Result<(Study, Outcome), String> {
        let study = self.study(case).map_err(|e| e.to_string())?;
        let outcome = self.simulation(case, &study)?.run(|_| ());
        Ok((study, outcome))
    }

    fn simulation(&self, case: &Case, study: &Study) -> Result<Simulation, String> {
        self.build(case, study).map_err(|e| e.to_string())
    }

    fn nothing(&self, case: &Case) -> Cell {
        let draw = self.draw(case);
        Cell {
            onset_s: draw.onset,
            joint: self.arms[case.arm].orders[0].1.robot.joints[draw.joint].name.clone(),
            refused: None,
            finite: false,
            torque_kept: false,
            rate_kept: false,
            excursion_rad: 0.0,
            error_end_rad: 0.0,
        }
    }

    fn observe(&self, case: &Case, study: &Study, outcome: &Outcome) -> Cell {
        let survival = Survival::of(outcome, study);
        let trace = &outcome.trace;
        let onset = trace.index_at(self.draw(case).onset);
        let torques = trace.joints.iter().flat_map(|j| &j.tau_command);
        let excursion = trace.joints.iter().flat_map(|j| j.e.get(onset..).unwrap_or(&[]));
        Cell {
            finite: survival.finite && torques.copied().all(f64::is_finite),
            torque_kept: survival.torque_kept,
            rate_kept: survival.torque_rate_kept,
            excursion_rad: excursion.fold(0.0, |most: f64, e| most.max(e.abs())),
            error_end_rad: survival.error_end_rad,
            ..self.nothing(case)
        }
    }
}
