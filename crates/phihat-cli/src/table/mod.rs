//! Tables and sentences for the terminal. Units are converted here for reading, nothing else.

mod coarser;
mod coupled;
mod design;
mod fitted;
mod limit;
mod metrics;
mod robots;

pub(crate) use coarser::coarser;
pub(crate) use design::{certificate, gains, not_counted};
pub(crate) use fitted::Fitted;
pub(crate) use limit::limit;
pub(crate) use metrics::{metrics, tube, verdict};
pub(crate) use robots::{chains, joints, robots};

/// Thousandths, for reading: mrad, mrad·s, mrad/s.
const MILLI: f64 = 1e3;

fn plain_table<T: Into<comfy_table::Row>>(headers: T) -> Fitted {
    Fitted::new(headers)
}

/// Figures to the right, names to the left, one space around.
fn align(table: &mut Fitted) {
    table.align();
}
