//! Documents as Python's own dictionaries and lists.

use pyo3::prelude::*;
use serde::Serialize;

use crate::raised::internal;

/// Anything that can be written as JSON.
pub(crate) fn to_python<'py, T: Serialize + ?Sized>(
    py: Python<'py>,
    value: &T,
) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(|e| internal(py, e))?;
    py.import("json")?.call_method1("loads", (text,))
}
