//! Values that a study states, takes from the robot, or does without.

use crate::arm::StudyArm;
use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::node::Node;
use crate::per_joint::PerJoint;

/// Numbers of `key`, the robot's own, or none.
pub(crate) fn limits(
    node: &Node<'_>,
    arm: &StudyArm,
    key: &str,
    robot: impl Iterator<Item = Option<f64>>,
) -> Result<Option<Vec<f64>>, StudyError> {
    choose(node, arm, key, arm.joints.numbers_or_word(node, key)?, robot)
}

/// Value given for `key`, the robot's own, or none.
pub(crate) fn choose<T: Copy>(
    node: &Node<'_>,
    arm: &StudyArm,
    key: &str,
    given: PerJoint<'_, T>,
    robot: impl Iterator<Item = Option<T>>,
) -> Result<Option<Vec<T>>, StudyError> {
    let stated: Vec<Option<T>> = match given {
        PerJoint::Values(values) => return Ok(Some(values)),
        PerJoint::Word("robot") => robot.collect(),
        PerJoint::Word(_) => return Ok(None),
    };
    match stated.iter().position(Option::is_none) {
        None => Ok(Some(stated.into_iter().flatten().collect())),
        // By default, a robot that states nothing has no limit; asking for its value is a mistake.
        Some(_) if !node.has(key) && stated.iter().all(Option::is_none) => Ok(None),
        Some(j) => {
            let message = format!("the robot states no value for joint `{}`", arm.joints.names[j]);
            let error = node.error(Kind::Robot, key, message);
            node.note(error.with_help(format!("give `{key}` here, or \"none\"")))?;
            Ok(None)
        }
    }
}
