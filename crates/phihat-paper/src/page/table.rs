//! Tables of text on the pages of the paper.

use maud::{Markup, html};
use phihat_report::kit::anchor;
use phihat_report::kit::text::prose;

use crate::record::Table;

/// A table; columns of words are left-aligned.
pub(crate) fn values(table: &Table) -> Markup {
    let title = prose(&table.title);
    let prosaic: Vec<bool> = (0..table.columns.len()).map(|place| is_text(table, place)).collect();
    let class = |place: usize| prosaic.get(place).is_some_and(|text| *text).then_some("text");
    html! {
        div.scroll id=(anchor("table", &table.id)) tabindex="0" role="region" aria-label=(format!("Table: {title}")) {
            table {
                caption { span { (title) } }
                thead { tr { @for (place, column) in table.columns.iter().enumerate() {
                    th scope="col" class=[class(place)] { (prose(column)) }
                } } }
                tbody { @for row in &table.rows { tr {
                    @for (place, cell) in row.iter().enumerate() {
                        @if place == 0 {
                            th scope="row" { (prose(cell)) }
                        } @else {
                            td class=[class(place)] { (prose(cell)) }
                        }
                    }
                } } }
            }
        }
    }
}

/// Returns true if a column contains words: most of its cells begin with no figure.
fn is_text(table: &Table, place: usize) -> bool {
    let cells = table.rows.iter().filter_map(|row| row.get(place)).map(|cell| cell.trim());
    let cells: Vec<&str> = cells.filter(|cell| !cell.is_empty()).collect();
    let figure = |cell: &&&str| {
        let rest = cell.trim_start_matches(['−', '-', '+', '±', '<', '>', '≤', '≥', ' ']);
        let words = cell.split_whitespace().count();
        **cell == "none" || (rest.starts_with(|c: char| c.is_ascii_digit()) && words <= 4)
    };
    2 * cells.iter().filter(figure).count() < cells.len()
}
