//! `[[joint]]`: an arm that is known joint by joint, without a description.

use phihat_model::{Friction, Joint, JointKind, Robot};

use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::format::{FormatSection, Key, Need, NumberBounds, Shape};
use crate::node::Node;

/// Beginning of the warning that describes the simulation of an arm without a description.
pub const JOINT_BY_JOINT: &str = "the arm is known joint by joint";

/// Values that are stated of each joint for a design.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Stated {
    /// Inertia from and to \[kg·m²\].
    pub(crate) inertia: (Vec<f64>, Vec<f64>),
    /// Largest rate of φ \[N·m/s\], and largest jump of φ \[N·m\].
    pub(crate) phi: (Vec<f64>, Vec<f64>),
}

/// Reads the sections; `at_low` says which end of their inertia is simulated.
pub(crate) fn read(top: &Node<'_>, at_low: bool) -> Result<(Robot, Stated), StudyError> {
    if top.has("robot") {
        let why = "given, while [[joint]] says what is known of the arm";
        return Err(top.error(Kind::Conflict, "robot", why).with_help("keep one of them"));
    }
    needs_description(top)?;
    let (mut joints, mut low, mut high, mut rate, mut jump) =
        (Vec::<Joint>::new(), Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for node in top.children("joint") {
        let name = node.word("name")?;
        if joints.iter().any(|other| other.name == name) || name == "base" {
            let why = format!("\"{name}\" is the name of another joint, or of the base");
            return Err(node.error(Kind::Conflict, "name", why).with_help("another name"));
        }
        let (first, second) = ("inertia_min_kg_m2", "inertia_max_kg_m2");
        let (least, most) = (node.number(first)?, node.number(second)?);
        if least > most {
            let why = format!("{least} kg·m² is above {second} = {most}");
            return Err(node.error(Kind::Conflict, first, why));
        }
        let jumps = node.number("phi_jump_max_nm")?;
        low.push(least);
        high.push(most);
        rate.push(node.number("phi_rate_max_nm_s")?);
        jump.push(jumps);
        let (position, slides) = (position(&node)?, node.flag("slides")?);
        joints.push(Joint {
            name: name.to_owned(),
            kind: match position {
                _ if slides => JointKind::Prismatic,
                Some(_) => JointKind::Revolute,
                None => JointKind::Continuous,
            },
            position,
            velocity_max: node.number_if("velocity_max_rad_s"),
            torque_max: node.number_if("torque_max_nm"),
            torque_rate_max: node.number_if("torque_rate_max_nm_s"),
            armature: if at_low { least } else { most },
            armature_range: None,
            // Where the joint reverses, dry friction jumps by twice its level.
            friction: Friction { coulomb: 0.5 * jumps, ..Friction::default() },
            drive_bandwidth_hz: None,
            spring: None,
            encoder_bits: None,
        });
    }
    let mut robot = Robot::uncoupled(joints);
    let (end, other, word) =
        if at_low { ("lower", "upper", "high") } else { ("upper", "lower", "low") };
    robot.warnings.push(format!(
        "{JOINT_BY_JOINT}: what is simulated are joints that do not push each other, each with the {end} end \
         of its inertia and a dry friction of half of its jump; world.joint_inertia = \"{word}\" simulates the {other} \
         end"
    ));
    Ok((robot, Stated { inertia: (low, high), phi: (rate, jump) }))
}

/// Refuses what has no place without a description.
fn needs_description(top: &Node<'_>) -> Result<(), StudyError> {
    let (world, design) = (top.child("world"), top.child("design"));
    let payloads = [(&world, "payload"), (&design, "payload_kg"), (&design, "payload_max_kg")];
    if let Some((node, key)) = payloads.into_iter().find(|(node, key)| node.has(key)) {
        let why = "no place on joints that are known without a description";
        let help = "leave it out: what a load does is in the inertia and φ of each [[joint]]";
        return Err(node.error(Kind::Conflict, key, why).with_help(help));
    }
    let (spec, key) = (top.child("spec"), "tip_error_bound_mm");
    if spec.has(key) {
        let why = "no place on joints that are known without a description: where the tip is they do not tell";
        let help = "leave it out: `error_bound_rad` bounds each joint, in rad or m";
        return Err(spec.error(Kind::Conflict, key, why).with_help(help));
    }
    Ok(())
}

/// Both ends of travel, or none.
fn position(node: &Node<'_>) -> Result<Option<(f64, f64)>, StudyError> {
    let (first, second) = ("position_min_rad", "position_max_rad");
    match (node.number_if(first), node.number_if(second)) {
        (Some(low), Some(high)) if low < high => Ok(Some((low, high))),
        (Some(low), Some(high)) => {
            let why = format!("{low} rad is not below {second} = {high}");
            Err(node.error(Kind::Conflict, first, why))
        }
        (None, None) => Ok(None),
        (Some(_), None) => Err(node.missing(second)),
        (None, Some(_)) => Err(node.missing(first)),
    }
}

const INERTIA: NumberBounds = NumberBounds::positive(1e4);

const fn number(
    name: &'static str,
    unit: &'static str,
    bounds: NumberBounds,
    doc: &'static str,
) -> Key {
    Key { name, unit, shape: Shape::Number(bounds), need: Need::Required, doc }
}

const fn limit(
    name: &'static str,
    unit: &'static str,
    bounds: NumberBounds,
    without: &'static str,
    doc: &'static str,
) -> Key {
    Key { name, unit, shape: Shape::Number(bounds), need: Need::Optional(without), doc }
}

pub(crate) static JOINT: FormatSection = FormatSection {
    path: "joint",
    doc: "An arm without a description, in place of `[robot]`: what is known of each joint, in order. `phihat \
          identify` makes these sections from records of the arm. What is simulated are joints that do not push each \
          other.",
    keys: &[
        Key {
            name: "name",
            unit: "",
            shape: Shape::Text,
            need: Need::Required,
            doc: "Name of the joint.",
        },
        Key {
            name: "slides",
            unit: "",
            shape: Shape::Flag,
            need: Need::Flag(false),
            doc: "Whether it slides along its axis in place of turning about it: then its inertia is a mass in kg, its \
                  torque a force in N, and its positions are in m.",
        },
        number(
            "inertia_min_kg_m2",
            "kg·m²",
            INERTIA,
            "Least inertia that the joint moves: rotor included, in any posture, with any load.",
        ),
        number("inertia_max_kg_m2", "kg·m²", INERTIA, "Largest inertia that it moves."),
        number(
            "phi_rate_max_nm_s",
            "N·m/s",
            NumberBounds::closed(0.0, 1e6),
            "How fast the smooth part of the unknown torque φ changes at most; what the other joints do to it \
                included.",
        ),
        number(
            "phi_jump_max_nm",
            "N·m",
            NumberBounds::closed(0.0, 1e5),
            "How far φ jumps at most: twice the dry friction, where the joint reverses.",
        ),
        limit("torque_max_nm", "N·m", NumberBounds::positive(1e5), "no limit", "Largest torque."),
        limit(
            "torque_rate_max_nm_s",
            "N·m/s",
            NumberBounds::positive(1e8),
            "no limit",
            "Largest change of torque.",
        ),
        limit(
            "velocity_max_rad_s",
            "rad/s",
            NumberBounds::positive(1e3),
            "no limit",
            "Largest speed.",
        ),
        limit(
            "position_min_rad",
            "rad",
            NumberBounds::within(100.0),
            "turns without end",
            "Lower end of travel.",
        ),
        limit(
            "position_max_rad",
            "rad",
            NumberBounds::within(100.0),
            "turns without end",
            "Upper end of travel.",
        ),
    ],
};
