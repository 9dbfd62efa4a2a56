//! Arms: those of the project, and random chains, as the text of URDF and robot file.

use phihat_model::{Robot, RobotError};
use phihat_session::Dice;

use crate::chain_text::{toml, urdf};
use crate::link::{LinkOfJoint, moved};

/// An arm as its user has it.
#[derive(Debug, Clone)]
pub enum UserArm {
    /// One of `robots/`.
    Named(&'static str),
    /// A chain, as texts.
    Written {
        /// Number of joints.
        joints: usize,
        /// Text of the URDF.
        urdf: String,
        /// Text of the robot file.
        toml: String,
    },
}

impl UserArm {
    /// One of `robots/` in three of ten, else a random chain.
    pub fn draw(dice: &mut Dice) -> Self {
        if dice.chance(0.3) {
            return Self::Named(dice.pick(&NAMED));
        }
        let joints = dice.pick(&[2, 2, 3, 3, 4, 4, 5, 6, 6, 7, 7, 8, 9, 10, 11, 12]);
        chain(dice, joints, (0.1, 1.5))
    }

    /// Two to four joints, mostly of a random chain; now and then a whole arm of `robots/`.
    pub fn small(dice: &mut Dice) -> Self {
        let share = dice.share();
        if share < 0.03 {
            Self::Named(dice.pick(&NAMED))
        } else if share < 0.10 {
            Self::Named("planar3r")
        } else {
            let joints = dice.pick(&[2, 2, 2, 2, 3, 3, 4]);
            chain(dice, joints, (0.2, 3.0))
        }
    }

    /// The robot.
    ///
    /// # Errors
    ///
    /// [`RobotError`]: a fault of the generator.
    pub fn robot(&self) -> Result<Robot, RobotError> {
        match self {
            Self::Named(name) => Robot::named(name),
            Self::Written { urdf, toml, .. } => Robot::from_text(urdf, Some(toml), "arm.toml"),
        }
    }

    /// `[robot]` of a study, and the files beside it.
    pub fn section(&self) -> (String, Vec<(&'static str, &str)>) {
        match self {
            Self::Named(name) => (format!("name = \"{name}\""), Vec::new()),
            Self::Written { urdf, toml, .. } => (
                "file = \"arm.toml\"".to_owned(),
                vec![("arm.urdf", urdf.as_str()), ("arm.toml", toml.as_str())],
            ),
        }
    }

    /// Its name in records.
    pub fn name(&self) -> String {
        match self {
            Self::Named(name) => (*name).to_owned(),
            Self::Written { joints, .. } => format!("chain{joints}"),
        }
    }
}

const NAMED: [&str; 4] = ["planar3r", "panda", "iiwa14", "ur5"];

fn chain(dice: &mut Dice, n: usize, rotors: (f64, f64)) -> UserArm {
    let reach = dice.log_between(0.25, 1.5);
    let (first, taper) = (dice.log_between(0.5, 10.0), dice.between(0.6, 0.95));
    let prismatic = if dice.chance(0.3) { 0.25 } else { 0.0 };
    let odd = dice.chance(0.3);
    let mut before = [0.0, 0.0, 0.1];
    let mut parts = Vec::new();
    for i in 0..n {
        let length = reach / n as f64 * dice.between(0.4, 1.6);
        let along = dice.pick(&[[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]);
        let along = if odd { dice.direction() } else { along };
        let mass = first * taper.powi(i32::try_from(i).unwrap_or(0)) * dice.between(0.6, 1.4);
        let part = LinkOfJoint::draw(dice, (prismatic, odd), before, (length, along, mass));
        before = along.map(|x| x * length);
        parts.push(part);
    }
    let rotor = rotor_inertia(dice, &parts, rotors);
    UserArm::Written {
        joints: n,
        urdf: urdf(dice, &parts, before),
        toml: toml(dice, &parts, &rotor),
    }
}

/// Rotor inertia: a share of what the joint moves at most; none at all now and then.
fn rotor_inertia(dice: &mut Dice, parts: &[LinkOfJoint], (low, high): (f64, f64)) -> Vec<f64> {
    let share = if dice.chance(0.06) { 0.0 } else { dice.log_between(low, high) };
    let even = dice.chance(0.5);
    let at = |i: usize, dice: &mut Dice| {
        let factor = if even { 1.0 } else { dice.between(0.5, 1.5) };
        share * factor * moved(parts, i)
    };
    (0..parts.len()).map(|i| at(i, dice)).collect()
}

#[cfg(test)]
mod tests {
    use super::UserArm;
    use phihat_session::Dice;

    #[test]
    fn every_chain_is_read() {
        for index in 0..200 {
            for arm in [UserArm::draw, UserArm::small] {
                let robot = arm(&mut Dice::new(7, index)).robot().unwrap();
                assert!(!robot.joints.is_empty());
            }
        }
    }
}
