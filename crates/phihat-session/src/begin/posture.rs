//! Posture in which gravity loads an arm little.

use core::f64::consts::PI;

use phihat_model::{Body, Joint, JointKind, Robot, Workspace, evenly};

use crate::error::SessionError;

/// Share of a torque limit that holding the arm may take, for a posture to be taken at once, and at most.
const EASY: f64 = 0.35;
const MOST: f64 = 0.7;

/// Postures that are looked at.
const TRIED: u32 = 400;

/// Share of a joint's travel, about its middle, in which it stands.
const INSIDE: f64 = 0.6;

/// Ends of travel \[rad, m\] that a posture may use: a turn at most.
pub(super) fn travel(joint: &Joint) -> (f64, f64) {
    let (low, high) = joint.position.unwrap_or((-PI, PI));
    if joint.kind != JointKind::Prismatic && high - low > 2.0 * PI {
        let middle = if low <= 0.0 && 0.0 <= high { 0.0 } else { 0.5 * (low + high) };
        return ((middle - PI).max(low), (middle + PI).min(high));
    }
    (low, high)
}

/// A posture well inside the travel at which holding the arm takes little of its torque: the middle, else one
/// near zero, else the best of some hundred.
pub(super) struct Easy {
    /// Positions \[rad, m\], to three digits after the point.
    pub(super) posture: Vec<f64>,
    /// Why the drives cannot hold the arm there, and so nowhere that was looked at.
    pub(super) unheld: Option<String>,
}

/// Finds the posture about which an arm moves, see [`Easy`].
///
/// # Errors
///
/// [`SessionError`]: the arm has no joints.
pub(super) fn easy_posture(robot: &Robot, payload_kg: f64) -> Result<Easy, SessionError> {
    let body = Body { mass: payload_kg, com: [0.0; 3], inertia: [0.0; 6] };
    let bare = robot.plant_model();
    let model = match bare.clone().with_payload_on(&robot.tip, &body) {
        Ok(loaded) if payload_kg > 0.0 => loaded,
        _ => bare,
    };
    let mut workspace = Workspace::new(&model);
    let ends: Vec<(f64, f64)> = robot.joints.iter().map(inside).collect();
    let mut needed = |q: &[f64]| -> (f64, usize, f64) {
        let mut tau = vec![0.0; q.len()];
        model.gravity_torque(&mut workspace, q, &mut tau);
        let mut worst = (0.0, 0, 0.0);
        for (i, joint) in robot.joints.iter().enumerate() {
            let share = tau[i].abs() / joint.torque_max.unwrap_or(f64::INFINITY);
            if share > worst.0 {
                worst = (share, i, tau[i].abs());
            }
        }
        worst
    };
    let zero: Vec<f64> = ends.iter().map(|(low, high)| 0.0_f64.clamp(*low, *high)).collect();
    let middle: Vec<f64> = ends.iter().map(|(low, high)| 0.5 * (low + high)).collect();
    let mut best: Option<(f64, usize, f64, Vec<f64>)> = None;
    for q in [middle, zero].into_iter().chain(evenly(&ends, TRIED)) {
        let (share, joint, torque) = needed(&q);
        if best.as_ref().is_none_or(|best| share < best.0) {
            best = Some((share, joint, torque, q));
        }
        if best.as_ref().is_some_and(|best| best.0 <= EASY) {
            break;
        }
    }
    let (share, joint, torque, q) =
        best.ok_or_else(|| SessionError::other("the arm has no joints"))?;
    let unheld = (share > MOST).then(|| {
        let joint = &robot.joints[joint];
        let limit = joint.torque_max.unwrap_or(f64::INFINITY);
        let unit = unit(joint);
        format!(
            "the arm cannot hold itself: at the easiest of {TRIED} postures ({q:.2?}) gravity takes {torque:.3} {unit} \
             of joint {}, whose limit is {limit} {unit}: state the drives' limits with --torque-max, a lighter \
             --payload, or a chain of stronger joints with --base and --tip",
            joint.name
        )
    });
    let posture = q.into_iter().map(|x| (x * 1e3).round() / 1e3).collect();
    Ok(Easy { posture, unheld })
}

/// Of what a joint's drive gives.
pub(super) fn unit(joint: &Joint) -> &'static str {
    if joint.kind == JointKind::Prismatic { "N" } else { "N·m" }
}

/// The part of a joint's travel in which it may stand.
fn inside(joint: &Joint) -> (f64, f64) {
    let (low, high) = travel(joint);
    let (middle, half) = (0.5 * (low + high), 0.5 * INSIDE * (high - low));
    (middle - half, middle + half)
}
