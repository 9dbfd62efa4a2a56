//! Joints that follow others, and constraints that are left out.

use std::collections::BTreeMap;

use super::classes::DefaultClasses;
use crate::markup::MarkupElement;
use crate::whole::Result;

/// A joint that follows another one: `q = reference + polynomial(q_leader − reference_leader)` of first degree.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FollowerOf {
    pub(super) leader: String,
    /// Absolute and linear coefficient.
    pub(super) line: (f64, f64),
}

/// Followers of a file by the joint's name, and what is left out of its constraints.
pub(super) fn followers(
    root: &MarkupElement,
    classes: &DefaultClasses,
) -> Result<(BTreeMap<String, FollowerOf>, Vec<String>)> {
    let (mut found, mut left_out) = (BTreeMap::new(), Vec::new());
    let sections = root.elements().filter(|section| section.name == "equality");
    for element in sections.flat_map(MarkupElement::elements) {
        let own = classes.with(element, 0)?;
        if own.word("active") == Some("false") {
            continue;
        }
        let [a, b, curved @ ..] = own.up_to("polycoef", [0.0, 1.0, 0.0, 0.0, 0.0])?;
        let pair = (element.attribute("joint1"), element.attribute("joint2"));
        match pair {
            (Some(follower), Some(leader))
                if element.name == "joint"
                    && curved.iter().all(|x| *x == 0.0)
                    && (a + b).is_finite() =>
            {
                let follower_of = FollowerOf { leader: leader.to_owned(), line: (a, b) };
                found.insert(follower.to_owned(), follower_of);
            }
            _ => {
                let ends = ["joint1", "body1", "body2", "site1", "site2", "tendon1"];
                let between: Vec<&str> =
                    ends.iter().filter_map(|key| element.attribute(key)).collect();
                left_out.push(format!(
                    "constraint <{}> (line {}) of {} is not read",
                    element.name,
                    element.place.line,
                    between.join(" and ")
                ));
            }
        }
    }
    Ok((found, left_out))
}
