//! `[world]` and `[start]`: what the arm meets, and where the run begins.

use crate::arm::Arm;
use crate::control::limits;
use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::node::Node;
use crate::payload;
use crate::study::{Drive, Loss, Network, Push, Start, World};

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
        drive: drive(&node.child("drive"), arm)?.map(Box::new),
        network: network(&node.child("network"))?,
        payload: payload::read(&node.child("payload"), arm)?,
        pushes: pushes.iter().map(|node| push(node, arm, duration)).collect::<Result<_, _>>()?,
        substeps: node.small_count("substeps")?,
        start: start(&top.child("start"), arm)?,
    })
}

fn drive(node: &Node<'_>, arm: &Arm) -> Result<Option<Drive>, StudyError> {
    if !node.exists() {
        return Ok(None);
    }
    let (joints, robot) = (&arm.joints, &arm.robot.joints);
    let torque = robot.iter().map(|joint| joint.torque_max);
    let rate = robot.iter().map(|joint| joint.torque_rate_max);
    let drive = Drive {
        gain: joints.numbers(node, "gain")?,
        gain_error: joints.numbers(node, "gain_error")?,
        gain_drift: joints.numbers(node, "gain_drift_per_s")?,
        ripple: joints.numbers(node, "ripple")?,
        cogging: joints.numbers(node, "cogging_nm")?,
        ripple_per_turn: joints.counts(node, "ripple_per_turn")?,
        torque_max: limits(node, arm, "torque_max_nm", torque)?,
        torque_rate_max: limits(node, arm, "torque_rate_max_nm_s", rate)?,
        no_load_speed: limits(node, arm, "no_load_speed_rad_s", robot.iter().map(|_| None))?,
    };
    if drive.no_load_speed.is_some() && drive.torque_max.is_none() {
        let message = "the torque falls with speed from `torque_max_nm`, which is not given";
        return Err(node.error(Kind::Conflict, "no_load_speed_rad_s", message));
    }
    Ok(Some(drive))
}

fn network(node: &Node<'_>) -> Result<Network, StudyError> {
    let loss = |share: &str, burst: &str| -> Result<Loss, StudyError> {
        Ok(Loss { share: node.number(share)?, burst: node.number_if(burst) })
    };
    Ok(Network {
        command: loss("command_loss", "command_burst_samples")?,
        sample: loss("sample_loss", "sample_burst_samples")?,
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
