//! Columns in which the proposed law is not the best choice: found in the data, not written by hand.

use crate::{Comparison, GainsKind, LawRow};
use serde::Serialize;

use super::quantity::{PageQuantity, QUANTITIES, QuantitySource};

/// Differences below this part of the larger value count as equal.
const EQUAL: f64 = 0.02;

/// A column in which other rows are better than a row of the proposed law.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LossOfLaw {
    /// Id of the proposed law's row.
    pub ours: String,
    /// The column.
    pub column: &'static str,
    /// Its unit; empty for none.
    pub unit: &'static str,
    /// Priority of a user for whom this matters.
    pub counts: &'static str,
    /// Cases (arm and world, or arm) in which some other row is better.
    pub cases: usize,
    /// Cases that could be compared.
    pub compared: usize,
    /// The largest of them.
    pub most: Beaten,
    /// The largest against a row that needs no model of the arm; `None` where there is none.
    pub model_free: Option<Beaten>,
}

/// One case: who was better, and by how much.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Beaten {
    /// The arm.
    pub arm: String,
    /// The world; `None` where the column is about the row as a whole.
    pub world: Option<String>,
    /// The better row's rival.
    pub by: String,
    /// Its value.
    pub theirs: f64,
    /// The proposed law's value; `None`: the arm did not follow under it, or its bound was broken.
    pub mine: Option<f64>,
}

impl Beaten {
    /// The larger value over the smaller one; infinite where one is zero or there is nothing to compare with.
    pub fn factor(&self) -> f64 {
        let Some(mine) = self.mine else { return f64::INFINITY };
        let (low, high) = (mine.min(self.theirs), mine.max(self.theirs));
        if low > 0.0 { high / low } else { f64::INFINITY }
    }
}

/// Returns true if the id is that of a law of the paper or of this project.
pub(super) fn is_proposed(id: &str) -> bool {
    id.starts_with("proposed")
}

/// Ids of the proposed law's rows, in their order.
pub(super) fn proposed(comparison: &Comparison) -> impl Iterator<Item = &str> {
    comparison.rivals.iter().map(|rival| rival.id.as_str()).filter(|id| is_proposed(id))
}

/// Every column in which another row is better than a row of the proposed law, in the order of the table.
///
/// Rows are compared under their tuned gains, arm by arm and world by world. A row that did not follow its
/// reference cannot be better, and loses to those that did. Values within 2 % are equal.
pub fn losses(comparison: &Comparison) -> Vec<LossOfLaw> {
    let of = |id| QUANTITIES.iter().filter_map(move |column| loss(comparison, column, id));
    proposed(comparison).flat_map(of).collect()
}

fn loss(comparison: &Comparison, column: &PageQuantity, id: &str) -> Option<LossOfLaw> {
    let (mut cases, mut compared) = (0, 0);
    let (mut most, mut model_free): (Option<Beaten>, Option<Beaten>) = (None, None);
    for row in comparison.rows.iter().filter(|row| row.rival == id && row.refused.is_none()) {
        for world in worlds(comparison, column) {
            let others: Vec<_> = better(comparison, column, row, world).collect();
            if !can_be_compared(comparison, column, row, world) {
                continue;
            }
            compared += 1;
            cases += usize::from(!others.is_empty());
            for beaten in others {
                if needs_no_model(comparison, &beaten.by) {
                    keep_larger(&mut model_free, &beaten, column);
                }
                keep_larger(&mut most, &beaten, column);
            }
        }
    }
    let (name, unit, counts) = (column.name, column.unit, column.counts);
    let ours = id.to_owned();
    most.map(|most| LossOfLaw {
        ours,
        column: name,
        unit,
        counts,
        cases,
        compared,
        most,
        model_free,
    })
}

/// The worlds that a column is compared in; one nameless one for the row as a whole.
fn worlds<'a>(comparison: &'a Comparison, column: &PageQuantity) -> Vec<Option<&'a str>> {
    match column.of {
        QuantitySource::World(_) => {
            comparison.worlds.iter().map(|world| Some(world.name.as_str())).collect()
        }
        QuantitySource::Row(_) => vec![None],
    }
}

/// Returns true if the row was run here and some row has a value.
fn can_be_compared(
    comparison: &Comparison,
    column: &PageQuantity,
    row: &LawRow,
    world: Option<&str>,
) -> bool {
    let ran = match world {
        Some(world) => row.cell(world, GainsKind::Tuned).is_some(),
        None => column.concerns(row),
    };
    ran && comparison.rows_of(&row.arm).any(|other| column.eligible(other, world).is_some())
}

/// The rows of others that are better than `row`.
fn better<'a>(
    comparison: &'a Comparison,
    column: &'a PageQuantity,
    row: &'a LawRow,
    world: Option<&'a str>,
) -> impl Iterator<Item = Beaten> + 'a {
    let mine = column.eligible(row, world);
    let others = comparison.rows_of(&row.arm).filter(|other| !is_proposed(&other.rival));
    others.filter_map(move |other| {
        let theirs = column.eligible(other, world)?;
        let wins = mine.is_none_or(|mine| {
            column.prefers(theirs, mine)
                && (theirs - mine).abs() > EQUAL * theirs.abs().max(mine.abs())
        });
        let (arm, world) = (row.arm.clone(), world.map(str::to_owned));
        wins.then(|| Beaten { arm, world, by: other.rival.clone(), theirs, mine })
    })
}

fn needs_no_model(comparison: &Comparison, id: &str) -> bool {
    comparison.rival(id).is_some_and(|rival| rival.needs.model_free())
}

/// Of two cases the one with the larger factor; of equal ones the better value, then the first.
fn keep_larger(kept: &mut Option<Beaten>, new: &Beaten, column: &PageQuantity) {
    let larger = kept.as_ref().is_none_or(|old| {
        new.factor() > old.factor()
            || (new.factor() >= old.factor() && column.prefers(new.theirs, old.theirs))
    });
    if larger {
        *kept = Some(new.clone());
    }
}
