//! The postures where the ends of a range were found, looked at again.

use phihat_certificate::Witness;
use phihat_model::{Body, Model, Robot, Workspace};

use super::ArmError;
use super::postures::{eigen, scaled_mass_matrix};

/// What was seen at a posture with a payload.
pub(super) fn seen(q: Vec<f64>, body: &Body, eigenvalue: f64) -> Witness {
    let Body { mass, com, inertia } = *body;
    Witness { q, mass_kg: mass, com_m: com, inertia_kg_m2: inertia, eigenvalue }
}

/// Smallest and largest eigenvalue at the witness, looked at again on a robot.
///
/// # Errors
///
/// [`ArmError::Payload`] if the robot has no such frame or joints.
pub fn replay(
    witness: &Witness,
    robot: &Robot,
    frame: &str,
    nominal: &[f64],
) -> Result<(f64, f64), ArmError> {
    let n = robot.joints.len();
    if witness.q.len() != n || nominal.len() != n {
        let why = format!("a witness of {} joints for an arm of {n}", witness.q.len());
        return Err(ArmError::Payload(why));
    }
    let body = Body { mass: witness.mass_kg, com: witness.com_m, inertia: witness.inertia_kg_m2 };
    let model: Model = robot
        .plant_model()
        .with_payload_on(frame, &body)
        .map_err(|e| ArmError::Payload(e.to_string()))?;
    let w = scaled_mass_matrix(&model, &mut Workspace::new(&model), &witness.q, nominal);
    let (low, high) = eigen(&w);
    Ok((low.0, high.0))
}
