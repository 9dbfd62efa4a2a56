//! `[reference]`: what the arm shall do, refused where the joints' limits do not allow it.

use crate::arm::StudyArm;
use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::node::Node;
use crate::run::{QUINTIC_SLOPE_MAX, ReferenceRun};
use crate::samples::{self, Between, SampledReference, rows};
use crate::study::{MotionClass, ReferenceRequest};
use crate::{cartesian, sines};

pub(crate) fn read(
    node: &Node<'_>,
    arm: &StudyArm,
    run: ReferenceRun<'_>,
) -> Result<ReferenceRequest, StudyError> {
    match node.word("kind")? {
        "sines" => sines::read(node, arm, run),
        "waypoints" => waypoints(node, arm),
        "csv" => samples::read(node, arm, run),
        "setpoints" => setpoints(node, arm, run),
        "any" => any(node, arm, run.seed),
        "hold" => Ok(ReferenceRequest::Waypoints {
            t: vec![0.0],
            q: vec![arm.position(node, "q_rad", "pose")?],
        }),
        _ => cartesian::read(node, arm),
    }
}

fn waypoints(node: &Node<'_>, arm: &StudyArm) -> Result<ReferenceRequest, StudyError> {
    let (mut t, mut q): (Vec<f64>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
    let found = node.source.found;
    for node in node.children("waypoint") {
        let time = found.keep(node.number("t_s"))?;
        let position = found.keep(arm.position(&node, "q_rad", "pose"))?;
        let (Some(time), Some(position)) = (time, position) else { continue };
        match (t.last(), q.last()) {
            (Some(&before), Some(from)) => {
                check_order(&node, before, time)?;
                if node.is_clean() {
                    check_leg(&node, arm, from, &position, time - before)?;
                }
            }
            _ if time > 0.0 => {
                let message = format!("the first waypoint is at {time} s, expected 0");
                node.note(node.error(Kind::OutOfRange, "t_s", message))?;
            }
            _ => {}
        }
        t.push(time);
        q.push(position);
    }
    Ok(ReferenceRequest::Waypoints { t, q })
}

/// Setpoints from a file or from sections, and the limits of the motion to them.
fn setpoints(
    node: &Node<'_>,
    arm: &StudyArm,
    run: ReferenceRun<'_>,
) -> Result<ReferenceRequest, StudyError> {
    let speed = arm.joints.numbers(node, "speed_max_rad_s")?;
    let acceleration = arm.joints.numbers(node, "acceleration_max_rad_s2")?;
    let jerk = arm.joints.numbers(node, "jerk_max_rad_s3")?;
    for (j, speed) in speed.iter().enumerate() {
        arm.check_velocity(node, "speed_max_rad_s", j, *speed)?;
    }
    let limits = speed.iter().zip(&acceleration).zip(&jerk).map(|((v, a), j)| [*v, *a, *j]);
    let limits = limits.collect();
    match (node.has("file"), node.has("setpoint")) {
        (true, false) => {
            let SampledReference { t, q, unread } = rows(node, arm, run, Between::Jumps)?;
            return Ok(ReferenceRequest::Setpoints { t, q, limits, unread });
        }
        (false, true) => {}
        (true, true) => {
            let why = "given, beside [[reference.setpoint]]";
            return Err(node.error(Kind::Conflict, "file", why).with_help("keep one of them"));
        }
        (false, false) => return Err(node.missing("file")),
    }
    let (mut t, mut q): (Vec<f64>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
    for node in node.children("setpoint") {
        let time = node.number("t_s")?;
        match t.last() {
            Some(&before) => check_order(&node, before, time)?,
            None if time > 0.0 => {
                let message = format!("the first setpoint is at {time} s, expected 0");
                node.note(node.error(Kind::OutOfRange, "t_s", message))?;
            }
            None => {}
        }
        t.push(time);
        q.push(arm.position(&node, "q_rad", "pose")?);
    }
    Ok(ReferenceRequest::Setpoints { t, q, limits, unread: Vec::new() })
}

/// A class of motions: its box inside the joints' limits, its speeds too.
fn any(node: &Node<'_>, arm: &StudyArm, seed: u64) -> Result<ReferenceRequest, StudyError> {
    let center = arm.position(node, "center_rad", "center")?;
    let half = arm.joints.numbers_if(node, "box_rad")?;
    let speed = arm.joints.numbers(node, "speed_max_rad_s")?;
    let acceleration = arm.joints.numbers(node, "acceleration_max_rad_s2")?;
    let jerk = arm.joints.numbers(node, "jerk_max_rad_s3")?;
    let (mut low, mut high) = (Vec::new(), Vec::new());
    for (j, middle) in center.iter().enumerate() {
        arm.check_velocity(node, "speed_max_rad_s", j, speed[j])?;
        let ends = match &half {
            Some(half) => {
                let ends = (middle - half[j], middle + half[j]);
                arm.check_position(node, "box_rad", j, ends.0)?;
                arm.check_position(node, "box_rad", j, ends.1)?;
                ends
            }
            None => arm.range(node, j)?,
        };
        low.push(ends.0);
        high.push(ends.1);
    }
    let class = MotionClass { center, low, high, speed, acceleration, jerk };
    Ok(ReferenceRequest::Any { class, seed })
}

fn check_order(node: &Node<'_>, before: f64, time: f64) -> Result<(), StudyError> {
    if time > before {
        return Ok(());
    }
    let message = format!("{time} s is not after the one before it, at {before} s");
    node.note(node.error(Kind::OutOfRange, "t_s", message))
}

/// The leg's largest velocity is exact: the quintic's slope is largest in the middle.
fn check_leg(
    node: &Node<'_>,
    arm: &StudyArm,
    from: &[f64],
    to: &[f64],
    time: f64,
) -> Result<(), StudyError> {
    let key = if node.has("pose") { "pose" } else { "q_rad" };
    from.iter().zip(to).enumerate().try_for_each(|(j, (a, b))| {
        let peak = QUINTIC_SLOPE_MAX * (b - a).abs() / time;
        let refused = arm.check_velocity(node, key, j, peak).map_err(|error| {
            error.with_help(format!("the leg of {time} s needs more time, or a shorter way"))
        });
        node.source.found.keep(refused).map(drop)
    })
}
