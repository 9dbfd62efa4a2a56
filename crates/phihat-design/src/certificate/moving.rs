//! Stability while the arm moves, in the certificate.

use super::Certificate;
use crate::arm::{Arm, InertiaRates};
use crate::claims::Refutation;
use crate::claims::law::holds;
use crate::gains::Gains;
use crate::sampled::{Moving, refuse};

const CLAIM: &str = "stability while moving";

impl Certificate {
    /// Finds how fast the arm may move through its range of inertia, or says why that is not proved.
    pub(crate) fn find_moving(&mut self, gains: &Gains, arm: &Arm) {
        match self.moving_of(gains, arm) {
            Ok(moving) => self.moving = Some(moving),
            Err(why) => self.moving_refused = Some(why),
        }
    }

    fn moving_of(&self, gains: &Gains, arm: &Arm) -> Result<Moving, Refutation> {
        self.one_loop()?;
        let first = gains.joints.first().zip(self.joints.first());
        let (record, joint) = first.ok_or_else(|| refuse(CLAIM, "there is a joint", 0.0, 1.0))?;
        let found = Moving::find(record, &joint.model, (self.arm.low, self.arm.high))?;
        let InertiaRates { motion_per_s, limits_per_s } = arm.rates(&self.arm.nominal_kg_m2);
        Ok(Moving { needed_motion_per_s: motion_per_s, needed_limits_per_s: limits_per_s, ..found })
    }

    /// Checks the claim, if it is made.
    pub(super) fn verify_moving(&self, gains: &Gains) -> Result<(), Refutation> {
        let Some(moving) = &self.moving else { return Ok(()) };
        self.one_loop()?;
        let holds_arm = moving.low <= self.arm.low && self.arm.high <= moving.high;
        holds(CLAIM, "its range holds the arm's", self.arm.high, moving.high, holds_arm)?;
        gains
            .joints
            .iter()
            .zip(&self.joints)
            .take(1)
            .try_for_each(|(record, joint)| moving.verify(record, &joint.model))
    }

    /// The multiplier is for joints that are all in the same loop.
    fn one_loop(&self) -> Result<(), Refutation> {
        let same = self.joints.windows(2).all(|pair| pair[0].model == pair[1].model);
        holds(CLAIM, "all joints are in the same loop", 0.0, 0.0, same)
    }
}
