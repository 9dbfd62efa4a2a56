//! `[robot.transmission]`: the springs between rotors and links.

use phihat_model::{Joint, JointSpring, Robot, Rotor};

use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::node::Node;
use crate::per_joint::Joints;

/// `[robot.transmission]`: what is stated of the spring between each rotor and its link.
#[derive(Debug, Clone, PartialEq)]
pub enum JointSprings {
    /// Nothing: claims are for rigid joints, and say so.
    Unstated,
    /// Joints are rigid: an assumption that claims list.
    Rigid,
    /// An interval per joint that holds its spring: gains have to be stable with each.
    Stated(Vec<JointSpring>),
}

impl JointSprings {
    /// Springs that gains have to be stable with; `None`: joints are taken as rigid.
    pub fn stated(&self) -> Option<&[JointSpring]> {
        match self {
            Self::Stated(springs) => Some(springs),
            Self::Unstated | Self::Rigid => None,
        }
    }

    pub(crate) fn read(
        node: &Node<'_>,
        robot: &Robot,
        joints: &Joints,
    ) -> Result<Self, StudyError> {
        let own = node.child("transmission");
        if !own.exists() {
            return Ok(Self::Unstated);
        }
        let springs = match own.word("stiffness")? {
            "rigid" => {
                alone(&own, "rigid joints have neither stiffness nor damping")?;
                return Ok(Self::Rigid);
            }
            "robot" => {
                alone(&own, "stiffness and damping are the description's")?;
                robot.joints.iter().map(|joint| described(&own, joint)).collect()
            }
            _ => {
                let of = |keys| interval(&own, joints, keys);
                let stiffness = of(["stiffness_min_nm_rad", "stiffness_max_nm_rad"])?;
                let damping = of(["damping_min_nm_s_rad", "damping_max_nm_s_rad"])?;
                let both = stiffness.into_iter().zip(damping);
                Ok(both.map(|(stiffness, damping)| JointSpring { stiffness, damping }).collect())
            }
        }?;
        let bare = |joint: &&Joint| joint.armature_at(Rotor::Least) <= 0.0;
        if let Some(joint) = robot.joints.iter().find(bare) {
            let why =
                format!("joint `{}` has no rotor inertia to stand behind a spring", joint.name);
            let error = node.error(Kind::Robot, "transmission", why);
            return Err(error.with_help("state `armature_kg_m2` in [robot]"));
        }
        Ok(Self::Stated(springs))
    }
}

const NUMBERS: [&str; 4] = [
    "stiffness_min_nm_rad",
    "stiffness_max_nm_rad",
    "damping_min_nm_s_rad",
    "damping_max_nm_s_rad",
];

/// That no number stands beside a word.
fn alone(own: &Node<'_>, why: &str) -> Result<(), StudyError> {
    match NUMBERS.into_iter().find(|key| own.has(key)) {
        Some(key) => Err(own.error(Kind::Conflict, key, why).with_help("leave it out")),
        None => Ok(()),
    }
}

/// The spring of a joint's description, or the one that is assumed of such a joint.
fn described(own: &Node<'_>, joint: &Joint) -> Result<JointSpring, StudyError> {
    joint.spring.or_else(|| JointSpring::assumed(joint)).ok_or_else(|| {
        let why = format!("nothing is known of the spring of joint `{}`, which slides", joint.name);
        own.error(Kind::Robot, "stiffness", why).with_help("state intervals")
    })
}

/// Both ends of an interval per joint; one number where only the lower end is stated.
fn interval(
    node: &Node<'_>,
    joints: &Joints,
    [first, second]: [&str; 2],
) -> Result<Vec<(f64, f64)>, StudyError> {
    let low = joints.numbers(node, first)?;
    let high = joints.numbers_if(node, second)?.unwrap_or_else(|| low.clone());
    for (j, (least, most)) in low.iter().zip(&high).enumerate() {
        if least > most {
            let name = &joints.names[j];
            let why = format!("joint `{name}`: {least} is above {second} = {most}");
            return Err(node.error_at(Kind::Conflict, first, (j, name), why));
        }
    }
    Ok(low.into_iter().zip(high).collect())
}
