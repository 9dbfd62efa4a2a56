//! Torque limits that an arm's description leaves out, or has a placeholder for, assumed.

use std::path::Path;

use phihat_certificate::extremes::Extremes as _;
use phihat_model::{Body, Joint, JointKind, Robot, SPEED_ASSUMED, Workspace, evenly};
use phihat_synthesis::digits;

use super::posture::travel;
use crate::error::SessionError;

/// Postures that are looked at.
const TRIED: u32 = 100;

/// Times what gravity takes at most.
const HOLDING: f64 = 2.0;

/// In which a joint reaches its speed \[s\].
const SPEEDING_UP: f64 = 0.25;

/// Speeds that are counted at most \[rad/s\], \[m/s\].
const TURNING: f64 = SPEED_ASSUMED;
const SLIDING: f64 = 0.5;

/// Least limits \[N·m\], \[N\].
const LEAST: f64 = 0.1;

/// A limit of so much \[N·m, N\] that is so many times the torque which the arm needs of the joint is a
/// placeholder: 1000 N·m on a finger.
const PLACEHOLDER: (f64, f64) = (500.0, 100.0);

/// Source of the torque limits, as the arm's file states it.
const SOURCE: &str = "assumption where the URDF has no limit, or 500 N m and more of which the arm needs less than a \
    hundredth: twice what gravity takes of the joint at most, and what brings its heaviest inertia to full speed in \
    0.25 s; the drive's data sheet has it";

/// Gives each joint without a torque limit, or with one that is a [`PLACEHOLDER`], the limit of a sufficient
/// drive, and reports which; `None`: all have one.
///
/// Over [`TRIED`] postures and with the payload, `τ = 2 max|g_i| + max M_ii ω / 0.25 s`, rounded up to two
/// digits, where `ω` is the joint's speed limit, at most π rad/s or 0.5 m/s.
///
/// # Errors
///
/// [`SessionError`]: that is more than a study can state; the description is no arm's.
pub(super) fn assume(
    robot: &mut Robot,
    payload_kg: f64,
    arm: &str,
) -> Result<Option<String>, SessionError> {
    let stated = |joint: &Joint| joint.torque_max.is_some_and(|limit| limit < PLACEHOLDER.0);
    if robot.joints.iter().all(stated) {
        return Ok(None);
    }
    let body = Body { mass: payload_kg, com: [0.0; 3], inertia: [0.0; 6] };
    let bare = robot.plant_model();
    let model = match bare.clone().with_payload_on(&robot.tip, &body) {
        Ok(loaded) if payload_kg > 0.0 => loaded,
        _ => bare,
    };
    let (n, mut workspace) = (robot.joints.len(), Workspace::new(&model));
    let (mut gravity, mut inertia) = (vec![0.0; n], vec![0.0; n]);
    let (mut tau, mut mass) = (vec![0.0; n], vec![0.0; n * n]);
    let ends: Vec<(f64, f64)> = robot.joints.iter().map(travel).collect();
    for q in evenly(&ends, TRIED) {
        model.gravity_torque(&mut workspace, &q, &mut tau);
        model.mass_matrix(&mut workspace, &q, &mut mass);
        for i in 0..n {
            gravity[i] = [gravity[i], tau[i].abs()].into_iter().largest();
            inertia[i] = [inertia[i], mass[i * n + i]].into_iter().largest();
        }
    }
    let mut told = Vec::new();
    for (i, joint) in robot.joints.iter_mut().enumerate() {
        let slides = joint.kind == JointKind::Prismatic;
        let most = if slides { SLIDING } else { TURNING };
        let speed = joint.velocity_max.unwrap_or(most).min(most);
        let needed = HOLDING * gravity[i] + inertia[i] * speed / SPEEDING_UP;
        let limit = digits::up(needed.max(LEAST), 2);
        let own = joint.torque_max;
        if own.is_some_and(|own| own < PLACEHOLDER.0 || own < PLACEHOLDER.1 * limit) {
            continue;
        }
        if !limit.is_finite() || limit > MOST {
            let why = format!(
                "no torque limit is stated for {}, and one of {limit:e} would have to be assumed: state it with \
                 --torque-max, as in the drives' data sheet",
                joint.name
            );
            return Err(SessionError::at(Path::new(arm), why));
        }
        joint.torque_max = Some(limit);
        let (name, unit) = (&joint.name, if slides { "N" } else { "N·m" });
        told.push(match own {
            Some(own) => format!("{name} {limit} {unit} in place of {own}"),
            None => format!("{name} {limit} {unit}"),
        });
    }
    if told.is_empty() {
        return Ok(None);
    }
    robot.sources.insert("limits".to_owned(), SOURCE.to_owned());
    Ok(Some(format!(
        "no torque limit is stated for {} of {n} joints, or a placeholder, and this is an assumption: {}. State the \
         drives' own with --torque-max: rotor inertia and friction are estimated from it",
        told.len(),
        told.join(", ")
    )))
}

/// The most that a study can state \[N·m\].
const MOST: f64 = 1e5;
