//! "Low computational cost", from instructions that were counted.

use super::rated::Rated;
use super::row::Table1Row;
use crate::compose::number;
use crate::published::Published;
use crate::record::{Statement, Verdict};

/// The paper's law against the laws of the other rows.
pub(super) fn low(rows: &[(&Table1Row, &[Rated])]) -> Statement {
    let laws = |own: bool| {
        let rows = rows.iter().filter(move |(row, _)| (row.name == "proposed") == own);
        let laws = rows.flat_map(|(_, laws)| laws.iter());
        laws.filter_map(|law| Some((law.entry.card.id, law.instructions?))).collect::<Vec<_>>()
    };
    let (own, mut others) = (laws(true), laws(false));
    others.sort_by_key(|(_, count)| *count);
    let most = own.iter().map(|(_, count)| *count).max();
    let median = others.get(others.len().saturating_sub(1) / 2).map(|(_, count)| *count);
    let fewer = others.iter().filter(|(_, count)| most.is_some_and(|most| *count < most));
    let fewer: Vec<_> = fewer.map(|(id, count)| format!("{id} {count}")).collect();
    let listed: Vec<_> = own.iter().map(|(id, count)| format!("{id} {count}")).collect();
    let low = most.zip(median).is_some_and(|(most, median)| most < median);
    let show = |count: Option<u64>| count.map_or("none".to_owned(), |count| count.to_string());
    Published {
        id: "low-cost",
        place: "Secs. II-B, VI",
        claim: "The law can be implemented at low computational cost",
        paper: "low computational cost",
    }
    .found(
        format!(
            "instructions per update of three joints: {}; median of the {} others of Table 1 {}; with fewer: {}",
            listed.join(", "),
            others.len(),
            show(median),
            if fewer.is_empty() { "none".to_owned() } else { fewer.join(", ") }
        ),
        Verdict::of(low, false),
        "Counted in the program's own code with default gains, by an instruction counter. It needs no regressor and no \
            model.",
        vec![
            number("most instructions of the paper's law", "", most.map(|count| count as f64), 0.05),
            number("median of the others", "", median.map(|count| count as f64), 0.05),
        ],
    )
    .read_as("fewer instructions per update than half of the laws of Table 1")
    .varying("the order of the law, and who chose its gains")
    .turning(format!("{} instructions, the median of the others", show(median)))
}
