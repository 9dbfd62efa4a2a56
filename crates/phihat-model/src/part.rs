//! Part of a description that is the arm.

use std::collections::BTreeMap;

use crate::joint::Joint;

/// Part of a description that is the arm; all of it by default.
///
/// The rest stands still: at the position stated for it, else as near to 0 as its limits permit.
///
/// # Example
///
/// ```
/// use phihat_model::{Part, Robot};
///
/// // Two arms on a torso that turns; the left one alone, with the torso turned by 0.3 rad.
/// let joint = |name: &str, parent: &str, child: &str| format!(
///     r#"<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>
///        <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="9" velocity="2"/></joint>
///        <link name="{child}"><inertial><origin xyz="0.1 0 0.1"/><mass value="1"/>
///        <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>"#);
/// let urdf = format!(r#"<robot name="two"><link name="base"/>{}{}{}{}</robot>"#,
///     joint("waist", "base", "torso"), joint("left1", "torso", "left_upper"),
///     joint("left2", "left_upper", "left_hand"), joint("right1", "torso", "right_hand"));
/// let chains = Robot::chains_of_text(&urdf, "two.urdf")?;
/// assert_eq!(chains[0].joints, ["waist", "left1", "left2"]);
///
/// let part = Part {
///     base: Some("torso".to_owned()),
///     tip: Some("left_hand".to_owned()),
///     locked: [("waist".to_owned(), 0.3)].into(),
///     ..Part::default()
/// };
/// let arm = Robot::part_of_text(&urdf, &part, "two.urdf")?;
/// assert_eq!(arm.model.joint_names(), ["left1", "left2"]);
/// # Ok::<(), phihat_model::RobotError>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Part {
    /// Link that stands still; `None`: the root.
    pub base: Option<String>,
    /// Link that does the work: joints from the base to it are the arm's.
    pub tip: Option<String>,
    /// The arm's joints themselves, in place of those from the base to the tip.
    pub joints: Option<Vec<String>>,
    /// Joints held fixed, by name, each with its position \[rad, m\]; those of the arm are no joints of it then.
    pub locked: BTreeMap<String, f64>,
}

impl Part {
    /// Returns true if a part is stated.
    pub fn is_stated(&self) -> bool {
        self.base.is_some() || self.tip.is_some() || self.joints.is_some()
    }
}

/// Joints of a description whose links may be without mass.
#[derive(Debug, Clone)]
pub struct MotionOnly {
    /// The robot's name.
    pub name: String,
    /// Its joints with their limits, in order.
    pub joints: Vec<Joint>,
    /// Oddities of the description that do not prevent its use.
    pub warnings: Vec<String>,
}

/// A chain of joints that could be an arm.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Chain {
    /// Link that its first joint stands on.
    pub base: String,
    /// Link that its last joint moves, or one welded to that whose name says that it does the work.
    pub tip: String,
    /// Links that could be its tip by their names as well as that one, that one among them; empty: none.
    pub tips: Vec<String>,
    /// Its joints, from the base to the tip.
    pub joints: Vec<String>,
}
