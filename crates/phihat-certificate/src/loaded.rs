//! A study's arm with a payload in its hand.

use phihat_model::{Body, Model, Rotor};
use phihat_study::Study;

use crate::Refutation;
use crate::refutation::refuse;

const CLAIM: &str = "study";

/// The arm with a body on a frame, with nothing where that has no mass; its rotors at one place of their intervals.
pub(crate) fn loaded(
    study: &Study,
    (rotor, body): (Rotor, &Body),
    frame: &str,
) -> Result<Model, Refutation> {
    let bare = study.robot.plant_model_at(rotor);
    if body.mass > 0.0 {
        let refused = |why: String| {
            refuse(
                CLAIM,
                &format!("the payload can be attached to {frame} ({why})"),
                body.mass,
                0.0,
            )
        };
        bare.with_payload_on(frame, body).map_err(|why| refused(why.to_string()))
    } else {
        Ok(bare)
    }
}
