//! Motion of a joint, and its limits.

use roxmltree::Node;

use super::Result;
use super::element::Element;
use crate::joint::{Friction, Joint, JointKind};

/// A limit beyond this is what some exporters write for none \[rad, m, rad/s, N·m\].
const BOUNDLESS: f64 = 1e9;

/// Swapped limits are read where 0, at which a description is drawn, lies between them, and they are no
/// further apart than this; otherwise their meaning is unknown \[rad, m\].
const SWAPPED_MAX: f64 = 8.0 * std::f64::consts::PI;

/// Motion of a joint in its element.
#[derive(Debug, Clone, Copy)]
pub(super) enum Moves<'a> {
    /// Fixed.
    Not,
    /// By a drive of its own.
    Driven(JointKind),
    /// With another joint: `factor` times its position, and `offset` \[rad, m\].
    Follows { kind: JointKind, leader: &'a str, factor: f64, offset: f64 },
    /// In more ways than one drive serves: a floating, planar or spherical joint.
    Free(&'a str),
}

/// Motion by the type and a `<mimic>`.
pub(super) fn read_moves<'a>(element: &Element<'a, '_>) -> Result<Moves<'a>> {
    let kind = match element.text(element.node, "type")? {
        "fixed" => return Ok(Moves::Not),
        "revolute" => JointKind::Revolute,
        "continuous" => JointKind::Continuous,
        "prismatic" => JointKind::Prismatic,
        free @ ("floating" | "planar" | "spherical") => return Ok(Moves::Free(free)),
        other => {
            return Err(element.error(format!(
                "type \"{other}\" is not read; revolute, continuous, prismatic, fixed, floating, planar and spherical are"
            )));
        }
    };
    let Some(mimic) = element.child(element.node, "mimic")? else {
        return Ok(Moves::Driven(kind));
    };
    let leader = element.text(mimic, "joint")?;
    let factor = element.number_if_any(mimic, "multiplier")?.unwrap_or(1.0);
    let offset = element.number_if_any(mimic, "offset")?.unwrap_or(0.0);
    Ok(Moves::Follows { kind, leader, factor, offset })
}

/// Position of a joint that is not driven, as near to `wanted` as its limits permit: the limits are not
/// checked here.
pub(super) fn nearest(joint: &Element<'_, '_>, kind: JointKind, wanted: f64) -> f64 {
    let limit = joint.child(joint.node, "limit").ok().flatten();
    let end = |key| limit.and_then(|node| joint.number_if_any(node, key).ok().flatten());
    let (low, high) = (end("lower").unwrap_or(0.0), end("upper").unwrap_or(0.0));
    let swapped = low >= 0.0 && high <= 0.0;
    let (low, high) = if swapped { (high, low) } else { (low, high) };
    if kind == JointKind::Continuous || low >= high { wanted } else { wanted.clamp(low, high) }
}

/// Ends of travel; `None` where there are none, or they are such that somebody meant none.
fn read_travel<'a, 'x>(
    joint: &Element<'a, 'x>,
    (kind, limit): (JointKind, Option<Node<'a, 'x>>),
    warnings: &mut Vec<String>,
) -> Result<Option<(f64, f64)>> {
    let slides = kind == JointKind::Prismatic;
    let Some(limit) = limit else {
        let why = if slides {
            "it has no <limit>: state its travel in metres, lower and upper"
        } else {
            "it has no <limit>: state lower and upper in rad, or make it continuous"
        };
        return Err(joint.error(why.to_owned()));
    };
    let number = |key| Ok(joint.number_if_any(limit, key)?.unwrap_or(0.0));
    let (mut low, mut high) = (number("lower")?, number("upper")?);
    let none = low == 0.0 && high == 0.0;
    if low >= 0.0 && high <= 0.0 && low > high && low - high <= SWAPPED_MAX {
        joint.note(&format!(
            "limits {low} … {high} stand the wrong way round and are read as {high} … {low}; Bullet takes such a joint for one without ends"
        ));
        (low, high) = (high, low);
    }
    if low >= high && (slides || !none) {
        return Err(joint.error(format!("lower limit {low} must be below upper {high}")));
    }
    if !none && high - low <= BOUNDLESS {
        return Ok(Some((low, high)));
    }
    if slides {
        let why = "leave a sliding joint without ends: state its travel in metres";
        return Err(joint.error(format!("limits {low} … {high} {why}")));
    }
    let why = if none {
        "limits 0 … 0 are read as none: the joint turns without end (type continuous); state them if it does not"
            .to_owned()
    } else {
        format!("a travel beyond {BOUNDLESS:e} is read as none: the joint turns without end")
    };
    warnings.push(format!("joint \"{}\": {why}", joint.name));
    Ok(None)
}

/// Limits and friction of a joint that is driven.
pub(super) fn read_limits(
    joint: &Element<'_, '_>,
    kind: JointKind,
    warnings: &mut Vec<String>,
) -> Result<Joint> {
    let limit = joint.child(joint.node, "limit")?;
    let number = |key| limit.map_or(Ok(None), |node| joint.number_if_any(node, key));
    let position = match kind {
        JointKind::Continuous => None,
        _ => read_travel(joint, (kind, limit), warnings)?,
    };
    let kind = if position.is_none() { JointKind::Continuous } else { kind };
    let mut positive = |key| match number(key)? {
        Some(x) if x < 0.0 => {
            Err(joint.error(format!("<limit {key}=\"{x}\"> must not be negative")))
        }
        Some(x) if x > BOUNDLESS => {
            let why = format!("{key} limit beyond {BOUNDLESS:e} is read as none");
            warnings.push(format!("joint \"{}\": a {why}", joint.name));
            Ok(None)
        }
        Some(x) if x > 0.0 => Ok(Some(x)),
        Some(_) => {
            warnings.push(format!("joint \"{}\": {key} limit 0 is read as none", joint.name));
            Ok(None)
        }
        None => Ok(None),
    };
    let (torque_max, velocity_max) = (positive("effort")?, positive("velocity")?);
    let dynamics = joint.child(joint.node, "dynamics")?;
    let dissipation = |key| {
        let value = dynamics.map_or(Ok(None), |node| joint.number_if_any(node, key))?;
        let value = value.unwrap_or(0.0);
        if value < 0.0 {
            return Err(joint.error(format!("<dynamics {key}=\"{value}\"> must not be negative")));
        }
        Ok(value)
    };
    let (viscous, coulomb) = (dissipation("damping")?, dissipation("friction")?);
    Ok(Joint {
        name: joint.name.to_owned(),
        kind,
        position,
        velocity_max,
        torque_max,
        torque_rate_max: None,
        armature: 0.0,
        armature_range: None,
        friction: Friction { viscous, coulomb, coulomb_range: None, sigmoid: None },
        drive_bandwidth_hz: None,
        spring: None,
        encoder_bits: None,
    })
}
