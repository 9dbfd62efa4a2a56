//! From the links and joints of a file to the arm that a part of them is.

use std::collections::BTreeMap;

use super::part::WholeDescription;
use super::tree::Tree;
use super::{CutArm, DescribedFile, JointElement, LinkElement, Result};
use crate::body::LumpedBody;
use crate::description::JointMotion;
use crate::error::RobotError;
use crate::input::plain;
use crate::joint::Joint;
use crate::part::{Chain, MotionOnly, Part};
use crate::{Model, Workspace};

/// Most joints of an arm.
const MOVING_MAX: usize = 32;

impl DescribedFile {
    /// Cuts a part of the file out, and checks it.
    pub(crate) fn cut(mut self, part: &Part) -> Result<CutArm> {
        let tree = Tree::of(&self.links, &self.joints, &self.origin)?;
        let mut warnings = std::mem::take(&mut self.warnings);
        let whole = self.whole(&tree);
        let cut = whole.cut(part, &mut warnings)?;
        let tip = part.tip.as_ref().map(|tip| whole.link(tip)).transpose()?;
        let tip = tip.map(|link| self.links[link].element.name.clone());
        let moving = cut.driven.iter().filter(|driven| **driven).count();
        if moving > MOVING_MAX {
            let chains = whole.chains();
            let proposed = chains.iter().find(|chain| chain.joints.len() <= MOVING_MAX);
            return Err(too_many(moving, proposed, &self.origin));
        }
        let joints = driven_joints(
            (&mut self.joints, &tree),
            &cut.driven,
            (&mut warnings, &mut self.notes),
        )?;
        let mut held = BTreeMap::new();
        for (at, joint) in self.joints.iter_mut().enumerate().filter(|(at, _)| !cut.driven[*at]) {
            if joint.joint.motion != JointMotion::Fixed {
                held.insert(joint.element.name.clone(), cut.at[at]);
            }
            joint.joint.hold(cut.at[at]);
        }
        let matter = matter(&mut self.links, (&tree, &cut.driven), &mut warnings)?;
        let (description, order) = tree.describe(&self.links, &self.joints, &matter);
        let model = Model::new(description);
        if let Some(at) = unmoved(&model) {
            let at = order.iter().filter(|at| cut.driven[**at]).nth(at).copied().unwrap_or(0);
            return Err(moves_nothing(&self.joints[at], &matter));
        }
        let model = match self.gravity {
            Some(gravity) => model.with_gravity(gravity),
            None => model,
        };
        let pose = |(name, all): (&String, &BTreeMap<String, f64>)| {
            let own = joints.iter().map(|joint| all.get(&joint.name).copied());
            Some((name.clone(), own.collect::<Option<Vec<f64>>>()?))
        };
        let poses = self.poses.iter().filter_map(pose).collect();
        warnings.append(&mut self.notes);
        let (name, included) = (self.name, self.included);
        Ok(CutArm { name, included, model, joints, held, tip, poses, warnings })
    }

    /// Joints of a part of the file with their limits, in the order of their links, whatever its links weigh.
    pub(crate) fn motion(mut self, part: &Part) -> Result<MotionOnly> {
        let tree = Tree::of(&self.links, &self.joints, &self.origin)?;
        let mut warnings = std::mem::take(&mut self.warnings);
        let cut = self.whole(&tree).cut(part, &mut warnings)?;
        let joints = driven_joints(
            (&mut self.joints, &tree),
            &cut.driven,
            (&mut warnings, &mut self.notes),
        )?;
        warnings.append(&mut self.notes);
        let warnings = warnings.iter().map(|own| plain(own)).collect();
        Ok(MotionOnly { name: self.name, joints, warnings })
    }

    /// Chains that could be arms, the longest first.
    pub(crate) fn chains(&self) -> Result<Vec<Chain>> {
        let tree = Tree::of(&self.links, &self.joints, &self.origin)?;
        Ok(self.whole(&tree).chains())
    }

    fn whole<'e>(&'e self, tree: &'e Tree) -> WholeDescription<'e> {
        let Self { links, joints, origin, follows, .. } = self;
        WholeDescription { links, joints, tree, origin, follows }
    }
}

/// Joints that are driven, with their limits, in the order of their links.
fn driven_joints(
    (joints, tree): (&mut [JointElement], &Tree),
    driven: &[bool],
    (warnings, notes): (&mut Vec<String>, &mut Vec<String>),
) -> Result<Vec<Joint>> {
    let mut read = Vec::new();
    for link in &tree.order {
        let Some(at) = tree.hangs[*link].filter(|at| driven[*at]) else { continue };
        let Some(stated) = joints[at].stated.take() else { continue };
        let stated = stated?;
        read.push(stated.joint);
        warnings.extend(stated.warnings);
        for note in stated.notes {
            if !notes.contains(&note) {
                notes.push(note);
            }
        }
    }
    Ok(read)
}

/// A joint of the arm moves no mass.
fn moves_nothing(joint: &JointElement, matter: &[LumpedBody]) -> RobotError {
    let element = &joint.element;
    if matter.iter().all(|body| *body == LumpedBody::default()) {
        let (origin, line, joint) =
            (element.origin.to_string(), element.line, element.name.clone());
        return RobotError::NoInertia { origin, line, joint };
    }
    let child = &joint.child;
    element.error(format!(
        "it moves no mass, so torque has nothing to act on: link \"{child}\" and what is welded to it need an \
            <inertial>"
    ))
}

fn too_many(moving: usize, proposed: Option<&Chain>, origin: &str) -> RobotError {
    let remedy = proposed.map_or_else(String::new, |chain| {
        let Chain { base, tip, joints, .. } = chain;
        format!(", such as base = \"{base}\", tip = \"{tip}\" ({} joints)", joints.len())
    });
    let why = format!(
        "{moving} joints move, more than the {MOVING_MAX} of an arm: name the arm's base and tip{remedy}"
    );
    RobotError::SeveralArms { origin: origin.to_owned(), why }
}

/// Matter of every link. What is wrong with it counts where a joint moves it.
fn matter(
    links: &mut [LinkElement],
    (tree, driven): (&Tree, &[bool]),
    warnings: &mut Vec<String>,
) -> Result<Vec<LumpedBody>> {
    let mut moved = vec![false; links.len()];
    for at in &tree.order {
        let Some(joint) = tree.hangs[*at] else { continue };
        moved[*at] = driven[joint] || moved[tree.parent_of_joint[joint]];
    }
    let one = |(link, moved): (&mut LinkElement, bool)| {
        let read = std::mem::replace(&mut link.matter, Ok((LumpedBody::default(), Vec::new())));
        match read {
            Ok((matter, odd)) => {
                if moved {
                    warnings.extend(odd);
                }
                Ok(matter)
            }
            Err(why) if moved => Err(why),
            Err(why) => {
                warnings.push(format!("{why} (nothing moves it, so it is not needed)"));
                Ok(LumpedBody::default())
            }
        }
    };
    links.iter_mut().zip(moved).map(one).collect()
}

/// A coordinate whose motion takes no energy, at a posture like no other.
fn unmoved(model: &Model) -> Option<usize> {
    const ROUNDING: f64 = 1e-13;
    let n = model.joint_count();
    let q: Vec<f64> = (0..n).map(|joint| 0.5 + 0.1 * joint as f64).collect();
    let mut m = vec![0.0; n * n];
    model.mass_matrix(&mut Workspace::new(model), &q, &mut m);
    let diagonal: Vec<f64> = (0..n).map(|i| m[i * n + i]).collect();
    // What is left of each joint's inertia when those before it are free to move.
    for k in 0..n {
        let pivot = m[k * n + k];
        if pivot.is_nan() || pivot <= ROUNDING * diagonal[k] {
            return Some(k);
        }
        for i in k + 1..n {
            let factor = m[i * n + k] / pivot;
            (k..n).for_each(|j| m[i * n + j] -= factor * m[k * n + j]);
        }
    }
    None
}
