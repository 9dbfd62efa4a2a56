//! A closed curve in space that a frame's origin follows.

use crate::arm::StudyArm;
use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::node::Node;
use crate::study::{Curve, ReferenceRequest};

/// Points nearer than this are the same \[m\].
const SAME_POINT: f64 = 1e-9;

pub(crate) fn read(node: &Node<'_>, arm: &StudyArm) -> Result<ReferenceRequest, StudyError> {
    let hold_orientation = node.flag("hold_orientation")?;
    let joints = arm.joints.count();
    if hold_orientation && joints < 6 {
        let message = format!("holding an orientation needs 6 joints, the robot has {joints}");
        return Err(node.error(Kind::Conflict, "hold_orientation", message));
    }
    Ok(ReferenceRequest::Cartesian {
        frame: arm.frame(node, "frame")?,
        curve: if node.has("points_m") { spline(node)? } else { circle(node)? },
        period: node.number("period_s")?,
        fade_in: node.number("fade_in_s")?,
        hold_orientation,
        seed: arm.position(node, "seed_rad", "seed")?,
    })
}

fn circle(node: &Node<'_>) -> Result<Curve, StudyError> {
    let normal: [f64; 3] = node.numbers("normal")?;
    let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length < SAME_POINT {
        return Err(node.error(Kind::OutOfRange, "normal", "the normal has no direction"));
    }
    Ok(Curve::Circle {
        center: node.numbers("center_m")?,
        radius: node.number("radius_m")?,
        normal: normal.map(|x| x / length),
    })
}

fn spline(node: &Node<'_>) -> Result<Curve, StudyError> {
    let points = node.points("points_m")?;
    let same =
        |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < SAME_POINT);
    if let Some(i) = (1..points.len()).find(|&i| same(&points[i - 1], &points[i])) {
        let message = format!("point {} repeats the one before it", i + 1);
        return Err(node.error_at(Kind::Conflict, "points_m", (i, ""), message));
    }
    let last = points.len().saturating_sub(1);
    if same(&points[0], &points[last]) {
        let message = "the last point repeats the first: the curve closes by itself";
        return Err(node.error_at(Kind::Conflict, "points_m", (last, ""), message));
    }
    Ok(Curve::Spline { points })
}
