//! `[world]` and `[start]`: what the arm meets, and where the run begins.

use crate::arm::StudyArm;
use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::node::Node;
use crate::payload;
use crate::per_joint::{Joints, PerJoint};
use crate::robot_value::limits;
use crate::study::{
    Drive, EndStops, Flexibility, Held, Loss, LostRows, Network, Push, Start, Stiction, ToolForce,
    Wall, World,
};

pub(crate) fn read(top: &Node<'_>, arm: &StudyArm, duration: f64) -> Result<World, StudyError> {
    let node = top.child("world");
    let joints = &arm.joints;
    let drives = arm.robot.joints.iter().map(|joint| joint.drive_bandwidth_hz);
    let (forces, pushes): (Vec<_>, Vec<_>) =
        node.children("push").into_iter().partition(|node| node.has("force_n"));
    let (walls, found) = (node.children("wall"), top.source.found);
    Ok(World {
        gravity: node.numbers("gravity_m_s2")?,
        robot_friction: node.word("friction")? == "robot",
        extra_coulomb: joints.numbers(&node, "coulomb_extra_nm")?,
        extra_viscous: joints.numbers(&node, "viscous_extra_nm_s_rad")?,
        drive_bandwidth_hz: limits(&node, arm, "drive_bandwidth_hz", drives)?,
        warm_up: (node.number("friction_cold_factor")?, node.number("friction_warm_up_s")?),
        stiction: stiction(&node.child("stiction"), joints)?,
        flexibility: found.keep(flexibility(&node.child("flexibility"), arm))?.flatten(),
        end_stops: end_stops(&node.child("end_stops"), joints)?,
        walls: found.each(walls.iter().map(|node| wall(node, arm)))?,
        forces: found.each(forces.iter().map(|node| force(node, arm, duration)))?,
        drive: found.keep(drive(&node.child("drive"), arm))?.flatten().map(Box::new),
        network: network(&node.child("network"))?,
        payload: found.keep(payload::read(&node.child("payload"), arm))?.flatten(),
        pushes: found.each(pushes.iter().map(|node| push(node, arm, duration)))?,
        substeps: node.small_count("substeps")?,
        substeps_stated: node.has("substeps"),
        start: found.keep(start(&top.child("start"), arm))?.flatten(),
        held: held(&top.child("start"), arm)?,
    })
}

fn drive(node: &Node<'_>, arm: &StudyArm) -> Result<Option<Drive>, StudyError> {
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
        rows: lost_rows(node)?,
    })
}

fn lost_rows(node: &Node<'_>) -> Result<Option<LostRows>, StudyError> {
    let (most, every) = ("commands_lost_max", "commands_lost_every_s");
    let (count, apart) = (node.small_count(most)?, node.number_if(every));
    match (count, apart) {
        (0, None) => Ok(None),
        (0, Some(_)) => {
            let message = format!("`{every}` without `{most}`: how many are lost is not stated");
            Err(node.error(Kind::Conflict, every, message))
        }
        (_, None) => {
            let message = format!("`{most}` without `{every}`: how often is not stated");
            Err(node.error(Kind::Conflict, most, message).with_help(format!("state {every}")))
        }
        (most, Some(apart)) => Ok(Some(LostRows { most, apart })),
    }
}

/// When something begins: before the end of the run.
fn begins(node: &Node<'_>, duration: f64) -> Result<f64, StudyError> {
    let start = node.number("start_s")?;
    if start < duration {
        return Ok(start);
    }
    let message = format!("{start} s is not before the end of the run at {duration} s");
    let error = node.error(Kind::Conflict, "start_s", message);
    node.note(error.with_help("make it smaller than duration_s at the top of the file"))?;
    Ok(start)
}

fn push(node: &Node<'_>, arm: &StudyArm, duration: f64) -> Result<Push, StudyError> {
    if node.has("frame") {
        let message = "`frame` belongs to `force_n`, not to `torque_nm`";
        return Err(node.error(Kind::Conflict, "frame", message));
    }
    Ok(Push {
        joint: arm.joints.known(node, "joint", node.word("joint")?)?,
        torque: node.number("torque_nm")?,
        start: begins(node, duration)?,
        duration: node.number("duration_s")?,
    })
}

fn force(node: &Node<'_>, arm: &StudyArm, duration: f64) -> Result<ToolForce, StudyError> {
    for key in ["joint", "torque_nm"] {
        if node.has(key) {
            let message = format!("`{key}` beside `force_n`: a push is a torque or a force");
            return Err(node.error(Kind::Conflict, key, message));
        }
    }
    Ok(ToolForce {
        frame: arm.frame(node, "frame")?,
        force: node.numbers("force_n")?,
        start: begins(node, duration)?,
        duration: node.number("duration_s")?,
    })
}

fn wall(node: &Node<'_>, arm: &StudyArm) -> Result<Wall, StudyError> {
    let normal: [f64; 3] = node.numbers("normal")?;
    let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length < 1e-9 {
        return Err(node.error(Kind::OutOfRange, "normal", "the normal has no direction"));
    }
    Ok(Wall {
        frame: arm.frame(node, "frame")?,
        point: node.numbers("point_m")?,
        normal: normal.map(|x| x / length),
        stiffness: node.number("stiffness_n_m")?,
        damping: node.number("damping_n_s_m")?,
    })
}

fn stiction(node: &Node<'_>, joints: &Joints) -> Result<Option<Stiction>, StudyError> {
    if !node.exists() {
        return Ok(None);
    }
    Ok(Some(Stiction {
        breakaway_ratio: joints.numbers(node, "breakaway_ratio")?,
        stribeck_velocity: joints.numbers(node, "stribeck_velocity_rad_s")?,
        stiffness: joints.numbers(node, "stiffness_nm_rad")?,
        damping: joints.numbers(node, "damping_nm_s_rad")?,
    }))
}

fn flexibility(node: &Node<'_>, arm: &StudyArm) -> Result<Option<Flexibility>, StudyError> {
    if !node.exists() {
        return Ok(None);
    }
    if let Some(joint) = arm.robot.joints.iter().find(|joint| joint.armature <= 0.0) {
        let message =
            format!("joint `{}` has no rotor inertia to stand behind a spring", joint.name);
        return Err(node.error(Kind::Robot, "stiffness_nm_rad", message));
    }
    Ok(Some(Flexibility {
        stiffness: arm.joints.numbers(node, "stiffness_nm_rad")?,
        damping: arm.joints.numbers(node, "damping_nm_s_rad")?,
        backlash: arm.joints.numbers(node, "backlash_rad")?,
    }))
}

fn end_stops(node: &Node<'_>, joints: &Joints) -> Result<Option<EndStops>, StudyError> {
    if !node.exists() {
        return Ok(None);
    }
    let stiffness = joints.numbers(node, "stiffness_nm_rad")?;
    Ok(Some(EndStops { stiffness, damping: joints.numbers(node, "damping_nm_s_rad")? }))
}

fn held(node: &Node<'_>, arm: &StudyArm) -> Result<Option<Held>, StudyError> {
    if !node.has("torque_nm") {
        return Ok(None);
    }
    Ok(Some(match arm.joints.numbers_or_word(node, "torque_nm")? {
        PerJoint::Values(torque) => Held::By(torque),
        PerJoint::Word("balance") => Held::InBalance,
        PerJoint::Word(_) => Held::ByGravity,
    }))
}

fn start(node: &Node<'_>, arm: &StudyArm) -> Result<Option<Start>, StudyError> {
    if !["q_rad", "pose", "dq_rad_s"].iter().any(|key| node.has(key)) {
        return Ok(None);
    }
    let q = arm.position(node, "q_rad", "pose")?;
    let dq = arm.joints.numbers(node, "dq_rad_s")?;
    let too_fast = dq.iter().enumerate().map(|(j, &x)| arm.check_velocity(node, "dq_rad_s", j, x));
    node.source.found.each(too_fast)?;
    Ok(Some(Start { q, dq }))
}
