//! Drafts that are studies and can be simulated.

use std::io;
use std::path::Path;

use phihat::{Form, GainError, JointDesign, JointGains};
use phihat_model::RobotError;
use phihat_session::Dice;
use phihat_sim::{SimError, Simulation};
use phihat_study::StudyError;
use thiserror::Error;

use crate::draft::Draft;
use crate::draw::draw;

/// Finer integration than this makes a study too slow to be worth it.
const SUBSTEPS_MAX: u32 = 40;

/// Why a draft is no study.
#[derive(Debug, Error)]
pub(crate) enum NoDraft {
    /// Its arm is none: a fault of the generator.
    #[error("arm: {0}")]
    Arm(RobotError),
    /// The arm's files cannot be written.
    #[error(transparent)]
    Disk(#[from] io::Error),
    /// Its text is refused.
    #[error(transparent)]
    Study(Box<StudyError>),
    /// The gains that it is tried with are refused.
    #[error(transparent)]
    Gains(#[from] GainError),
    /// It cannot be simulated.
    #[error(transparent)]
    Sim(#[from] SimError),
    /// Its integration would need too many steps.
    #[error("too stiff to be integrated quickly")]
    TooStiff,
}

impl From<StudyError> for NoDraft {
    fn from(why: StudyError) -> Self {
        Self::Study(Box::new(why))
    }
}

/// A draft that is a study and that can be simulated, its arm's files in the folder.
pub(crate) fn drawn(dice: &mut Dice, shares: (f64, f64), folder: &Path) -> Result<Draft, NoDraft> {
    let mut draft = draw(dice, shares).map_err(NoDraft::Arm)?;
    std::fs::create_dir_all(folder)?;
    for (name, text) in draft.arm.section().1 {
        std::fs::write(folder.join(name), text)?;
    }
    let mut stiffest = draft.nominal.clone();
    stiffest.coulomb.clone_from(&draft.scope.coulomb.1);
    let mut study = draft.study(&stiffest, folder)?;
    study.sensor.velocity_filter_designed = false;
    let period = study.control.period_ns as f64 * 1e-9;
    // Which law it is makes no integration stiff.
    let form = match study.control.form {
        Form::Literal => Form::Literal,
        Form::Observer | Form::Positions => Form::Observer,
    };
    let design = JointDesign { inertia: 1.0, kp: 100.0, kd: 20.0, a: &[20.0], period, form };
    let law = JointGains::new(&design)?;
    match Simulation::new(&study, &vec![law; study.robot.joints.len()]) {
        Ok(_) => Ok(draft),
        Err(SimError::TooStiff { needed, .. }) if needed <= SUBSTEPS_MAX => {
            draft.substeps = needed + needed / 4 + 1;
            Ok(draft)
        }
        Err(SimError::TooStiff { .. }) => Err(NoDraft::TooStiff),
        Err(why) => Err(why.into()),
    }
}
