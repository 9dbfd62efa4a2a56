//! `[world]` and `[start]`: what the arm meets, and where the run begins.

use crate::arm::Arm;
use crate::control::limits;
use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::node::Node;
use crate::payload;
use crate::study::{Push, Start, World};

pub(crate) fn read(top: &Node<'_>, arm: &Arm, duration: f64) -> Result<World, StudyError> {
    let node = top.child("world");
    let joints = &arm.joints;
    let drives = arm.robot.joints.iter().map(|joint| joint.drive_bandwidth_hz);
    let pushes = node.children("push");
    Ok(World {
        gravity: node.numbers("gravity_m_s2")?,
        robot_friction: node.word("friction")? == "robot",
        extra_coulomb: joints.numbers(&node, "coulomb_extra_nm")?,
        extra_viscous: joints.numbers(&node, "viscous_extra_nm_s_rad")?,
        drive_bandwidth_hz: limits(&node, arm, "drive_bandwidth_hz", drives)?,
        payload: payload::read(&node.child("payload"), arm)?,
        pushes: pushes.iter().map(|node| push(node, arm, duration)).collect::<Result<_, _>>()?,
        substeps: node.small_count("substeps")?,
        start: start(&top.child("start"), arm)?,
    })
}

fn push(node: &Node<'_>, arm: &Arm, duration: f64) -> Result<Push, StudyError> {
    let start = node.number("start_s")?;
    if start >= duration {
        let message = format!("{start} s is not before the end of the run at {duration} s");
        return Err(node.error(Kind::Conflict, "start_s", message));
    }
    Ok(Push {
        joint: arm.joints.known(node, "joint", node.word("joint")?)?,
        torque: node.number("torque_nm")?,
        start,
        duration: node.number("duration_s")?,
    })
}

fn start(node: &Node<'_>, arm: &Arm) -> Result<Option<Start>, StudyError> {
    if !node.exists() {
        return Ok(None);
    }
    let q = arm.position(node, "q_rad", "pose")?;
    let dq = arm.joints.numbers(node, "dq_rad_s")?;
    dq.iter().enumerate().try_for_each(|(j, &x)| arm.check_velocity(node, "dq_rad_s", j, x))?;
    Ok(Some(Start { q, dq }))
}
