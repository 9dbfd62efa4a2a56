//! `[supervisor]`: guard, limits and modes around the law.

use phihat::Form;

use crate::arm::StudyArm;
use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::node::Node;
use crate::robot_value::limits;

/// `[supervisor]`; one entry per joint, `None` where the study states none.
#[derive(Debug, Clone, PartialEq)]
pub struct SupervisorRequest {
    /// Largest plausible |q̇| \[rad/s\].
    pub velocity_max: Option<Vec<f64>>,
    /// Largest |e| \[rad\].
    pub error_stop: Option<Vec<f64>>,
    /// Travel that shows a frozen sensor \[rad\].
    pub frozen_travel: Option<Vec<f64>>,
    /// Oscillation of the demand \[N·m\].
    pub oscillation: Option<Vec<f64>>,
    /// Torque variation for the first-motion check \[N·m\].
    pub first_motion: Option<Vec<f64>>,
    /// Integral dead zone \[rad\].
    pub dead_zone: Option<Vec<f64>>,
    /// Width of the soft zones \[rad\].
    pub soft_zone: Option<Vec<f64>>,
    /// Deceleration before a joint limit \[rad/s²\].
    pub braking: f64,
    /// Velocity, acceleration and jerk that the reference is shaped to; of a class of motions those of the class.
    pub motion: Option<[Vec<f64>; 3]>,
    /// Low and high ends of the box that the reference is kept in \[rad\]: those of a class of motions.
    pub reference_box: Option<[Vec<f64>; 2]>,
    /// Initial and final width of the funnel \[rad\].
    pub funnel: Option<[Vec<f64>; 2]>,
    /// Time constant of the funnel \[s\].
    pub funnel_decay: f64,
    /// Torque when armed \[N·m\].
    pub preset: Option<Vec<f64>>,
    /// Torque by which a start may be out of balance \[N·m\]; `None`: derived. Of a class of motions alone.
    pub start_imbalance: Option<Vec<f64>>,
    /// Certified bound on the measured error \[rad\]: no key of a study, but what a certificate says of its gains.
    pub error_bound: Option<Vec<f64>>,
    /// True if a measured error beyond `error_bound` stops the arm.
    pub error_bound_stop: bool,
    /// True if the law starts at first order.
    pub start_first_order: bool,
    /// Factor on the estimator's poles at the start, ≤ 1; `None`: as fast as the gains.
    pub start_factor: Option<f64>,
    /// Mismatch that counts as settled, and as disturbed \[N·m\].
    pub settled: f64,
    /// See `settled`; infinite: never.
    pub disturbed: f64,
    /// Time for which either must last \[s\].
    pub dwell: f64,
    /// Longest time that a torque may stay at its limit \[s\].
    pub saturation: f64,
    /// Closing time of the brakes \[s\]; `None`: there are none.
    pub brake_closing: Option<f64>,
    /// Posture to which an arm without brakes is taken before its torque is removed \[rad\]; only with
    /// `motion`.
    pub park: Option<Vec<f64>>,
    /// Missed samples that are bridged.
    pub hold_samples: u32,
    /// Missed samples that stop the arm.
    pub stop_samples: u32,
    /// Largest start mismatch \[rad\].
    pub start_mismatch_max: f64,
    /// Length of blends \[s\].
    pub blend: f64,
    /// Requested modes, each with its start time \[s\], ascending; empty: arm, hold, track at once.
    pub requests: Vec<(f64, RequestedMode)>,
}

/// Mode that a list of requests, ascending in time \[s\], requests at a time: that of the latest one until
/// then.
pub fn requested(requests: &[(f64, RequestedMode)], t: f64) -> Option<RequestedMode> {
    requests.iter().rev().find(|(from, _)| *from <= t + 1e-12).map(|(_, mode)| *mode)
}

/// Modes that can be requested of the arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RequestedMode {
    /// No torque.
    Idle,
    /// Get ready.
    Arm,
    /// Hold the pose.
    Hold,
    /// Follow the reference.
    Track,
    /// Safe stop.
    Stop,
}

pub(crate) fn read(
    node: &Node<'_>,
    arm: &StudyArm,
    (duration, form): (f64, Form),
    any: bool,
) -> Result<Option<Box<SupervisorRequest>>, StudyError> {
    if !node.exists() {
        return Ok(None);
    }
    if form == Form::Positions && node.has("start_estimator_factor") {
        let message = "a law from positions has no estimator of its own that could be slower";
        node.note(node.error(Kind::Conflict, "start_estimator_factor", message))?;
    }
    for key in MOTION.into_iter().filter(|key| any && node.has(key)) {
        let message =
            "the reference is a class of motions, whose limits are those of `[reference]`";
        node.note(node.error(Kind::Conflict, key, message))?;
    }
    if !any && node.has("start_imbalance_nm") {
        let message =
            "only the bound for a class of motions counts it: `kind = \"any\"` in `[reference]`";
        node.note(node.error(Kind::Conflict, "start_imbalance_nm", message))?;
    }
    let joints = &arm.joints;
    let some = |key: &str| joints.numbers_if(node, key);
    let velocity = arm.robot.joints.iter().map(|joint| joint.velocity_max);
    let settled = node.number("settled_nm")?;
    let disturbed = node.number_if("disturbed_nm").unwrap_or(f64::INFINITY);
    if disturbed <= settled {
        let message = format!("{disturbed} N·m is not above `settled_nm`, {settled} N·m");
        node.note(node.error(Kind::Conflict, "disturbed_nm", message))?;
    }
    Ok(Some(Box::new(SupervisorRequest {
        velocity_max: limits(node, arm, "velocity_max_rad_s", velocity)?,
        error_stop: some("error_stop_rad")?,
        frozen_travel: some("frozen_travel_rad")?,
        oscillation: some("oscillation_nm")?,
        first_motion: some("first_motion_nm")?,
        dead_zone: some("dead_zone_rad")?,
        soft_zone: soft_zone(node, arm)?,
        braking: node.number("braking_rad_s2")?,
        motion: together(node, arm, MOTION)?,
        reference_box: None,
        funnel: funnel(node, arm)?,
        funnel_decay: node.number("funnel_decay_s")?,
        preset: some("preset_nm")?,
        start_imbalance: some("start_imbalance_nm")?,
        error_bound: None,
        error_bound_stop: node.flag("error_bound_stop")?,
        start_first_order: node.flag("start_first_order")?,
        start_factor: node.number_if("start_estimator_factor"),
        settled,
        disturbed,
        dwell: node.number("dwell_s")?,
        saturation: node.number("saturation_s")?,
        brake_closing: node.number_if("brake_closing_s"),
        park: park(node, arm, any)?,
        hold_samples: node.small_count("hold_samples")?,
        stop_samples: node.small_count("stop_samples")?,
        start_mismatch_max: node.number("start_mismatch_max_rad")?,
        blend: node.number("blend_s")?,
        requests: requests(node, duration)?,
    })))
}

/// Keys of the limits that a reference is shaped to.
const MOTION: [&str; 3] = [
    "reference_velocity_max_rad_s",
    "reference_acceleration_max_rad_s2",
    "reference_jerk_max_rad_s3",
];

/// Keys that make sense together only.
fn together<const K: usize>(
    node: &Node<'_>,
    arm: &StudyArm,
    keys: [&str; K],
) -> Result<Option<[Vec<f64>; K]>, StudyError> {
    if keys.iter().all(|key| !node.has(key)) {
        return Ok(None);
    }
    let mut all = [const { Vec::new() }; K];
    for (values, key) in all.iter_mut().zip(keys) {
        *values = arm.joints.numbers_if(node, key)?.ok_or_else(|| node.missing(key))?;
    }
    Ok(Some(all))
}

fn funnel(node: &Node<'_>, arm: &StudyArm) -> Result<Option<[Vec<f64>; 2]>, StudyError> {
    let keys = ["funnel_initial_rad", "funnel_final_rad"];
    let funnel = together(node, arm, keys)?;
    if let Some([initial, last]) = &funnel
        && let Some(j) = initial.iter().zip(last).position(|(initial, last)| initial < last)
    {
        let (name, initial, last) = (&arm.joints.names[j], initial[j], last[j]);
        let message = format!("joint `{name}`: {initial} rad is below the final {last} rad");
        node.note(node.error(Kind::Conflict, keys[0], message))?;
    }
    Ok(funnel)
}

/// Less than half of each joint's range, and only where every joint has one.
fn soft_zone(node: &Node<'_>, arm: &StudyArm) -> Result<Option<Vec<f64>>, StudyError> {
    let key = "soft_zone_rad";
    let zone = arm.joints.numbers_if(node, key)?;
    for (soft, joint) in zone.iter().flatten().zip(&arm.robot.joints) {
        let Some((lower, upper)) = joint.position else {
            let message = format!("joint `{}` has no limits", joint.name);
            return Err(node.error(Kind::Robot, key, message));
        };
        if *soft >= 0.5 * (upper - lower) {
            let message = format!(
                "{soft} rad is not less than half the range of joint `{}`, {lower} to {upper} rad",
                joint.name
            );
            return Err(node.error(Kind::OutOfRange, key, message));
        }
    }
    Ok(zone)
}

/// Of an arm without brakes, on a way that is shaped.
fn park(node: &Node<'_>, arm: &StudyArm, any: bool) -> Result<Option<Vec<f64>>, StudyError> {
    let Some(key) = ["park_rad", "park"].into_iter().find(|key| node.has(key)) else {
        return Ok(None);
    };
    if node.has("brake_closing_s") {
        let message = "an arm with brakes, `brake_closing_s`, is held by them where it is";
        node.note(node.error(Kind::Conflict, key, message))?;
    }
    let limits = "reference_velocity_max_rad_s";
    if !node.has(limits) && !any {
        let message = format!("the way there needs limits: `{limits}` and the two keys beside it");
        node.note(node.error(Kind::Conflict, key, message))?;
    }
    arm.position(node, "park_rad", "park").map(Some)
}

fn requests(node: &Node<'_>, duration: f64) -> Result<Vec<(f64, RequestedMode)>, StudyError> {
    let mut list: Vec<(f64, RequestedMode)> = Vec::new();
    for request in node.children("request") {
        let t = request.number("t_s")?;
        let last = list.last().map_or(0.0, |(t, _)| *t);
        if t < last || t >= duration {
            let message =
                format!("{t} s is not between {last} s and the end of the run, {duration} s");
            node.note(request.error(Kind::Conflict, "t_s", message))?;
        }
        let mode = match request.word("mode")? {
            "idle" => RequestedMode::Idle,
            "arm" => RequestedMode::Arm,
            "hold" => RequestedMode::Hold,
            "track" => RequestedMode::Track,
            _ => RequestedMode::Stop,
        };
        list.push((t, mode));
    }
    Ok(list)
}
