//! Chains of a tree that could be arms.

use super::Moves;
use super::part::WholeDescription;
use crate::part::Chain;

/// Words in the names of what grasps: it ends an arm.
const GRASPS: [&str; 8] = ["gripper", "finger", "thumb", "knuckle", "jaw", "claw", "hand", "palm"];

/// Those of what an arm carries, never of what it ends in.
const FINGERS: [&str; 5] = ["finger", "thumb", "knuckle", "jaw", "claw"];

/// Words in the names of the link that does the work, the best first.
const WORKS: [&str; 10] = [
    "tcp",
    "tool0",
    "tool_center",
    "end_effector",
    "ee_link",
    "attachment",
    "flange",
    "tool",
    "ee",
    "grasp",
];

/// A branch with more joints than this is no finger.
const FINGER_MAX: usize = 5;

/// An arm of so many joints can end in fingers without a name.
const ARM_MIN: usize = 3;

impl WholeDescription<'_> {
    /// Chains from the root to a link that only fingers continue; the longest first, else in the order of the
    /// file.
    pub(super) fn chains(&self) -> Vec<Chain> {
        let counts = self.moving_below();
        let mut found: Vec<(Vec<usize>, usize)> = Vec::new();
        // Links with the driven joints that lead to them.
        let mut next = vec![(self.tree.root, Vec::new())];
        while let Some((link, path)) = next.pop() {
            let on: Vec<usize> = self.tree.children[link]
                .iter()
                .copied()
                .filter(|at| self.moves(*at) || counts[self.tree.child_of_joint[*at]] > 0)
                .collect();
            if (on.is_empty() || self.is_hand(&on, &counts, &path)) && !path.is_empty() {
                if !found.iter().any(|(own, _)| *own == path) {
                    found.push((path, link));
                }
                continue;
            }
            for at in on.iter().rev() {
                let mut longer = path.clone();
                match self.joints[*at].moves {
                    Moves::Driven(_) => longer.push(*at),
                    // An arm ends before what floats, and another begins behind it.
                    Moves::Free(_) => {
                        let ends = !path.is_empty() && !found.iter().any(|(own, _)| *own == path);
                        found.extend(ends.then(|| (path.clone(), link)));
                        longer.clear();
                    }
                    Moves::Not | Moves::Follows { .. } => {}
                }
                next.push((self.tree.child_of_joint[*at], longer));
            }
        }
        let prefix =
            |short: &[usize], long: &[usize]| short.len() < long.len() && long.starts_with(short);
        let all: Vec<Vec<usize>> = found.iter().map(|(path, _)| path.clone()).collect();
        found.retain(|(path, _)| !all.iter().any(|other| prefix(path, other)));
        found.sort_by_key(|(path, _)| std::cmp::Reverse(path.len()));
        found.iter().filter_map(|(path, _)| self.chain(path)).collect()
    }

    fn moves(&self, joint: usize) -> bool {
        matches!(self.joints[joint].moves, Moves::Driven(_) | Moves::Follows { .. })
    }

    /// Joints that move below each link.
    fn moving_below(&self) -> Vec<usize> {
        let mut counts = vec![0; self.links.len()];
        for link in self.tree.order.iter().rev() {
            let Some(joint) = self.tree.hangs[*link] else { continue };
            counts[self.tree.parent_of_joint[joint]] +=
                counts[*link] + usize::from(self.moves(joint));
        }
        counts
    }

    /// Returns true if the joints `on` from a link are those of a hand.
    fn is_hand(&self, on: &[usize], counts: &[usize], path: &[usize]) -> bool {
        let child = |at: usize| self.tree.child_of_joint[at];
        let has = |name: &str, words: &[&str]| {
            let name = name.to_lowercase();
            words.iter().any(|word| name.contains(word))
        };
        let before = path.len();
        // What is a finger from its root on carries none: it is the arm, joint after joint.
        if before > 0 && path.iter().all(|at| has(&self.joints[*at].element.name, &FINGERS)) {
            return false;
        }
        // A wrist may carry a link that is called gripper, but none that is called finger.
        let named = |at: usize| {
            has(&self.joints[at].element.name, &GRASPS)
                || has(&self.links[child(at)].element.name, &FINGERS)
                || matches!(self.joints[at].moves, Moves::Follows { .. })
        };
        let short = |at: usize| counts[child(at)] + usize::from(self.moves(at)) <= FINGER_MAX;
        let all_named = !on.is_empty()
            && on.iter().all(|at| named(*at) && (short(*at) || on.len() > 1 || before >= ARM_MIN));
        all_named || (on.len() > 1 && before >= ARM_MIN && on.iter().all(|at| short(*at)))
    }

    fn chain(&self, path: &[usize]) -> Option<Chain> {
        let (first, last) = (*path.first()?, *path.last()?);
        let name = |link: usize| &*self.links[link].element.name;
        let moved = self.tree.child_of_joint[last];
        // All that is welded to the link that moves last.
        let (mut welded, mut next) = (Vec::new(), vec![moved]);
        while let Some(link) = next.pop() {
            welded.push(link);
            let fixed = self.tree.children[link].iter();
            let fixed = fixed.filter(|at| matches!(self.joints[**at].moves, Moves::Not));
            next.extend(fixed.rev().map(|at| self.tree.child_of_joint[*at]));
        }
        let works = WORKS
            .iter()
            .find_map(|word| welded.iter().find(|link| name(**link).to_lowercase().contains(word)));
        Some(Chain {
            base: name(self.tree.parent_of_joint[first]).to_owned(),
            tip: name(*works.unwrap_or(&moved)).to_owned(),
            joints: path.iter().map(|at| self.joints[*at].element.name.clone()).collect(),
        })
    }
}
