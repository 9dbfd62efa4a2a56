//! Coverage of the paper's numbered items by the statements: how many, and which are left out.

use std::collections::BTreeSet;

use serde::Serialize;

use crate::item::{Item, Kind};
use crate::record::Reproduction;

/// Coverage of one kind.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Coverage {
    /// The kind.
    pub kind: Kind,
    /// Number of items that some statement covers.
    pub covered: usize,
    /// Number of all items.
    pub all: usize,
    /// The others.
    pub left_out: Vec<NotCovered>,
}

/// An item that no statement covers.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct NotCovered {
    /// The item.
    pub item: Item,
    /// Why.
    pub why: String,
}

/// Items that state nothing that could be tested.
const NOTHING_STATED: [(Kind, u8, &str); 4] = [
    (Kind::Equation, 23, "names a general system; nothing is stated of it"),
    (Kind::Figure, 1, "a block diagram of (1) to (8)"),
    (Kind::Figure, 2, "a block diagram of (12)"),
    (Kind::Figure, 3, "photographs of the arms"),
];

fn why(reproduction: &Reproduction, item: Item) -> String {
    let known = NOTHING_STATED
        .iter()
        .find(|(kind, number, _)| (*kind, *number) == (item.kind, item.number));
    match (known, &reproduction.only) {
        (Some((.., why)), _) => (*why).to_owned(),
        (None, Some(_)) => "not in the part that was done".to_owned(),
        (None, None) => "no statement looks at it".to_owned(),
    }
}

/// Coverage by the statements, kind by kind; counted from their own references.
pub fn coverage(reproduction: &Reproduction) -> Vec<Coverage> {
    let statements = reproduction.sections.iter().flat_map(|section| &section.statements);
    let covered: BTreeSet<Item> = statements.flat_map(|s| s.covers.iter().copied()).collect();
    let of = |kind: Kind| {
        let items = (1..=kind.count()).map(|number| Item { kind, number });
        let (in_it, out): (Vec<_>, Vec<_>) = items.partition(|item| covered.contains(item));
        let left_out =
            out.into_iter().map(|item| NotCovered { item, why: why(reproduction, item) }).collect();
        Coverage { kind, covered: in_it.len(), all: usize::from(kind.count()), left_out }
    };
    Kind::ALL.map(of).into()
}
