//! `[world.payload]`: a rigid body, and whether its inertia is that of one.

use phihat_model::Body;

use crate::arm::StudyArm;
use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::node::Node;

/// `[world.payload]`: a rigid body welded to a frame of the robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Payload {
    /// Frame (link) name.
    pub frame: String,
    /// Mass \[kg\].
    pub mass: f64,
    /// Centre of mass \[m\] in that frame.
    pub com: [f64; 3],
    /// Inertia about the centre of mass `xx, xy, xz, yy, yz, zz` \[kg·m²\].
    pub inertia: [f64; 6],
    /// When it is picked up \[s\].
    pub start: f64,
    /// When it is dropped \[s\]; infinite: never.
    pub end: f64,
}

impl Payload {
    /// The body itself, in the axes of its frame.
    pub fn body(&self) -> Body {
        Body { mass: self.mass, com: self.com, inertia: self.inertia }
    }
}

pub(crate) fn read(node: &Node<'_>, arm: &StudyArm) -> Result<Option<Payload>, StudyError> {
    if !node.exists() {
        return Ok(None);
    }
    let inertia = node.numbers("inertia_kg_m2")?;
    if !is_physical(inertia) {
        let message = "no rigid body has this inertia: a principal moment is negative or above \
                       the sum of the other two";
        node.note(
            node.error(Kind::OutOfRange, "inertia_kg_m2", message)
                .with_help("the order is [xx, xy, xz, yy, yz, zz], about the centre of mass"),
        )?;
    }
    let (start, end) = (node.number("start_s")?, node.number_if("end_s").unwrap_or(f64::INFINITY));
    if end <= start {
        let message =
            format!("dropped at {end} s, which is not after it is picked up at {start} s");
        return Err(node.error(Kind::Conflict, "end_s", message));
    }
    Ok(Some(Payload {
        frame: arm.moved_frame(node, "frame")?,
        mass: node.number("mass_kg")?,
        com: node.numbers("com_m")?,
        inertia,
        start,
        end,
    }))
}

/// Returns true if `Σ = ½ tr(I)·1 − I`, the second moment of the mass, is positive semidefinite.
///
/// Its eigenvalues are half of what the triangle inequality of the principal moments asks to be
/// non-negative. A symmetric matrix is semidefinite iff all its principal minors are non-negative;
/// the slack admits figures that were rounded when they were written down.
fn is_physical([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> bool {
    let half_trace = 0.5 * (xx + yy + zz);
    let (a, b, c) = (half_trace - xx, half_trace - yy, half_trace - zz);
    let slack = 1e-6 * half_trace.abs();
    let minors = [a * b - xy * xy, a * c - xz * xz, b * c - yz * yz];
    let determinant = a * (b * c - yz * yz) - xy * (xy * c + yz * xz) - xz * (xy * yz + b * xz);
    [a, b, c].iter().all(|&x| x >= -slack)
        && minors.iter().all(|&x| x >= -slack * half_trace.abs())
        && determinant >= -slack * half_trace * half_trace
}

#[cfg(test)]
mod tests {
    use super::is_physical;

    /// Moment of inertia of point masses about the origin.
    fn points(masses: &[(f64, [f64; 3])]) -> [f64; 6] {
        let mut inertia = [0.0; 6];
        for &(m, [x, y, z]) in masses {
            let of_one = [y * y + z * z, -x * y, -x * z, x * x + z * z, -y * z, x * x + y * y];
            for (sum, term) in inertia.iter_mut().zip(of_one) {
                *sum += m * term;
            }
        }
        inertia
    }

    #[test]
    fn bodies_of_points_are_physical() {
        assert!(is_physical([0.0; 6]));
        assert!(is_physical(points(&[(1.0, [0.3, -0.2, 0.5])])));
        assert!(is_physical(points(&[(1.0, [0.3, -0.2, 0.5]), (2.0, [-0.1, 0.7, 0.2])])));
        let three = [(0.3, [0.3, 0.1, 0.5]), (2.0, [-0.1, 0.7, 0.2]), (0.1, [-1.0, -0.7, 2.0])];
        assert!(is_physical(points(&three)));
    }

    #[test]
    fn a_negative_second_moment_is_not() {
        // One mass of the three is negative: the sum is the inertia of no body.
        let three = [(0.3, [0.3, 0.1, 0.5]), (2.0, [-0.1, 0.7, 0.2]), (-0.1, [-1.0, -0.7, 2.0])];
        assert!(!is_physical(points(&three)));
        assert!(!is_physical([1.0, 0.0, 0.0, 1.0, 0.0, 2.1]));
        assert!(!is_physical([1.0, 0.9, 0.0, 1.0, 0.0, 1.0]));
        assert!(!is_physical([-1.0, 0.0, 0.0, -1.0, 0.0, -1.0]));
    }
}
