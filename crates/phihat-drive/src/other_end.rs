//! Robot or simulated arm at the other end of a drive.

use phihat_study::Study;

use crate::error::DriveError;
use crate::facts::{Clock, Facts};
use crate::franka::FrankaLink;
use crate::link::{Link as _, LinkedRobot};
use crate::on::On;
use crate::order::{Order, OrderError};

/// The other end: a connected robot at rest, or the study's simulated arm.
pub(crate) struct OtherEnd {
    /// Words for it: the option on the command line, or the name of the link.
    pub(crate) words: String,
    pub(crate) facts: Facts,
    pub(crate) robot: Option<LinkedRobot>,
}

impl OtherEnd {
    pub(crate) fn of(own: Option<LinkedRobot>, on: &On, study: &Study) -> Result<Self, DriveError> {
        if let Some(robot) = own {
            let facts = robot.facts().clone();
            return Ok(Self { words: format!("over {}", facts.name), facts, robot: Some(robot) });
        }
        let (words, facts) = (on.words(), on.facts(study)?);
        let On::Franka(address) = on else { return Ok(Self { words, facts, robot: None }) };
        match FrankaLink::connect(address, facts.clone(), study) {
            Ok(robot) => Ok(Self { words, facts, robot: Some(Box::new(robot)) }),
            Err(why) => Err(DriveError::Robot { at: words, why }),
        }
    }

    /// Index of each joint of a study in the messages.
    pub(crate) fn order(&self, study: &Study) -> Result<Order, OrderError> {
        let names = study.robot.joint_names();
        Order::new(&names, self.facts.joints.as_deref(), self.facts.width)
    }

    /// Returns true if the arm is simulated in lock-step: then a rehearsal would be the drive itself.
    pub(crate) fn is_rehearsal(&self) -> bool {
        self.robot.is_none() && self.facts.clock == Clock::LockStep
    }
}
