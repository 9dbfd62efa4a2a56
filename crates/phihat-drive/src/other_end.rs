//! Whatever is at the other end of a drive, connected.

use phihat_study::Study;

use crate::error::DriveError;
use crate::facts::{Clock, Facts};
use crate::franka::FrankaLink;
use crate::link::{Link as _, Robot};
use crate::on::On;
use crate::order::{Order, OrderError};

/// What is at the other end: a robot that is connected, and stands, or the study's own arm.
pub(crate) struct OtherEnd {
    /// What a person calls it.
    pub(crate) words: String,
    pub(crate) facts: Facts,
    pub(crate) robot: Option<Robot>,
}

impl OtherEnd {
    pub(crate) fn of(own: Option<Robot>, on: &On, study: &Study) -> Result<Self, DriveError> {
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

    /// Where each joint of a study stands in the messages.
    pub(crate) fn order(&self, study: &Study) -> Result<Order, OrderError> {
        let names: Vec<_> = study.robot.joints.iter().map(|joint| joint.name.clone()).collect();
        Order::new(&names, self.facts.joints.as_deref(), self.facts.width)
    }

    /// Whether the arm is the simulated one, in lock-step: then a rehearsal would be the drive itself.
    pub(crate) fn is_rehearsal(&self) -> bool {
        self.robot.is_none() && self.facts.clock == Clock::LockStep
    }
}
