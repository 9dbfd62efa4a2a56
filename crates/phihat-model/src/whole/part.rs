//! Cuts the arm out of a tree: which joints are driven, and where the others stand.

use std::collections::BTreeMap;

use super::tree::Tree;
use super::{JointElement, LinkElement, Moves, Result};
use crate::error::RobotError;
use crate::part::Part;

/// So many names are shown of a longer list.
const SHOWN: usize = 4;

/// Role of each joint of a tree.
pub(super) struct Cut {
    /// True if the joint is one of the arm's.
    pub(super) driven: Vec<bool>,
    /// Position of a joint that moves but is none of the arm's \[rad, m\].
    pub(super) at: Vec<f64>,
}

/// Description that a part is cut out of.
pub(super) struct WholeDescription<'e> {
    pub(super) links: &'e [LinkElement],
    pub(super) joints: &'e [JointElement],
    pub(super) tree: &'e Tree,
    pub(super) origin: &'e str,
    pub(super) follows: &'static str,
}

impl WholeDescription<'_> {
    /// Cuts a part; what is locked or held without having been asked for is warned about.
    pub(super) fn cut(&self, part: &Part, warnings: &mut Vec<String>) -> Result<Cut> {
        let mut driven = self.asked(part)?;
        for (at, joint) in self.joints.iter().enumerate() {
            driven[at] &= matches!(joint.moves, Moves::Driven(_));
        }
        for (name, position) in &part.locked {
            let at = self.joint(name)?;
            let element = &self.joints[at].element;
            if !matches!(self.joints[at].moves, Moves::Driven(_) | Moves::Follows { .. }) {
                let why = "it is locked, but no position of it could be";
                return Err(element.error(why.to_owned()));
            }
            if (self.joints[at].nearest(*position) - position).abs() > 0.0 {
                return Err(element.error(format!("locked at {position}, outside its limits")));
            }
            driven[at] = false;
        }
        if !driven.contains(&true) {
            return Err(self.nothing_moves());
        }
        self.nothing_floats(&driven)?;
        let at = self.stand(part);
        self.tell((&driven, &at), part, warnings);
        Ok(Cut { driven, at })
    }

    /// Joints that are asked for, whatever they are.
    fn asked(&self, part: &Part) -> Result<Vec<bool>> {
        if let Some(names) = &part.joints {
            let mut driven = vec![false; self.joints.len()];
            for name in names {
                let at = self.joint(name)?;
                self.drives(at)?;
                driven[at] = true;
            }
            return Ok(driven);
        }
        let base = part.base.as_ref().map_or(Ok(self.tree.root), |name| self.link(name))?;
        let Some(tip) = &part.tip else {
            let below = self.below(base);
            return Ok(self.tree.child_of_joint.iter().map(|child| below[*child]).collect());
        };
        let path = self.tree.to_link(self.link(tip)?);
        let start = path.iter().position(|at| self.tree.parent_of_joint[*at] == base);
        let Some(start) = start else {
            let base = &self.links[base].element.name;
            return Err(self.error(format!("link \"{tip}\" is not carried by link \"{base}\"")));
        };
        let mut driven = vec![false; self.joints.len()];
        path[start..].iter().for_each(|at| driven[*at] = true);
        let moves = |at: &usize| matches!(self.joints[*at].moves, Moves::Driven(_));
        if !path[start..].iter().any(moves) {
            let base = &self.links[base].element.name;
            let why = format!("no joint moves between link \"{base}\" and link \"{tip}\"");
            return Err(self.error(why));
        }
        Ok(driven)
    }

    /// Links that a link carries.
    fn below(&self, link: usize) -> Vec<bool> {
        let mut below = vec![false; self.links.len()];
        for at in &self.tree.order {
            let parent = self.tree.hangs[*at].map(|joint| self.tree.parent_of_joint[joint]);
            below[*at] = parent.is_some_and(|parent| parent == link || below[parent]);
        }
        below
    }

    /// A joint that was named must be one that a drive moves.
    fn drives(&self, at: usize) -> Result<()> {
        let joint = &self.joints[at];
        let why = match &joint.moves {
            Moves::Driven(_) => return Ok(()),
            Moves::Not => "it is fixed, so it is no joint of an arm".to_owned(),
            Moves::Free(kind) => format!("it is {kind}, so it is no joint of an arm"),
            Moves::Follows { leader, .. } => {
                format!(
                    "it follows joint \"{leader}\" ({}), so it is no joint of its own",
                    self.follows
                )
            }
        };
        Err(joint.element.error(why))
    }

    /// Refuses a joint that floats between the arm's first joint and its last; before and after them it can
    /// be fixed.
    fn nothing_floats(&self, driven: &[bool]) -> Result<()> {
        // For each link, whether a driven joint is before it, and the joint that floats since.
        let mut before = vec![false; self.links.len()];
        let mut floats: Vec<Option<(usize, &str)>> = vec![None; self.links.len()];
        for at in &self.tree.order {
            let Some(joint) = self.tree.hangs[*at] else { continue };
            let parent = self.tree.parent_of_joint[joint];
            (before[*at], floats[*at]) = (driven[joint] || before[parent], floats[parent]);
            match (&self.joints[joint].moves, floats[parent]) {
                (Moves::Free(kind), _) if before[parent] => floats[*at] = Some((joint, kind)),
                (_, Some((free, kind))) if driven[joint] => {
                    let own = &self.joints[joint].element.name;
                    return Err(self.joints[free].element.error(format!(
                        "it is {kind}, between joints of the arm: \"{own}\" is behind it; name a base and a tip on one \
                            side of it"
                    )));
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Position of every joint that moves, when it is not driven: as requested, else as near to where
    /// it is drawn as its limits permit; of a joint that follows another, the position that the other
    /// one gives it.
    fn stand(&self, part: &Part) -> Vec<f64> {
        let places: BTreeMap<&str, usize> =
            self.joints.iter().enumerate().map(|(at, j)| (&*j.element.name, at)).collect();
        let own = |at: usize| {
            let joint = &self.joints[at];
            let asked = part.locked.get(&joint.element.name).copied();
            match joint.moves {
                Moves::Not | Moves::Free(_) => 0.0,
                Moves::Driven(_) | Moves::Follows { .. } => {
                    asked.unwrap_or_else(|| joint.nearest(joint.drawn_at))
                }
            }
        };
        let stand = |(at, joint): (usize, &JointElement)| match &joint.moves {
            Moves::Follows { leader, factor, offset, .. }
                if !part.locked.contains_key(&joint.element.name) =>
            {
                places.get(&**leader).map_or(0.0, |leader| factor * own(*leader) + offset)
            }
            _ => own(at),
        };
        self.joints.iter().enumerate().map(stand).collect()
    }

    fn tell(&self, (driven, at): (&[bool], &[f64]), part: &Part, warnings: &mut Vec<String>) {
        let list = |wanted: &dyn Fn(usize, &JointElement) -> bool| -> Vec<String> {
            let own = self.joints.iter().enumerate().filter(|(i, joint)| wanted(*i, joint));
            own.map(|(i, joint)| format!("\"{}\" at {}", joint.element.name, at[i])).collect()
        };
        let locked = |joint: &JointElement| part.locked.contains_key(&joint.element.name);
        let outside = list(&|i, joint| {
            matches!(joint.moves, Moves::Driven(_)) && !driven[i] && !locked(joint)
        });
        let following =
            list(&|_, joint| matches!(joint.moves, Moves::Follows { .. }) && !locked(joint));
        let follow = format!("following others ({}), held where they stand", self.follows);
        for (names, what) in
            [(outside, "outside of the arm, held where they stand"), (following, &follow)]
        {
            if !names.is_empty() {
                warnings.push(format!("{} joint(s) {what}: {}", names.len(), shown(&names)));
            }
        }
        let free = self.joints.iter().filter_map(|joint| match joint.moves {
            Moves::Free(kind) => {
                Some(format!("joint \"{}\": {kind}, held fixed", joint.element.name))
            }
            _ => None,
        });
        warnings.extend(free);
    }

    /// Nothing is left to be driven; what might have been.
    fn nothing_moves(&self) -> RobotError {
        let held = self.joints.iter().filter_map(|joint| match &joint.moves {
            Moves::Free(kind) => Some(format!("\"{}\" is {kind}", joint.element.name)),
            Moves::Follows { leader, .. } => {
                let own = &joint.element.name;
                Some(format!("\"{own}\" follows \"{leader}\" ({})", self.follows))
            }
            Moves::Not | Moves::Driven(_) => None,
        });
        let held: Vec<String> = held.collect();
        let held = if held.is_empty() { String::new() } else { format!(": {}", shown(&held)) };
        self.error(format!(
            "no joint moves by a drive of its own; one that is revolute, continuous or prismatic must{held}"
        ))
    }

    fn error(&self, why: String) -> RobotError {
        RobotError::Tree { origin: self.origin.to_owned(), why }
    }

    /// A link by its name, or by that of the joint that moves it.
    pub(super) fn link(&self, name: &str) -> Result<usize> {
        let at = self.links.iter().position(|link| link.element.name == name);
        let moved = || {
            let at = self.joints.iter().position(|joint| joint.element.name == name);
            at.map(|at| self.tree.child_of_joint[at])
        };
        at.or_else(moved).ok_or_else(|| {
            let names = self.links.iter().map(|link| &*link.element.name);
            self.error(format!("there is no link \"{name}\"{}", close(name, names)))
        })
    }

    fn joint(&self, name: &str) -> Result<usize> {
        let at = self.joints.iter().position(|joint| joint.element.name == name);
        at.ok_or_else(|| {
            let names = self.joints.iter().map(|joint| &*joint.element.name);
            self.error(format!("there is no joint \"{name}\"{}", close(name, names)))
        })
    }
}

/// The first few of a list.
fn shown(names: &[String]) -> String {
    let first = names[..names.len().min(SHOWN)].join(", ");
    if names.len() > SHOWN { format!("{first}, …") } else { first }
}

/// The known name closest to what somebody wrote, as a question.
fn close<'n>(name: &str, known: impl Iterator<Item = &'n str>) -> String {
    let score = |known: &&str| strsim::jaro_winkler(name, known);
    let best = known.max_by(|a, b| score(a).total_cmp(&score(b)));
    best.filter(|best| score(best) > 0.6)
        .map_or_else(String::new, |best| format!(", did you mean \"{best}\"?"))
}
