//! phihat for Python.
#![forbid(unsafe_code)]

use pyo3::prelude::*;

/// The compiled half of the package `phihat`.
#[pymodule]
mod _phihat {
    #[pymodule_export]
    use super::version;
}

/// Version.
#[pyfunction]
fn version() -> &'static str {
    env!("CARGO_PKG_VERSION")
}
