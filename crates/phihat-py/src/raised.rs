//! Exceptions of `phihat._errors`, by the name of their class.

use pyo3::prelude::*;
use pyo3::types::PyDict;

/// An exception of the class `name`, made from `(message, **carried)`.
pub(crate) fn raise(
    py: Python<'_>,
    name: &str,
    message: &str,
    carried: &Bound<'_, PyDict>,
) -> PyErr {
    let made = py
        .import("phihat._errors")
        .and_then(|module| module.getattr(name))
        .and_then(|class| class.call((message,), Some(carried)));
    made.map_or_else(|why| why, PyErr::from_value)
}

/// An exception that carries nothing but its words.
pub(crate) fn plain(py: Python<'_>, class: &str, message: &str) -> PyErr {
    raise(py, class, message, &PyDict::new(py))
}

/// A document that cannot be what it says: a mistake of this package.
pub(crate) fn internal(py: Python<'_>, why: impl core::fmt::Display) -> PyErr {
    plain(py, "Error", &format!("a mistake of phihat, please report it: {why}"))
}
