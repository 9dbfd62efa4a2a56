//! Motion of a joint, and its limits.

use roxmltree::Node;

use super::element::Element;
use crate::joint::{Friction, Joint, JointKind};
use crate::whole::{Moves, Result};

/// A travel beyond this is what some exporters write for none \[rad, m\].
const BOUNDLESS: f64 = 1e4;

/// Limits of torque and speed beyond these are what some exporters write for none: far more than any drive of an arm
/// has \[N·m, rad/s\].
const EFFORT_BOUNDLESS: f64 = 1e5;
const VELOCITY_BOUNDLESS: f64 = 1e3;

/// An end of travel further from 0 than this, and a speed beyond this, are rare in rad and common in degrees
/// \[rad, rad/s\].
const TRAVEL_DEGREES: f64 = 6.0 * std::f64::consts::PI;
const SPEED_DEGREES: f64 = 60.0;

/// Swapped limits are read where 0, at which a description is drawn, lies between them, and they are no
/// further apart than this; otherwise their meaning is unknown \[rad, m\].
const SWAPPED_MAX: f64 = 8.0 * std::f64::consts::PI;

/// Motion by the type and a `<mimic>`.
pub(super) fn read_moves(element: &Element<'_, '_>) -> Result<Moves> {
    let kind = match element.text(element.node, "type")? {
        "fixed" => return Ok(Moves::Not),
        "revolute" => JointKind::Revolute,
        "continuous" => JointKind::Continuous,
        "prismatic" => JointKind::Prismatic,
        "floating" => return Ok(Moves::Free("floating")),
        "planar" => return Ok(Moves::Free("planar")),
        "spherical" => return Ok(Moves::Free("spherical")),
        other => {
            return Err(element.error(format!(
                "type \"{other}\" is not read; revolute, continuous, prismatic, fixed, floating, planar and spherical \
                    are"
            )));
        }
    };
    let Some(mimic) = element.child(element.node, "mimic")? else {
        return Ok(Moves::Driven(kind));
    };
    let leader = element.text(mimic, "joint")?.to_owned();
    let factor = element.number_if_any(mimic, "multiplier")?.unwrap_or(1.0);
    let offset = element.number_if_any(mimic, "offset")?.unwrap_or(0.0);
    Ok(Moves::Follows { kind, leader, factor, offset })
}

/// Positions that a joint can be held at, as its limits have it: they are not checked here. `None`: any.
pub(super) fn reach(joint: &Element<'_, '_>, kind: JointKind) -> Option<(f64, f64)> {
    let limit = joint.child(joint.node, "limit").ok().flatten();
    let end = |key| limit.and_then(|node| joint.limit_if_any(node, key).ok().flatten());
    let (low, high) = (end("lower").unwrap_or(0.0), end("upper").unwrap_or(0.0));
    let swapped = low >= 0.0 && high <= 0.0;
    let (low, high) = if swapped { (high, low) } else { (low, high) };
    (kind != JointKind::Continuous && low < high).then_some((low, high))
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
    let number = |key| Ok(joint.limit_if_any(limit, key)?.unwrap_or(0.0));
    let (mut low, mut high) = (number("lower")?, number("upper")?);
    let none = low == 0.0 && high == 0.0;
    if low >= 0.0 && high <= 0.0 && low > high && low - high <= SWAPPED_MAX {
        joint.note(&format!(
            "limits {low} … {high} stand the wrong way round and are read as {high} … {low}; Bullet takes such a joint \
                for one without ends"
        ));
        (low, high) = (high, low);
    }
    if low >= high && (slides || !none) {
        return Err(joint.error(format!("lower limit {low} must be below upper {high}")));
    }
    if !none && high - low <= BOUNDLESS {
        if !slides && low.abs().max(high.abs()) > TRAVEL_DEGREES {
            let (least, most) = (low.to_radians(), high.to_radians());
            joint.note(&format!(
                "limits {low} … {high} rad are {:.1} turns; if they are degrees, write lower=\"{least:.6}\" \
                    upper=\"{most:.6}\"",
                (high - low) / std::f64::consts::TAU
            ));
        }
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
        format!(
            "limits {low} … {high} are read as none: the joint turns without end (type continuous)"
        )
    };
    warnings.push(format!("joint \"{}\": {why}", joint.name));
    Ok(None)
}

/// A limit of torque or speed; `None` where there is none, or somebody meant none.
fn positive(
    joint: &Element<'_, '_>,
    (key, stated): (&str, Option<f64>),
    boundless: f64,
    warnings: &mut Vec<String>,
) -> Result<Option<f64>> {
    let Some(limit) = stated.filter(|limit| *limit > 0.0 && *limit <= boundless) else {
        let how = match stated {
            None => return Ok(None),
            Some(x) if x > boundless => format!("{key} limit {x:e}, beyond {boundless:e},"),
            Some(x) if x < 0.0 && x.is_finite() && (x + 1.0).abs() > 0.0 => {
                return Err(joint.error(format!(
                    "<limit {key}=\"{x}\"> must not be negative; where there is none, leave it out or write 0 or -1"
                )));
            }
            Some(x) => format!("{key} limit {x}"),
        };
        warnings.push(format!("joint \"{}\": {how} is read as none", joint.name));
        return Ok(None);
    };
    Ok(Some(limit))
}

/// Limits and friction of a joint that is driven.
pub(super) fn read_limits(
    joint: &Element<'_, '_>,
    kind: JointKind,
    warnings: &mut Vec<String>,
) -> Result<Joint> {
    let limit = joint.child(joint.node, "limit")?;
    let number = |key| limit.map_or(Ok(None), |node| joint.limit_if_any(node, key));
    let position = match kind {
        JointKind::Continuous => None,
        _ => read_travel(joint, (kind, limit), warnings)?,
    };
    let kind = if position.is_none() { JointKind::Continuous } else { kind };
    let torque_max = positive(joint, ("effort", number("effort")?), EFFORT_BOUNDLESS, warnings)?;
    let velocity = ("velocity", number("velocity")?);
    let velocity_max = positive(joint, velocity, VELOCITY_BOUNDLESS, warnings)?;
    if let Some(speed) = velocity_max.filter(|v| *v > SPEED_DEGREES)
        && kind != JointKind::Prismatic
    {
        let degrees = speed.to_radians();
        joint.note(&format!(
            "a largest speed of {speed} rad/s; if it is degrees per second, write velocity=\"{degrees:.6}\""
        ));
    }
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
