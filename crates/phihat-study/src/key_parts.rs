//! Common parts of the lists of keys.

use crate::format::{FormatSection, Key, Need, NumberBounds, Shape};

/// Words in place of a number: the robot's own, or none.
pub(crate) const ROBOT_OR_NONE: &[&str] = &["robot", "none"];

/// A time in a run \[s\]: up to a day.
pub(crate) const TIME: NumberBounds = NumberBounds::closed(0.0, 86_400.0);

/// A section of its own.
pub(crate) const fn table(
    name: &'static str,
    need: Need,
    section: &'static FormatSection,
    doc: &'static str,
) -> Key {
    Key { name, unit: "", shape: Shape::Table(section), need, doc }
}

/// A number per joint that is 0 unless stated.
pub(crate) const fn per_joint(
    name: &'static str,
    unit: &'static str,
    bounds: NumberBounds,
    doc: &'static str,
) -> Key {
    Key { name, unit, shape: Shape::PerJoint(bounds, &[]), need: Need::Number(0.0), doc }
}
