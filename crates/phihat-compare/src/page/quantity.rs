//! Columns by which rows are compared: one list for the tables, the marks of the best, and the losses.

use crate::{Comparison, Figures, GainsKind, LawCell, LawRow, MarkColumns};

use phihat_report::kit::MILLI;

/// Direction in which values are better.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Better {
    /// The smaller one.
    Less,
    /// The larger one.
    More,
}

/// Values that differ less than this, over the best, are marked alike.
const NEAR: f64 = 5e-3;

/// A column.
#[derive(Debug, Clone, Copy)]
pub(super) struct PageQuantity {
    /// Heading.
    pub name: &'static str,
    /// Heading where there is little room, with its unit; empty: not shown there.
    pub short: &'static str,
    /// Unit; empty for none.
    pub unit: &'static str,
    /// Priority of those who sort by it.
    pub counts: &'static str,
    pub better: Better,
    pub of: QuantitySource,
}

/// Source of a column's value.
#[derive(Debug, Clone, Copy)]
pub(super) enum QuantitySource {
    /// The worst figures of a world under the tuned gains.
    World(fn(&Figures) -> Option<f64>),
    /// The row as a whole.
    Row(fn(&LawRow) -> Option<f64>),
}

const fn world(
    (name, short): (&'static str, &'static str),
    unit: &'static str,
    counts: &'static str,
    of: fn(&Figures) -> Option<f64>,
) -> PageQuantity {
    PageQuantity { name, short, unit, counts, better: Better::Less, of: QuantitySource::World(of) }
}

const fn row(
    (name, short): (&'static str, &'static str),
    counts: &'static str,
    better: Better,
    of: fn(&LawRow) -> Option<f64>,
) -> PageQuantity {
    PageQuantity { name, short, unit: "", counts, better, of: QuantitySource::Row(of) }
}

const RUNS_TO_SPEC: &str = "runs to spec";

/// Every column, in the order of the table.
pub(super) const QUANTITIES: [PageQuantity; 13] = [
    world(("rms error", "rms [mrad]"), "mrad", "the error over the whole motion", |f| {
        Some(MILLI * f.error_rms_rad)
    }),
    world(("largest error", "max [mrad]"), "mrad", "the largest error", |f| {
        Some(MILLI * f.error_peak_rad)
    }),
    // What the cap of the tuning is about: what a smooth motion asks for is not in it.
    world(("torque noise", "noise [%]"), "% of limit", "a torque without noise", |f| {
        Some(100.0 * f.noise)
    }),
    world(("effort", "effort [%]"), "% of limit", "little torque", |f| Some(100.0 * f.effort)),
    world(("chatter", "chatter [N·m]"), "N·m", "a quiet drive", |f| Some(f.chatter_nm)),
    world(("recovery", ""), "s", "a quick return after a push", |f| f.recovery_s),
    // A bound that was broken is no bound: it is shown, and never better.
    world(("bound / measured", "bound/meas."), "", "a tight bound stated before the run", |f| {
        f.bound_over_measured
    }),
    row(("share of draws", "draws"), "gains that need no search", Better::More, |row| {
        chosen(row).map(|columns| columns.share_of_draws)
    }),
    row((RUNS_TO_SPEC, ""), "few runs until the gains do", Better::Less, |row| {
        chosen(row)?;
        row.tuning.as_ref()?.runs_to_spec.map(|runs| runs as f64)
    }),
    row(("scalars", ""), "few numbers to choose", Better::Less, |row| {
        chosen(row).map(|columns| columns.scalars as f64)
    }),
    row(("states", ""), "little memory", Better::Less, |row| {
        row.cost.as_ref().map(|cost| cost.states as f64)
    }),
    row(("instructions", ""), "a small processor", Better::Less, |row| {
        row.cost.as_ref()?.instructions.map(|count| count as f64)
    }),
    row(
        ("worlds followed", "worlds"),
        "the number of worlds in which the arm follows",
        Better::More,
        |row| (!row.cells.is_empty()).then(|| worlds_followed(row) as f64),
    ),
];

/// The columns of a row with something to choose: designed gains are not compared by how hard they are to find.
fn chosen(row: &LawRow) -> Option<&MarkColumns> {
    row.columns.as_ref().filter(|columns| columns.scalars > 0)
}

/// Worlds in which every run with the tuned gains followed its reference.
pub(super) fn worlds_followed(row: &LawRow) -> usize {
    let tuned = row.cells.iter().filter(|cell| cell.gains == GainsKind::Tuned);
    tuned.filter(|cell| cell.outcome.followed()).count()
}

impl PageQuantity {
    /// Returns true if a row can be compared by it as a whole: a value that was not counted, or not chosen,
    /// is neither better nor worse.
    pub(super) fn concerns(&self, row: &LawRow) -> bool {
        // A tuning that never kept the specification has no number of runs, and that is worse than any.
        let searched = self.name == RUNS_TO_SPEC && chosen(row).is_some();
        searched || self.of_cell(row, None).is_some()
    }

    /// The value that is shown of a cell, finite; whatever became of the arm.
    pub(super) fn of_cell(&self, row: &LawRow, cell: Option<&LawCell>) -> Option<f64> {
        let value = match self.of {
            QuantitySource::World(of) => of(cell?.worst.as_ref()?),
            QuantitySource::Row(of) => of(row),
        };
        value.filter(|value| value.is_finite())
    }

    /// The value that may be compared: of an arm that followed, and of a bound that was kept.
    pub(super) fn eligible(&self, row: &LawRow, world: Option<&str>) -> Option<f64> {
        let QuantitySource::World(_) = self.of else { return self.of_cell(row, None) };
        let cell = row.cell(world?, GainsKind::Tuned).filter(|cell| cell.outcome.followed())?;
        let value = self.of_cell(row, Some(cell))?;
        (self.name != "bound / measured" || value >= 1.0).then_some(value)
    }

    /// Returns true if `a` is better than `b`.
    pub(super) fn prefers(&self, a: f64, b: f64) -> bool {
        match self.better {
            Better::Less => a < b,
            Better::More => a > b,
        }
    }

    /// Returns true if a value is the best one, or too near to it for a reader to distinguish them.
    pub(super) fn is_best(&self, mine: Option<f64>, best: Option<f64>) -> bool {
        let near = |mine: f64, best: f64| (mine - best).abs() <= NEAR * best.abs();
        mine.zip(best).is_some_and(|(mine, best)| near(mine, best) || self.prefers(mine, best))
    }

    /// The best value of an arm's rows in a world.
    pub(super) fn best(&self, comparison: &Comparison, arm: &str, world: &str) -> Option<f64> {
        let values = comparison.rows_of(arm).filter_map(|row| self.eligible(row, Some(world)));
        values.reduce(|best, value| if self.prefers(value, best) { value } else { best })
    }
}
