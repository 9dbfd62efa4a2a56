//! All integration tests of this crate in one program, which is linked once.
#![allow(
    clippy::panic,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "tests: a panic is the report"
)]

mod claims_support;
mod sampled_support;

mod arm_range;
mod budget;
mod claims_corrupted;
mod claims_optimality;
mod claims_paper;
mod claims_performance;
mod coupled_gains;
mod coupled_panda;
mod coupled_simulator;
mod design;
mod estimate;
mod export;
mod gate;
mod limit;
mod mistyped;
mod moving;
mod paper_recipe;
mod positions_search;
mod random_arms;
mod rotor_interval;
mod sampled_margins;
mod sampled_matrix;
mod sampled_noise;
mod sampled_peaks;
mod sampled_reference;
mod sampled_simulator;
mod sampled_varying;
mod sampled_window;
mod start_gains;
mod tip;
mod trade_off;
mod tube_scope;
