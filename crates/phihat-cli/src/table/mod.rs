//! Tables and sentences for the terminal. Units are converted here for reading, nothing else.

mod budget;
mod coarser;
mod coupled;
mod design;
mod limit;
mod metrics;
mod robots;

use comfy_table::presets::UTF8_BORDERS_ONLY;
use comfy_table::{CellAlignment, Table};

pub(crate) use budget::budget;
pub(crate) use coarser::coarser;
pub(crate) use design::{certificate, gains, not_counted};
pub(crate) use limit::limit;
pub(crate) use metrics::{metrics, tip, tube, verdict};
pub(crate) use robots::{chains, joints, robots};

/// Thousandths, for reading: mrad, mrad·s, mrad/s.
const MILLI: f64 = 1e3;

fn plain_table<T: Into<comfy_table::Row>>(headers: T) -> Table {
    let mut table = Table::new();
    table.load_style(UTF8_BORDERS_ONLY);
    table.set_header(headers);
    table
}

/// Figures to the right, names to the left, one space around.
fn align(table: &mut Table) {
    for column in table.column_iter_mut() {
        column.set_padding((0, 1));
    }
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
}
