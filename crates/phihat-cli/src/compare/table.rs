//! A comparison on the terminal.

use crate::table::Fitted;
use comfy_table::{CellAlignment, ColumnConstraint};
use phihat_compare::{Comparison, GainsKind, LawRow};
use serde_json::json;

/// A table per arm, in the world that gains are tuned in, and where another row is better than the proposed law.
pub(super) fn overview(comparison: &Comparison) -> String {
    let world = phihat_compare::main_world(comparison).unwrap_or_default();
    let mut text = Vec::new();
    for arm in &comparison.arms {
        text.push(format!("{}, world `{world}`, gains tuned; * is the best of a column", arm.name));
        text.push(table(&phihat_compare::comparison_table(comparison, &arm.name, world)));
    }
    let refused = comparison.rows.iter().filter_map(|row| Some((row, row.refused.as_ref()?)));
    text.extend(refused.map(|(row, why)| format!("{} on {}: {why}", row.rival, row.arm)));
    text.extend(comparison.rows.iter().filter_map(at_end));
    let mut beaten: Vec<(String, Vec<&str>)> = Vec::new();
    for loss in phihat_compare::losses(comparison) {
        match beaten.iter_mut().find(|(ours, _)| *ours == loss.ours) {
            Some((_, columns)) => columns.push(loss.column),
            None => beaten.push((loss.ours, vec![loss.column])),
        }
    }
    for (ours, columns) in beaten {
        text.push(format!("another row is better than {ours} in: {}", columns.join(", ")));
    }
    text.join("\n")
}

/// Tuned scalars of a row that are at an end of their range.
fn at_end(row: &LawRow) -> Option<String> {
    let ends = &row.tuning.as_ref()?.at_end;
    let each = ends.iter().map(|end| {
        format!("{} at its {} end", end.scalar, if end.upper { "upper" } else { "lower" })
    });
    let each: Vec<_> = each.collect();
    (!each.is_empty()).then(|| format!("{} on {}: {}", row.rival, row.arm, each.join(", ")))
}

fn table(lines: &[Vec<String>]) -> String {
    let [heading, lines @ ..] = lines else { return String::new() };
    let mut table = Fitted::new(heading);
    for line in lines {
        table.add_row(line);
    }
    // An id is one word.
    if let Some(column) = table.column_mut(0) {
        column.set_constraint(ColumnConstraint::ContentWidth);
    }
    for column in table.column_iter_mut().skip(4) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table.wrapped_or_below(WIDTH)
}

/// Columns of the table.
const WIDTH: u16 = 150;

/// A row in few words, for programs; compare.json has all of it.
pub(super) fn row(row: &LawRow) -> serde_json::Value {
    let tuned = || row.cells.iter().filter(|cell| cell.gains == GainsKind::Tuned);
    let cells = tuned()
        .map(|cell| json!({ "world": cell.world, "fate": cell.outcome, "worst": cell.worst }));
    json!({
        "arm": row.arm,
        "rival": row.rival,
        "refused": row.refused,
        "at_end_of_range": row.tuning.as_ref().map(|tuning| &tuning.at_end),
        "worlds_followed": tuned().filter(|cell| cell.outcome.followed()).count(),
        "tuned": cells.collect::<Vec<_>>(),
    })
}
