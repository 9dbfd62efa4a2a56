//! `[design]`: what gains shall be found from.

use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::node::Node;
use crate::per_joint::Joints;
use crate::study::DesignRequest;

pub(crate) fn read(node: &Node<'_>, joints: &Joints) -> Result<DesignRequest, StudyError> {
    let inertia = pair(node, joints, "inertia_low_kg_m2", "inertia_high_kg_m2")?;
    if let Some((low, high)) = &inertia
        && let Some(j) = (0..low.len()).find(|&j| low[j] > high[j])
    {
        let message = format!("{} kg·m² is above inertia_high_kg_m2 = {}", low[j], high[j]);
        let joint = (j, joints.names[j].as_str());
        return Err(node.error_at(Kind::Conflict, "inertia_low_kg_m2", joint, message));
    }
    Ok(DesignRequest {
        orders: orders(node)?,
        payload_max: node.number("payload_max_kg")?,
        inertia,
        window_margin: node.number("window_margin")?,
        modulus_min: node.number("modulus_margin_min")?,
        torque_step_max: joints.numbers_if(node, "torque_step_max_nm")?,
        phi: pair(node, joints, "phi_rate_max_nm_s", "phi_jump_max_nm")?,
        settling_time: node.number_if("settling_time_s"),
    })
}

/// Two per-joint values that come together or not at all.
#[allow(clippy::type_complexity, reason = "a pair of lists, once")]
fn pair(
    node: &Node<'_>,
    joints: &Joints,
    first: &str,
    second: &str,
) -> Result<Option<(Vec<f64>, Vec<f64>)>, StudyError> {
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
