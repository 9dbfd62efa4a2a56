//! From a list of links and a list of joints to one tree, depth first.

use std::collections::BTreeMap;

use super::{NamedElement, Result};
use crate::body::LumpedBody;
use crate::description::{DescribedLink, Description, JointOf};
use crate::error::RobotError;
use crate::joint::{Joint, JointKind};

/// Motion of a joint in its file.
#[derive(Debug, Clone)]
pub(crate) enum Moves {
    /// Fixed.
    Not,
    /// By a drive of its own.
    Driven(JointKind),
    /// With another joint: `factor` times its position, and `offset` \[rad, m\].
    Follows { kind: JointKind, leader: String, factor: f64, offset: f64 },
    /// In more ways than one drive serves: a floating, planar or spherical joint.
    Free(&'static str),
}

/// A link of a file.
pub(crate) struct LinkElement {
    pub(crate) element: NamedElement,
    /// With what is odd about it. What it says of its mass may be wrong, which counts where a joint moves it.
    pub(crate) matter: Result<(LumpedBody, Vec<String>)>,
}

/// Limits, drive and friction of a joint, and what is odd about them.
pub(crate) struct StatedJoint {
    pub(crate) joint: Joint,
    pub(crate) warnings: Vec<String>,
    pub(crate) notes: Vec<String>,
}

/// A joint of a file.
pub(crate) struct JointElement {
    pub(crate) element: NamedElement,
    pub(crate) parent: String,
    pub(crate) child: String,
    pub(crate) joint: JointOf,
    pub(crate) moves: Moves,
    /// Positions that it can be held at \[rad, m\]; `None`: any.
    pub(crate) reach: Option<(f64, f64)>,
    /// Position in the posture that the file is drawn in \[rad, m\]: where it is held if nothing else is stated.
    pub(crate) drawn_at: f64,
    /// Limits and drive that it states, which may be wrong: that counts where it is one of the arm's. `None`: none
    /// drives it.
    pub(crate) stated: Option<Result<StatedJoint>>,
}

impl JointElement {
    /// Position that it can be held at, as near to `wanted` as may be.
    pub(crate) fn nearest(&self, wanted: f64) -> f64 {
        self.reach.map_or(wanted, |(low, high)| wanted.clamp(low, high))
    }
}

/// Parents and children, by index into the lists of links and joints.
pub(super) struct Tree {
    /// Joint that each link hangs on; `None`: the root.
    pub(super) hangs: Vec<Option<usize>>,
    /// Joints at each link, as the file lists them.
    pub(super) children: Vec<Vec<usize>>,
    pub(super) parent_of_joint: Vec<usize>,
    pub(super) child_of_joint: Vec<usize>,
    pub(super) root: usize,
    /// Links, depth first.
    pub(super) order: Vec<usize>,
}

impl Tree {
    /// Checks that links and joints make one tree.
    pub(super) fn of(links: &[LinkElement], joints: &[JointElement], origin: &str) -> Result<Self> {
        let index: BTreeMap<&str, usize> =
            links.iter().enumerate().map(|(at, link)| (&*link.element.name, at)).collect();
        let find = |joint: &JointElement, which, name: &str| {
            let unknown =
                || joint.element.error(format!("its {which} link \"{name}\" does not exist"));
            index.get(name).copied().ok_or_else(unknown)
        };
        let mut children: Vec<Vec<usize>> = vec![Vec::new(); links.len()];
        let mut hangs: Vec<Option<usize>> = vec![None; links.len()];
        let (mut parent_of_joint, mut child_of_joint) = (Vec::new(), Vec::new());
        for (at, joint) in joints.iter().enumerate() {
            let (parent, child) =
                (find(joint, "parent", &joint.parent)?, find(joint, "child", &joint.child)?);
            if let Some(other) = hangs[child] {
                let (link, other) = (&joint.child, &joints[other].element.name);
                let why = format!("its child link \"{link}\" is already the child of \"{other}\"");
                return Err(joint.element.error(why));
            }
            hangs[child] = Some(at);
            children[parent].push(at);
            parent_of_joint.push(parent);
            child_of_joint.push(child);
        }
        let root = only_root(links, &hangs, origin)?;
        let mut order = Vec::with_capacity(links.len());
        let mut next = vec![root];
        while let Some(at) = next.pop() {
            order.push(at);
            next.extend(children[at].iter().rev().map(|joint| child_of_joint[*joint]));
        }
        if order.len() < links.len() {
            let lost = (0..links.len()).find(|at| !order.contains(at)).unwrap_or(root);
            let why = "it is part of a loop; links and joints must form a tree".to_owned();
            return Err(links[lost].element.error(why));
        }
        Ok(Self { hangs, children, parent_of_joint, child_of_joint, root, order })
    }

    /// Joints from the root to a link, the first one first.
    pub(super) fn to_link(&self, link: usize) -> Vec<usize> {
        let above = |at: &usize| self.hangs[self.parent_of_joint[*at]];
        let mut path: Vec<usize> = std::iter::successors(self.hangs[link], above).collect();
        path.reverse();
        path
    }

    /// The description, and the joints in its order, where each link's matter is at hand.
    pub(super) fn describe(
        &self,
        links: &[LinkElement],
        joints: &[JointElement],
        matter: &[LumpedBody],
    ) -> (Description, Vec<usize>) {
        let mut description = Description { links: Vec::new() };
        let (mut order, mut places) = (Vec::new(), vec![0; links.len()]);
        for (place, at) in self.order.iter().enumerate() {
            places[*at] = place;
            let joint = self.hangs[*at].map(|j| {
                order.push(j);
                JointOf { parent: places[self.parent_of_joint[j]], ..joints[j].joint.clone() }
            });
            let name = links[*at].element.name.clone();
            description.links.push(DescribedLink { name, matter: matter[*at], joint });
        }
        (description, order)
    }
}

fn only_root(links: &[LinkElement], hangs: &[Option<usize>], origin: &str) -> Result<usize> {
    let roots: Vec<usize> = (0..links.len()).filter(|at| hangs[*at].is_none()).collect();
    match roots[..] {
        [root] => Ok(root),
        [] => {
            let why = "no link is without a parent: there must be one root".to_owned();
            Err(RobotError::Tree { origin: origin.to_owned(), why })
        }
        [_, second, ..] => {
            let first = &links[roots[0]].element.name;
            let why = format!("it has no parent, nor has \"{first}\"; there must be one root");
            Err(links[second].element.error(why))
        }
    }
}
