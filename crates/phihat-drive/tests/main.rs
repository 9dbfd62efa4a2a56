//! All integration tests of this crate in one program, which is linked once.

mod support;

mod facts;
mod first_motion;
mod franka;
mod franka_cycles;
mod links;
mod no_allocation;
mod same_trace;
