//! Arguments that make a law, checked.

use pyo3::prelude::*;

use crate::failure;

/// Refuses an argument that has not one value per joint.
pub(crate) fn per_joint_values(
    py: Python<'_>,
    field: &str,
    found: Option<usize>,
    joints: usize,
) -> PyResult<()> {
    let Some(found) = found.filter(|found| *found != joints) else { return Ok(()) };
    let limit = format!("{joints} values, one per joint");
    let message = format!("{field}: {found} values; it must be {limit}");
    Err(failure::argument(py, field, None, found, &limit, &message))
}

/// Time between samples at a rate [ns].
pub(crate) fn period_ns(py: Python<'_>, rate_hz: f64) -> PyResult<u64> {
    let period = 1e9 / rate_hz;
    if !(1.0..=1e10).contains(&period) {
        let limit = "0.1 Hz to 1 GHz";
        let message = format!("rate_hz: {rate_hz} Hz; it must be {limit}");
        return Err(failure::argument(py, "rate_hz", None, rate_hz, limit, &message));
    }
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "checked just now: a moderate positive number"
    )]
    let nanoseconds = period.round() as u64;
    Ok(nanoseconds)
}
