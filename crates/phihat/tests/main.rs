//! All integration tests of this crate in one program, which is linked once.
#![allow(
    clippy::panic,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "tests: a panic is the report"
)]

#[path = "support/arm.rs"]
mod arm;
#[path = "support/joint.rs"]
mod joint;
mod support;

mod arrivals;
mod blends;
mod boxed_shaper;
mod bumpless;
mod by_hand;
mod designs;
mod feed_forward;
mod forms_agree;
mod garbage;
mod gate;
mod governor;
mod guard;
mod identities;
mod inertia_window;
mod limits;
mod modes;
mod monitors;
mod options;
mod page_faults;
mod parts;
mod poles;
mod positions;
mod positions_supervised;
mod range;
mod schedule_literal;
mod shaper;
mod steady_error;
mod stop_belief;
mod stop_energy;
mod stop_law;
mod stops;
mod supervisor_start;
mod survival;
mod symmetries;
mod vectors;
