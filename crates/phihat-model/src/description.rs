//! A kinematic tree as its author drew it: links, joints, and bodies in link axes.

use crate::body::LumpedBody;
use crate::placement::{Placement, about};

/// Motion of a joint's child.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum JointMotion {
    Fixed,
    Revolute,
    Prismatic,
}

/// A joint with its child link: a tree's links other than the root have exactly one.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct JointOf {
    pub(crate) name: String,
    pub(crate) motion: JointMotion,
    /// Index of the parent link.
    pub(crate) parent: usize,
    /// Pose of the child link in the parent link at position 0.
    pub(crate) placement: Placement,
    /// Unit vector in the child link's axes.
    pub(crate) axis: [f64; 3],
}

/// A link and how it hangs on its parent.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct DescribedLink {
    pub(crate) name: String,
    pub(crate) matter: LumpedBody,
    /// `None` for the root, which is link 0.
    pub(crate) joint: Option<JointOf>,
}

/// A whole tree in depth-first order: every link comes after its parent, and what hangs on a link
/// follows it without a gap.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Description {
    pub(crate) links: Vec<DescribedLink>,
}

impl Description {
    /// Links with a joint that moves, in coordinate order.
    pub(crate) fn moving(&self) -> impl Iterator<Item = (usize, &JointOf)> {
        self.links.iter().enumerate().filter_map(|(at, link)| {
            link.joint.as_ref().filter(|joint| joint.motion != JointMotion::Fixed).map(|j| (at, j))
        })
    }

    /// Fixes the joint called `name` at `position`; `false` if no moving joint has that name.
    pub(crate) fn fix(&mut self, name: &str, position: f64) -> bool {
        let joints = self.links.iter_mut().filter_map(|link| link.joint.as_mut());
        let mut moving = joints.filter(|joint| joint.motion != JointMotion::Fixed);
        let Some(joint) = moving.find(|joint| joint.name == name) else { return false };
        joint.hold(position);
        true
    }
}

impl JointOf {
    /// Fixes it at `position`.
    pub(crate) fn hold(&mut self, position: f64) {
        self.placement = self.placement.then(&self.displacement(position));
        self.motion = JointMotion::Fixed;
    }

    /// Displacement of the joint at `position`, relative to its placement.
    fn displacement(&self, position: f64) -> Placement {
        match self.motion {
            JointMotion::Fixed => Placement::IDENTITY,
            JointMotion::Revolute => {
                Placement { r: about(self.axis, position), ..Placement::IDENTITY }
            }
            JointMotion::Prismatic => {
                Placement { p: self.axis.map(|x| position * x), ..Placement::IDENTITY }
            }
        }
    }
}
