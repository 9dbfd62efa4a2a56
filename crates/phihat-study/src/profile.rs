//! `[profile]`: the robot's torque interface.

use phihat_model::Profile;

use crate::arm::StudyArm;
use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::format::{FormatSection, Key, Need, NumberBounds, Shape};
use crate::node::Node;
use crate::study::Interface;

const OWN: Need = Need::Optional("as the interface has it");

pub(crate) static PROFILE: FormatSection = FormatSection {
    path: "profile",
    doc: "What the robot's torque interface adds to a command, and on what it stops. The keys beside \
          `name` replace figures of the interface.",
    keys: &[
        Key {
            name: "name",
            unit: "",
            shape: Shape::Word(&["robot", "ideal", "franka", "ur", "kuka_fri", "kortex"]),
            need: Need::Word("robot"),
            doc: "The interface; `\"robot\"` takes the one that the robot's description names.",
        },
        Key {
            name: "adds_gravity",
            unit: "",
            shape: Shape::Flag,
            need: OWN,
            doc: "Whether the robot adds the torque that holds it, without payload, against gravity. φ \
                  then lacks it.",
        },
        Key {
            name: "adds_friction",
            unit: "",
            shape: Shape::Number(NumberBounds::closed(0.0, 1.0)),
            need: OWN,
            doc: "Share of its described friction that the robot adds.",
        },
        Key {
            name: "torque_rate_max_nm_s",
            unit: "N·m/s",
            shape: Shape::Number(NumberBounds::positive(1e9)),
            need: OWN,
            doc: "The robot stops when a command changes faster.",
        },
        Key {
            name: "first_torque_max_nm",
            unit: "N·m",
            shape: Shape::Number(NumberBounds::closed(0.0, 1e5)),
            need: OWN,
            doc: "The robot does not start on a first command beyond this.",
        },
        Key {
            name: "losses_max",
            unit: "",
            shape: Shape::Number(NumberBounds::integers(1.0, 1e6)),
            need: OWN,
            doc: "The robot stops after so many commands in a row are lost.",
        },
        Key {
            name: "torque_filter_hz",
            unit: "Hz",
            shape: Shape::Number(NumberBounds::positive(1e5)),
            need: OWN,
            doc: "First-order low-pass that the robot puts on the commands.",
        },
        Key {
            name: "controller_keeps",
            unit: "",
            shape: Shape::Flag,
            need: Need::Flag(true),
            doc: "Whether the controller keeps the interface's limits and start rule by itself; `false` \
                  shows what happens to one that does not.",
        },
    ],
};

/// The interface; without the section, ideal drives.
pub(crate) fn read(node: &Node<'_>, arm: &StudyArm, rate: f64) -> Result<Interface, StudyError> {
    let refuse = |error| node.error(Kind::Robot, "name", format!("{error}"));
    if !node.exists() {
        let profile = Profile::named("ideal").map_err(refuse)?;
        return Ok(Interface { profile, kept: true });
    }
    let name = match node.word("name")? {
        "robot" => arm.robot.profile.as_str(),
        name => name,
    };
    let mut profile = Profile::named(name).map_err(refuse)?;
    if node.has("adds_gravity") {
        profile.adds_gravity = node.flag("adds_gravity")?;
    }
    if let Some(share) = node.number_if("adds_friction") {
        profile.adds_friction = share;
    }
    let replace = |key: &str, figure: &mut Option<f64>| *figure = node.number_if(key).or(*figure);
    replace("torque_rate_max_nm_s", &mut profile.torque_rate_max);
    replace("first_torque_max_nm", &mut profile.first_torque_max);
    replace("torque_filter_hz", &mut profile.torque_filter);
    if node.has("losses_max") {
        profile.losses_max = Some(node.small_count("losses_max")?);
    }
    let (low, high) = (profile.rate_min.unwrap_or(0.0), profile.rate_max.unwrap_or(f64::INFINITY));
    if !(low..=high).contains(&rate) {
        let between = if low < high { format!("{low} to {high}") } else { format!("{low}") };
        let message =
            format!("`{name}` takes commands at {between} Hz, the loop runs at {rate} Hz");
        return Err(node
            .error(Kind::Conflict, "name", message)
            .with_help(format!("`rate_hz = {low:?}` in [loop]")));
    }
    Ok(Interface { profile, kept: node.flag("controller_keeps")? })
}
