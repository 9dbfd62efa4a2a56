//! From a list of links and a list of joints to one tree, depth first.

use std::collections::BTreeMap;

use super::Result;
use super::element::Element;
use crate::body::Lumped;
use crate::description::{Description, JointOf, Link};
use crate::error::RobotError;
use crate::joint::Joint;

pub(super) struct LinkElement<'a, 'x> {
    pub(super) element: Element<'a, 'x>,
    pub(super) matter: Lumped,
}

pub(super) struct JointElement<'a, 'x> {
    pub(super) element: Element<'a, 'x>,
    pub(super) parent: &'a str,
    pub(super) child: &'a str,
    pub(super) joint: JointOf,
    /// `None` for a fixed joint.
    pub(super) moving: Option<Joint>,
}

/// Orders links and joints depth first, children as the file lists their joints. Gives the tree,
/// and the indices of the joints in its order.
pub(super) fn grow(
    links: &[LinkElement<'_, '_>],
    joints: &[JointElement<'_, '_>],
    origin: &str,
) -> Result<(Description, Vec<usize>)> {
    let index: BTreeMap<&str, usize> =
        links.iter().enumerate().map(|(at, link)| (link.element.name, at)).collect();
    let find = |joint: &JointElement<'_, '_>, which, name: &str| {
        let unknown = || joint.element.error(format!("its {which} link \"{name}\" does not exist"));
        index.get(name).copied().ok_or_else(unknown)
    };
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); links.len()];
    let mut hangs: Vec<Option<usize>> = vec![None; links.len()];
    let mut child_of_joint = Vec::new();
    for (at, joint) in joints.iter().enumerate() {
        let (parent, child) =
            (find(joint, "parent", joint.parent)?, find(joint, "child", joint.child)?);
        if let Some(other) = hangs[child] {
            let (link, other) = (joint.child, joints[other].element.name);
            let why = format!("its child link \"{link}\" is already the child of \"{other}\"");
            return Err(joint.element.error(why));
        }
        hangs[child] = Some(at);
        children[parent].push(at);
        child_of_joint.push(child);
    }
    let root = only_root(links, &hangs, origin)?;
    let mut tree = Description { links: Vec::new() };
    let (mut order, mut places) = (Vec::new(), vec![None; links.len()]);
    let mut next = vec![root];
    while let Some(at) = next.pop() {
        let joint = hangs[at].map(|j| {
            order.push(j);
            let parent = index.get(joints[j].parent).and_then(|p| places[*p]).unwrap_or(0);
            JointOf { parent, ..joints[j].joint.clone() }
        });
        places[at] = Some(tree.links.len());
        tree.links.push(Link {
            name: links[at].element.name.to_owned(),
            matter: links[at].matter,
            joint,
        });
        next.extend(children[at].iter().rev().map(|joint| child_of_joint[*joint]));
    }
    if let Some(at) = places.iter().position(Option::is_none) {
        let why = "it is part of a loop; links and joints must form a tree".to_owned();
        return Err(links[at].element.error(why));
    }
    if order.iter().all(|joint| joints[*joint].moving.is_none()) {
        let why = "no joint moves; at least one must".to_owned();
        return Err(RobotError::Tree { origin: origin.to_owned(), why });
    }
    Ok((tree, order))
}

fn only_root(
    links: &[LinkElement<'_, '_>],
    hangs: &[Option<usize>],
    origin: &str,
) -> Result<usize> {
    let roots: Vec<usize> = (0..links.len()).filter(|at| hangs[*at].is_none()).collect();
    match roots[..] {
        [root] => Ok(root),
        [] => {
            let why = "no link is without a parent: there must be one root".to_owned();
            Err(RobotError::Tree { origin: origin.to_owned(), why })
        }
        [_, second, ..] => {
            let first = links[roots[0]].element.name;
            let why = format!("it has no parent, nor has \"{first}\"; there must be one root");
            Err(links[second].element.error(why))
        }
    }
}
