//! `[design]`: what gains shall be found from.

use crate::arm::StudyArm;
use crate::base::Base;
use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::node::Node;
use crate::payload_set;
use crate::per_joint::Joints;
use crate::study::{DesignMethod, DesignRequest, InertiaSource, PaperRequest, PhiSource, World};

/// Reads `[design]`; the trace it names is relative to `base`.
pub(crate) fn read(
    node: &Node<'_>,
    (arm, world): (&StudyArm, &World),
    base: Base<'_>,
) -> Result<DesignRequest, StudyError> {
    let (joints, found) = (&arm.joints, node.source.found);
    Ok(DesignRequest {
        method: match node.word("method")? {
            "paper" => DesignMethod::Paper,
            _ => DesignMethod::Ours,
        },
        orders: orders(node)?,
        innovation_filter: node.flag("innovation_filter")?,
        payload: payload_set::read(node, arm, world.payload.as_ref())?,
        coulomb: found.keep(coulomb(node, arm, world))?.unwrap_or_default(),
        inertia: found.keep(inertia(node, arm, base))?.unwrap_or(InertiaSource::Robot),
        window_margin: node.number("window_margin")?,
        modulus_min: node.number("modulus_margin_min")?,
        torque_step_max: joints.numbers_if(node, "torque_step_max_nm")?,
        phi: found.keep(phi(node, arm, base))?.unwrap_or(PhiSource::Reference),
        phi_margin: node.number("phi_margin")?,
        settling_time: node.number_if("settling_time_s"),
        rise_time: node.number_if("rise_time_s"),
        paper: paper(&node.child("paper"), joints)?,
    })
}

/// The interval of each joint's dry friction; the world's level is inside.
fn coulomb(
    node: &Node<'_>,
    arm: &StudyArm,
    world: &World,
) -> Result<(Vec<f64>, Vec<f64>), StudyError> {
    let (first, second) = ("coulomb_min_nm", "coulomb_max_nm");
    let own =
        |j: usize| if world.robot_friction { arm.robot.joints[j].friction.coulomb } else { 0.0 };
    let level: Vec<f64> =
        world.extra_coulomb.iter().enumerate().map(|(j, extra)| own(j) + extra).collect();
    // What the arm's own file says, with what the world adds.
    let end = |of: &dyn Fn((f64, f64)) -> f64, otherwise: &dyn Fn(usize) -> f64| -> Vec<f64> {
        let known =
            |j: usize| arm.robot.joints[j].friction.coulomb_range.filter(|_| world.robot_friction);
        let extra = world.extra_coulomb.iter().enumerate();
        extra.map(|(j, extra)| known(j).map_or(otherwise(j), |range| of(range) + extra)).collect()
    };
    let low = match arm.joints.numbers_if(node, first)? {
        Some(low) => low,
        None => end(&|range| range.0, &|_| 0.0),
    };
    let high = match arm.joints.numbers_if(node, second)? {
        Some(high) => high,
        None => end(&|range| range.1, &|j| level[j]),
    };
    for (j, name) in arm.joints.names.iter().enumerate() {
        let refuse = |key, end: f64, valid: &str| {
            let message = format!(
                "joint `{name}`: {end} N·m, while the world's dry friction is {} N·m",
                level[j]
            );
            node.error_at(Kind::Conflict, key, (j, name), message)
                .with_help(format!("valid: {valid} {} N·m", level[j]))
        };
        if low[j] > level[j] {
            return Err(refuse(first, low[j], "at most"));
        }
        if high[j] < level[j] {
            return Err(refuse(second, high[j], "at least"));
        }
    }
    Ok((low, high))
}

fn inertia(node: &Node<'_>, arm: &StudyArm, base: Base<'_>) -> Result<InertiaSource, StudyError> {
    let joints = &arm.joints;
    let (first, second) = ("inertia_low_kg_m2", "inertia_high_kg_m2");
    let typed = pair(node, joints, first, second)?;
    if let Some((low, high)) = &typed
        && let Some(j) = (0..low.len()).find(|&j| low[j] > high[j])
    {
        let message = format!("{} kg·m² is above {second} = {}", low[j], high[j]);
        let joint = (j, joints.names[j].as_str());
        return Err(node.error_at(Kind::Conflict, first, joint, message));
    }
    match (node.text("inertia_from"), typed.or_else(|| Some(arm.stated.as_ref()?.inertia.clone())))
    {
        (None | Some("typed"), Some((low, high))) => Ok(InertiaSource::Typed { low, high }),
        (Some("typed"), None) => Err(node.missing(first)),
        (Some(word), Some(_)) => Err(unused(node, first, "inertia_from", word)),
        (Some("trace"), None) => Ok(InertiaSource::Trace(trace(node, base)?)),
        (_, None) => Ok(InertiaSource::Robot),
    }
}

fn phi(node: &Node<'_>, arm: &StudyArm, base: Base<'_>) -> Result<PhiSource, StudyError> {
    let joints = &arm.joints;
    let (first, second) = ("phi_rate_max_nm_s", "phi_jump_max_nm");
    let typed = pair(node, joints, first, second)?;
    match (node.text("phi_from"), typed.or_else(|| Some(arm.stated.as_ref()?.phi.clone()))) {
        (None | Some("typed"), Some((rate, jump))) => Ok(PhiSource::Typed { rate, jump }),
        (Some("typed"), None) => Err(node.missing(first)),
        (Some(word), Some(_)) => Err(unused(node, first, "phi_from", word)),
        (Some("trace"), None) => Ok(PhiSource::Trace(trace(node, base)?)),
        (Some("simulation"), None) => Ok(PhiSource::Simulation),
        (_, None) => Ok(PhiSource::Reference),
    }
}

fn trace(node: &Node<'_>, base: Base<'_>) -> Result<std::path::PathBuf, StudyError> {
    Ok(base.join(node.word("trace")?))
}

/// A typed value that another source makes void.
fn unused(node: &Node<'_>, key: &str, source: &str, word: &str) -> StudyError {
    node.error(Kind::Conflict, key, format!("typed, while {source} is \"{word}\""))
        .with_help("keep one of them")
}

fn paper(node: &Node<'_>, joints: &Joints) -> Result<PaperRequest, StudyError> {
    let (feedback, by_40) = (node.flag("feedback")?, node.word("minimum_by")? == "40");
    if feedback && by_40 {
        let message = "true, while minimum_by is \"40\": (40) has that term already";
        return Err(node.error(Kind::Conflict, "feedback", message).with_help("keep one of them"));
    }
    Ok(PaperRequest {
        phi_max: joints.numbers_if(node, "phi_max")?,
        per_joint: node.flag("per_joint")?,
        by_40,
        integrals_max: node.list("integrals_max").unwrap_or_default(),
        feedback,
        damping: node.number("damping")?,
        estimator_factor: node.number("estimator_factor")?,
        inertia: joints.numbers(node, "inertia_kg_m2")?,
    })
}

/// Two values of each joint.
type ValuePair = (Vec<f64>, Vec<f64>);

/// Two per-joint values that come together or not at all.
fn pair(
    node: &Node<'_>,
    joints: &Joints,
    first: &str,
    second: &str,
) -> Result<Option<ValuePair>, StudyError> {
    match (joints.numbers_if(node, first)?, joints.numbers_if(node, second)?) {
        (Some(a), Some(b)) => Ok(Some((a, b))),
        (None, None) => Ok(None),
        (Some(_), None) => Err(node.missing(second)),
        (None, Some(_)) => Err(node.missing(first)),
    }
}

/// Orders, each once, ascending.
fn orders(node: &Node<'_>) -> Result<Vec<usize>, StudyError> {
    let asked = node.list("orders").unwrap_or_else(|| vec![1.0, 2.0]);
    let orders: Vec<usize> = (1..=4_u8)
        .filter(|m| asked.iter().any(|a| (a - f64::from(*m)).abs() < 0.5))
        .map(usize::from)
        .collect();
    if orders.is_empty() {
        return Err(node.error(Kind::OutOfRange, "orders", "no order to try").with_help("1 to 4"));
    }
    Ok(orders)
}
