//! The compiled half of the Python package `phihat`: it translates, and computes nothing.
//!
//! The interface for Python users is in `python/phihat/`; the types of this half are in
//! `python/phihat/_phihat.pyi`.
#![forbid(unsafe_code)]
#![allow(rustdoc::broken_intra_doc_links, reason = "texts that Python shows: [s] is a unit")]
#![allow(clippy::needless_pass_by_value, reason = "arguments of a Python function arrive by value")]

mod arrays;
mod bound;
mod checks;
mod controller;
mod failure;
mod gains;
mod gate;
mod json;
mod laws;
mod link;
mod own_law;
mod patience;
mod plant;
mod position_gains;
mod raised;
mod robot;
mod rollouts;
mod run;
mod sample;
mod study;
mod supervisor;
mod sweep;
mod table;
mod worlds;

use pyo3::prelude::*;

/// The compiled half of the package `phihat`.
#[pymodule]
mod _phihat {
    #[pymodule_export]
    use super::bound::bound;
    #[pymodule_export]
    use super::controller::Controller;
    #[pymodule_export]
    use super::gains::Gains;
    #[pymodule_export]
    use super::gate::Gate;
    #[pymodule_export]
    use super::link::drive;
    #[pymodule_export]
    use super::plant::Plant;
    #[pymodule_export]
    use super::position_gains::PositionGains;
    #[pymodule_export]
    use super::robot::Robot;
    #[pymodule_export]
    use super::rollouts::Rollouts;
    #[pymodule_export]
    use super::run::Trace;
    #[pymodule_export]
    use super::run::{compare, design, faults, recorded, report, reproduce, simulate};
    #[pymodule_export]
    use super::sample::Sample;
    #[pymodule_export]
    use super::study::study_document;
    #[pymodule_export]
    use super::supervisor::Supervisor;
    #[pymodule_export]
    use super::sweep::{merge, sweep, sweep_folder};
    #[pymodule_export]
    use super::table::{parquet_columns, trace_file};
    #[pymodule_export]
    use super::version;
    #[pymodule_export]
    use super::worlds::Worlds;
}

/// Version of the package.
#[pyfunction]
fn version() -> &'static str {
    env!("CARGO_PKG_VERSION")
}
