//! `[spec]`

use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::node::Node;
use crate::per_joint::Joints;
use crate::study::Spec;

pub(crate) fn read(node: &Node<'_>, joints: &Joints, duration: f64) -> Result<Spec, StudyError> {
    let settle = node.number("settle_s")?;
    if settle >= duration {
        let message = format!("{settle} s is not before the end of the run at {duration} s");
        node.note(
            node.error(Kind::Conflict, "settle_s", message)
                .with_help("the bounds hold from settle_s on: make it smaller than duration_s"),
        )?;
    }
    Ok(Spec {
        settle,
        settle_stated: node.has("settle_s"),
        error_bound: joints.numbers_if(node, "error_bound_rad")?,
        error_integral_bound: joints.numbers_if(node, "error_integral_bound_rad_s")?,
        velocity_error_bound: joints.numbers_if(node, "velocity_error_bound_rad_s")?,
        tip_error_bound: node.number_if("tip_error_bound_mm").map(|mm| mm * 1e-3),
    })
}
