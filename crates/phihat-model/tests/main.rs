//! All integration tests of this crate in one program, which is linked once.
#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "tests: a panic is the report"
)]

mod support;

mod bad_urdf;
mod broken_robots;
mod closed_form;
mod energy;
mod estimates;
mod forward_and_inverse;
mod gravity;
mod inertia_range;
mod inverse_kinematics;
mod jacobian;
mod known;
mod lockstep;
mod look;
mod mass_matrix;
mod mjcf;
mod no_allocation;
mod parts;
mod pinocchio;
mod quirks;
mod regressor;
mod robots;
mod single_precision;
mod trigonometry;
mod variants;
mod xacro;
