//! Result of one run of the matrix.

use phihat_model::{Joint, JointKind, Robot};
use phihat_sim::Surviving;
use serde::{Deserialize, Serialize};

use super::case::FaultCase;
use super::matrix::{FaultMatrix, FaultRunError};
use super::seen::FaultObservations;

/// Most samples from the reason of a stop to the stop.
pub const STOP_SAMPLES: u64 = 3;

/// The unit of an arm whose joints turn.
fn turning() -> String {
    "mrad".to_owned()
}

/// The unit of an arm's joints, for people.
fn way_unit(robot: &Robot) -> String {
    let slides = |joint: &Joint| joint.kind == JointKind::Prismatic;
    match (robot.joints.iter().all(slides), robot.joints.iter().any(slides)) {
        (true, _) => "mm".to_owned(),
        (false, true) => "mrad or mm".to_owned(),
        (false, false) => turning(),
    }
}

/// Result of a run of the matrix.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FaultCell {
    /// Onset of the fault \[s\].
    pub onset_s: f64,
    /// The joint it was about, where it is about one.
    pub joint: String,
    /// Why it could not run at all.
    pub refused: Option<String>,
    /// True if the state of the arm and every torque stayed finite.
    pub finite: bool,
    /// True if no drive was commanded more than the torque limit.
    pub torque_kept: bool,
    /// True if no drive was commanded to change its torque faster than the rate limit.
    pub rate_kept: bool,
    /// First event that the controller detected, and its time after the onset \[ms\].
    pub noticed: Option<(String, f64)>,
    /// Reason of the stop, and its time after the onset \[ms\]; negative: a false alarm.
    pub stopped: Option<(String, f64)>,
    /// Samples from the stop's reason to the stop.
    pub stop_delay: Option<u64>,
    /// Why the robot itself stopped, if it did.
    pub robot_stopped: Option<String>,
    /// Unit of excursion and error for people: mrad, mm for joints that slide, or both for an arm that has
    /// both.
    #[serde(default = "turning")]
    pub way_unit: String,
    /// Largest excursion from the onset until the brakes have closed \[rad\].
    pub excursion_rad: f64,
    /// Largest error over the last tenth of the run \[rad\].
    pub error_end_rad: f64,
}

impl FaultMatrix {
    /// Runs a case.
    pub fn run(&self, case: &FaultCase) -> FaultCell {
        self.observed(case).unwrap_or_else(|why| FaultCell {
            refused: Some(why.to_string()),
            ..self.nothing(case)
        })
    }

    fn observed(&self, case: &FaultCase) -> Result<FaultCell, FaultRunError> {
        let study = self.study(case)?;
        let mut seen =
            (FaultObservations::new(&study, self.draw(case).onset), Surviving::new(&study));
        let Ok(ended) = self.build(case, &study)?.record(&mut seen, |_| ());
        let (seen, surviving) = seen;
        let survival = surviving.survival(&ended, &study);
        Ok(FaultCell {
            finite: survival.finite && seen.is_finite(),
            torque_kept: survival.torque_kept,
            rate_kept: survival.torque_rate_kept,
            noticed: seen.noticed(),
            stopped: seen.stopped(),
            stop_delay: seen.delay(),
            robot_stopped: ended.abort.as_ref().map(|abort| abort.reason.to_string()),
            excursion_rad: seen.excursion(),
            error_end_rad: survival.error_end_rad,
            ..self.nothing(case)
        })
    }

    fn nothing(&self, case: &FaultCase) -> FaultCell {
        let draw = self.draw(case);
        let robot = &self.arms[case.arm].orders[0].1.robot;
        FaultCell {
            onset_s: draw.onset,
            joint: robot.joints[draw.joint].name.clone(),
            way_unit: way_unit(robot),
            refused: None,
            finite: false,
            torque_kept: false,
            rate_kept: false,
            noticed: None,
            stopped: None,
            stop_delay: None,
            robot_stopped: None,
            excursion_rad: 0.0,
            error_end_rad: 0.0,
        }
    }
}
