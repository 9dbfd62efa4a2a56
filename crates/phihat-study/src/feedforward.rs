//! `[feedforward]`: what is known of the arm, and need not be estimated.

use phihat::Form;

use crate::arm::StudyArm;
use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::format::{FormatSection, Key, Need, NumberBounds, Shape};
use crate::node::Node;
use crate::study::{Control, FeedForward, Known};

pub(crate) static FEEDFORWARD: FormatSection = FormatSection {
    path: "feedforward",
    doc: "Torque that a law from positions is given with its reference, of a description and along the reference: φ is \
          then what is left. With a `[supervisor]` that is the reference in force: blended, shaped or held.",
    keys: &[
        Key {
            name: "model",
            unit: "",
            shape: Shape::Word(&["none", "gravity", "inverse_dynamics"]),
            need: Need::Word("none"),
            doc: "What of the robot's description, without payload: the torque that holds it at q_d, or the whole that \
                  moves it along q_d. `inverse_dynamics` takes the place of M̄ q̈_d. Without gravity where the robot \
                  adds that by itself.",
        },
        Key {
            name: "mass_scale",
            unit: "",
            shape: Shape::Number(NumberBounds::closed(0.01, 10.0)),
            need: Need::Number(1.0),
            doc: "How many times its masses and inertias that description has: 0.8 is a model with masses 20 % too \
                small.",
        },
        Key {
            name: "coulomb_nm",
            unit: "N·m",
            shape: Shape::PerJoint(NumberBounds::closed(0.0, 1e4), &[]),
            need: Need::Number(0.0),
            doc: "Level of dry friction that is fed forward by the sign of q̇_d, smooth below 1 mrad/s.",
        },
    ],
};

/// `None`: nothing is fed forward but `M̄ q̈_d`.
pub(crate) fn read(
    top: &Node<'_>,
    arm: &StudyArm,
    control: &Control,
) -> Result<Option<FeedForward>, StudyError> {
    let node = top.child("feedforward");
    if !node.exists() {
        return Ok(None);
    }
    let refused = |message: &str, help: &str| {
        Err(node.error(Kind::Conflict, "model", message).with_help(help))
    };
    if control.form != Form::Positions {
        return refused(
            "the observer of this form would take what is fed forward for φ",
            "set loop.form = \"positions\", or leave [feedforward] out",
        );
    }
    let known = match node.word("model")? {
        "gravity" => Known::Gravity,
        "inverse_dynamics" => Known::InverseDynamics,
        _ => Known::Nothing,
    };
    Ok(Some(FeedForward {
        known,
        mass_scale: node.number("mass_scale")?,
        coulomb: arm.joints.numbers(&node, "coulomb_nm")?,
    }))
}
