//! Chains of a tree that could be arms.

use super::part::WholeDescription;
use super::{JointElement, Moves};
use crate::joint::JointKind;
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

/// Those of them by which a link is a tip without a doubt.
const TIPS: usize = 4;

/// A joint that slides by no more than this \[m\] after so many others is a gripper's.
const JAW: (f64, usize) = (0.1, 5);

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
        let jaw =
            before >= JAW.1 && matches!(on, [one] if self.is_jaw(*one) && counts[child(*one)] == 0);
        all_named || jaw || (on.len() > 1 && before >= ARM_MIN && on.iter().all(|at| short(*at)))
    }

    fn chain(&self, path: &[usize]) -> Option<Chain> {
        let (first, last) = (*path.first()?, *path.last()?);
        let name = |link: usize| &*self.links[link].element.name;
        let moved = self.tree.child_of_joint[last];
        let welded = self.welded(moved);
        let (mut tip, mut tips) = self.best_tip(&welded).unwrap_or((moved, Vec::new()));
        // What grasps is behind the flange, and the payload is in it.
        let carries_hand =
            |link: &&usize| self.tree.children[**link].iter().any(|at| self.moves(*at));
        let palm = welded.iter().rev().find(carries_hand).copied();
        if let Some(palm) = palm.filter(|palm| *palm != tip && self.carries(tip, *palm)) {
            let behind: Vec<usize> = self.welded(palm).into_iter().skip(1).collect();
            (tip, tips) = self.best_tip(&behind).unwrap_or((palm, Vec::new()));
        }
        Some(Chain {
            base: name(self.tree.parent_of_joint[first]).to_owned(),
            tip: name(tip).to_owned(),
            tips: tips.into_iter().map(|link| name(link).to_owned()).collect(),
            joints: path.iter().map(|at| self.joints[*at].element.name.clone()).collect(),
        })
    }

    /// Returns true if a joint slides as the jaw of a gripper does.
    fn is_jaw(&self, joint: usize) -> bool {
        let JointElement { moves, reach, .. } = &self.joints[joint];
        let slides = matches!(moves, Moves::Driven(JointKind::Prismatic));
        slides && reach.is_some_and(|(low, high)| high - low <= JAW.0)
    }

    /// All that is welded to a link, itself first.
    fn welded(&self, link: usize) -> Vec<usize> {
        let (mut welded, mut next) = (Vec::new(), vec![link]);
        while let Some(link) = next.pop() {
            welded.push(link);
            let fixed = self.tree.children[link].iter();
            let fixed = fixed.filter(|at| matches!(self.joints[**at].moves, Moves::Not));
            next.extend(fixed.rev().map(|at| self.tree.child_of_joint[*at]));
        }
        welded
    }

    /// Returns true if a link carries another one, or is it.
    fn carries(&self, link: usize, other: usize) -> bool {
        let above = |at: &usize| self.tree.hangs[*at].map(|joint| self.tree.parent_of_joint[joint]);
        std::iter::successors(Some(other), above).any(|at| at == link)
    }

    /// Link of a list whose name says best that it does the work; and all links whose names say so equally, if it is
    /// not clear.
    fn best_tip(&self, links: &[usize]) -> Option<(usize, Vec<usize>)> {
        let (rank, equal) = WORKS.iter().enumerate().find_map(|(rank, word)| {
            let has = |link: &&usize| self.links[**link].element.name.to_lowercase().contains(word);
            let equal: Vec<usize> = links.iter().filter(has).copied().collect();
            (!equal.is_empty()).then_some((rank, equal))
        })?;
        let first = *equal.first()?;
        let clear = equal.iter().all(|one| self.carries(first, *one) || self.carries(*one, first));
        Some((first, if clear || rank >= TIPS { Vec::new() } else { equal }))
    }
}
