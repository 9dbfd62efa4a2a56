//! Table 1: its rows as printed, column by column against the laws here.

use phihat_rivals::Tick;

mod columns;
mod cost;
mod described;
mod rated;
mod row;

use row::Table1Row;

use super::compose::{number, words};
use super::published::Published;
use super::record::{Section, Statement, Table, Verdict};
use crate::part::{PaperPart, PartError};

/// The references of every row of the table, in its order; the last row is the paper's own law.
const ROWS: [&[&str]; 13] = [
    &["[23]"],
    &["[2]"],
    &["[25]"],
    &["[29]"],
    &["[28]"],
    &["[26]"],
    &["[27]"],
    &["[30]"],
    &["[22]"],
    &["[44]"],
    &["[20]"],
    &["[5]", "[12]"],
    &["proposed"],
];

/// Table 1, on the planar arm.
pub(super) fn table1(progress: &dyn Fn(f64)) -> Result<PaperPart, PartError> {
    let rows: Vec<Table1Row> =
        ROWS.iter().map(|row| Table1Row::of(row)).collect::<Result<_, _>>()?;
    let rated = rated::rate(&rows, progress)?;
    let beside: Vec<_> = rows.iter().zip(rated.iter().map(Vec::as_slice)).collect();
    let columns = [
        "row",
        "quantitative",
        "easy tuning",
        "optimal",
        "model free",
        "what the law here is handed",
    ];
    let table = Table {
        id: "table-1-rows".to_owned(),
        title: "The rows of Table 1 as printed, \"-\" being \"not completely true or known\""
            .to_owned(),
        columns: words(&columns),
        rows: rows.iter().map(Table1Row::cells).collect(),
    };
    let section = Section {
        id: "table-1".to_owned(),
        title: "Table 1: the state of the art".to_owned(),
        text: words(&[
            "A tick is not a number. A law for every row of the table runs here on the planar arm, tuned by the same \
             optimiser with few runs, and what the ticks stand for is measured: a bound that was stated before the \
             run, the share of gains near the default that work, a certificate that was checked. `phihat compare \
             studies/table1.toml` does the same at length. Where the published law was not found (grade C), a law of \
             its class stands for it: what differs there leaves the row undecided.",
        ]),
        statements: vec![
            described::described(&rows),
            columns::quantitative(&beside),
            columns::easy(&beside),
            columns::optimal(&beside),
            model_free(&rows),
            cost::low(&beside),
            described::pid_model_free(&rows),
        ],
        tables: vec![table],
        figures: Vec::new(),
    };
    Ok(PaperPart { assumptions: Vec::new(), sections: vec![section] })
}

fn model_free(rows: &[Table1Row]) -> Statement {
    let decided: Vec<_> = rows.iter().filter_map(|row| Some((row, row.right()?))).collect();
    let wrong: Vec<_> = decided
        .iter()
        .filter(|(row, right)| *right < row.laws.len())
        .map(|(row, _)| *row)
        .collect();
    let open: Vec<_> =
        rows.iter().filter(|row| row.right().is_none()).map(|row| row.name.as_str()).collect();
    let laws = |row: &&Table1Row| {
        let says = row.printed.model_free == Tick::Yes;
        let off = row.laws.iter().filter(|entry| entry.needs.model_free() != says);
        let off: Vec<_> = off.map(|entry| entry.card.id).collect();
        format!("{} ({})", row.name, off.join(", "))
    };
    let named: Vec<_> = wrong.iter().map(laws).collect();
    let none = || "none".to_owned();
    Published {
        id: "table1-model-free",
        place: "Table 1, last column",
        claim: "Which approaches need no model",
        paper: "13 rows of ✓, ✗ or -",
    }
    .found(
        format!(
            "{} of {} rows with ✓ or ✗ agree; not, or not for every law of the row: {}; \"-\": {}",
            decided.len() - wrong.len(),
            decided.len(),
            if named.is_empty() { none() } else { named.join("; ") },
            if open.is_empty() { none() } else { open.join(", ") },
        ),
        Verdict::of(wrong.is_empty(), wrong.len() < decided.len()),
        "Here a law is model-free by its type: it is handed no dynamics and no kinematics. A nominal inertia per \
         joint, and the range of inertia from which the gains of the paper's law may be designed, are not counted as a \
         model. Row [5], [12] has one mark for two laws: [12] needs no model, [5] simulates a nominal arm. Where the \
         published law was not found, the mark is held against the law that stands for it.",
        vec![
            number("rows", "", rows.len() as f64, 0.0),
            number("rows with ✓ or ✗", "", decided.len() as f64, 0.0),
            number("of these, rows with a law that differs", "", wrong.len() as f64, 0.0),
        ],
    )
}
