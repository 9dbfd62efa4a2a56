//! Common parts of the lists of keys.

use crate::format::{Bounds, Key, Need, Section, Shape};

/// Words in place of a number: the robot's own, or none.
pub(crate) const ROBOT_OR_NONE: &[&str] = &["robot", "none"];

/// A time in a run \[s\]: up to a day.
pub(crate) const TIME: Bounds = Bounds::closed(0.0, 86_400.0);

/// A section of its own.
pub(crate) const fn table(
    name: &'static str,
    need: Need,
    section: &'static Section,
    doc: &'static str,
) -> Key {
    Key { name, unit: "", shape: Shape::Table(section), need, doc }
}

/// A number per joint that is 0 unless stated.
pub(crate) const fn per_joint(
    name: &'static str,
    unit: &'static str,
    bounds: Bounds,
    doc: &'static str,
) -> Key {
    Key { name, unit, shape: Shape::PerJoint(bounds, &[]), need: Need::Number(0.0), doc }
}
