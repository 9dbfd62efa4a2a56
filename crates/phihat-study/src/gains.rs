//! `[gains]`: the law by bandwidths or by coefficients, never both.

use std::f64::consts::PI;

use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::node::Node;
use crate::per_joint::Joints;
use crate::study::{GainsRequest, LawRequest};

const BANDWIDTHS: [&str; 6] = [
    "bandwidth_rad_s",
    "estimator_bandwidth_rad_s",
    "order",
    "damping",
    "estimator_damping",
    "torque_bandwidth_hz",
];
const COEFFICIENTS: [&str; 3] = ["kp_per_s2", "kd_per_s", "a"];

pub(crate) fn read(
    node: &Node<'_>,
    joints: &Joints,
    rate: f64,
) -> Result<GainsRequest, StudyError> {
    let inertia = joints.numbers(node, "inertia_kg_m2")?;
    let coefficient = COEFFICIENTS.into_iter().find(|key| node.has(key));
    let bandwidth = BANDWIDTHS.into_iter().find(|key| node.has(key));
    let law = match (bandwidth, coefficient) {
        (Some(one), Some(other)) => return Err(mixed(node, one, other)),
        (None, Some(_)) => by_coefficients(node, joints)?,
        (Some(_), None) => by_bandwidths(node, joints, rate)?,
        (None, None) => {
            let help = "give `bandwidth_rad_s` and `estimator_bandwidth_rad_s`, or `kp_per_s2`, \
                        `kd_per_s` and `a`";
            return Err(node.missing("bandwidth_rad_s").with_help(help));
        }
    };
    Ok(GainsRequest { inertia, law })
}

fn mixed(node: &Node<'_>, one: &str, other: &str) -> StudyError {
    let start = |key: &str| node.value(key).map_or(0, |value| value.span().start);
    let (first, second) = if start(one) < start(other) { (one, other) } else { (other, one) };
    node.error(Kind::Conflict, second, format!("cannot be mixed with `{first}`"))
        .with_help("state the law by bandwidths or by coefficients")
}

fn by_bandwidths(node: &Node<'_>, joints: &Joints, rate: f64) -> Result<LawRequest, StudyError> {
    let orders = joints.counts(node, "order")?;
    Ok(LawRequest::Bandwidths {
        order: orders.into_iter().filter_map(|m| usize::try_from(m).ok()).collect(),
        bandwidth: below_nyquist(node, joints, "bandwidth_rad_s", rate)?,
        damping: joints.numbers(node, "damping")?,
        estimator_bandwidth: below_nyquist(node, joints, "estimator_bandwidth_rad_s", rate)?,
        estimator_damping: joints.numbers(node, "estimator_damping")?,
        torque_bandwidth: joints.numbers_if(node, "torque_bandwidth_hz")?,
    })
}

fn by_coefficients(node: &Node<'_>, joints: &Joints) -> Result<LawRequest, StudyError> {
    Ok(LawRequest::Coefficients {
        kp: joints.numbers(node, "kp_per_s2")?,
        kd: joints.numbers(node, "kd_per_s")?,
        a: node.list("a").ok_or_else(|| node.missing("a"))?,
    })
}

/// No sampled loop has a bandwidth at or above π/T.
fn below_nyquist(
    node: &Node<'_>,
    joints: &Joints,
    key: &str,
    rate: f64,
) -> Result<Vec<f64>, StudyError> {
    let bandwidths = joints.numbers(node, key)?;
    let limit = PI * rate;
    if let Some(j) = bandwidths.iter().position(|&bandwidth| bandwidth >= limit) {
        let (name, value) = (joints.names[j].as_str(), bandwidths[j]);
        let message = format!("{value} rad/s is not below π·rate = {limit:.0} rad/s");
        return Err(node.error_at(Kind::OutOfRange, key, (j, name), message).with_help(format!(
            "a loop at {rate} Hz cannot do that; useful values are far below"
        )));
    }
    Ok(bandwidths)
}
