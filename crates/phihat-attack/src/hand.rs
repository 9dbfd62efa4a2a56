//! The hand that draws a study: its arm, its dice, and what several drawings share.

use phihat_model::Robot;
use phihat_session::Dice;

/// Robot, dice and loop settings from which a study is drawn.
pub(crate) struct Hand<'a> {
    pub(crate) robot: Robot,
    pub(crate) dice: &'a mut Dice,
    pub(crate) tags: Vec<String>,
    pub(crate) rate: f64,
    pub(crate) delay: u32,
    pub(crate) duration: f64,
}

impl Hand<'_> {
    pub(crate) fn count(&self) -> usize {
        self.robot.joints.len()
    }

    pub(crate) fn tag(&mut self, tag: &str) {
        self.tags.push(tag.to_owned());
    }

    /// A posture inside the limits.
    pub(crate) fn posture(&mut self) -> Vec<f64> {
        let ready = self.robot.poses.get("ready").cloned();
        if let Some(ready) = ready.filter(|_| self.dice.chance(0.5)) {
            return ready;
        }
        (0..self.count())
            .map(|i| {
                let (low, high) = self.range(i);
                low + (high - low) * self.dice.between(0.25, 0.75)
            })
            .collect()
    }

    pub(crate) fn range(&self, i: usize) -> (f64, f64) {
        self.robot.joints[i].position.unwrap_or((-2.5, 2.5))
    }
}
