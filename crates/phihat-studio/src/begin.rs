//! Study and gains that a run begins with.

use phihat_design::Gains;
use phihat_sim::{ControlSide, Simulation, WorldSide};
use phihat_study::Study;

use crate::error::StudioError;

/// A study with its gains, ready to be begun any number of times.
#[derive(Debug, Clone)]
pub struct Begin {
    /// The study, completed by the gains.
    pub study: Box<Study>,
    /// The gains.
    pub gains: Gains,
}

impl Begin {
    /// One control side and one world.
    pub(crate) fn sides(&self) -> Result<(ControlSide, WorldSide), StudioError> {
        let study = &self.study;
        let names = study.robot.joint_names();
        let law = self
            .gains
            .joint_gains(&names, study.control.period_ns, study.control.form)
            .map_err(|why| StudioError::refused(why.to_string()))?;
        // Gains that were changed by hand have no bound that a watch could rest on.
        let watch = phihat_session::contact_watch(study, &self.gains).ok().flatten();
        Ok(Simulation::new(study, &law)?.watched(watch).apart())
    }
}
