//! The phihat controller for C and C++: `include/phihat.h` and this library.
//!
//! This crate translates: it reads the caller's pointers, checks them, and calls `phihat`. All `unsafe` of
//! the project is here, most of it in `border.rs`.
//!
//! # Guarantee
//!
//! - No panic crosses the border: it would become [`Status::Internal`].
//! - Only [`phihat_controller_create`], [`phihat_supervisor_create`] and [`phihat_gate_create`] allocate,
//!   only their counterparts free.
//! - A call that does not answer [`Status::Ok`] or [`Status::Refused`] has written nothing but its
//!   `phihat_error`.
//!
//! # Not claimed
//!
//! A pointer that is neither null nor valid cannot be told from a valid one.
#![allow(unsafe_code, reason = "C hands over pointers; see the module's text")]
#![allow(rustdoc::broken_intra_doc_links, reason = "texts of the C header: [s] is a unit")]
#![allow(non_camel_case_types, reason = "these are names of the C header")]

mod border;
mod controller;
mod error;
mod gate;
mod guard;
mod laws;
mod supervisor;
mod types;

pub use controller::{
    phihat_controller, phihat_controller_create, phihat_controller_destroy,
    phihat_controller_joints, phihat_controller_reset, phihat_controller_resume,
    phihat_controller_update,
};
pub use error::{Status, phihat_error, phihat_status_text, phihat_version};
pub use gate::{
    phihat_gate, phihat_gate_create, phihat_gate_destroy, phihat_gate_hold, phihat_gate_limits,
    phihat_gate_release,
};
pub use guard::{
    phihat_guard, phihat_guard_default, phihat_supervision, phihat_supervision_default,
};
pub use supervisor::{
    PHIHAT_MODE_ARMED, PHIHAT_MODE_HOLDING, PHIHAT_MODE_IDLE, PHIHAT_MODE_SAFE_STOP,
    PHIHAT_MODE_TRACKING, PHIHAT_REQUEST_ARM, PHIHAT_REQUEST_HOLD, PHIHAT_REQUEST_IDLE,
    PHIHAT_REQUEST_STOP, PHIHAT_REQUEST_TRACK, phihat_event_text, phihat_report, phihat_request,
    phihat_supervisor, phihat_supervisor_create, phihat_supervisor_destroy, phihat_supervisor_step,
};
pub use types::{
    PHIHAT_CORRECTION_MAX, PHIHAT_DELAY_MAX, PHIHAT_FORM_LITERAL, PHIHAT_FORM_OBSERVER,
    PHIHAT_FORM_POSITIONS, PHIHAT_ORDER_MAX, PHIHAT_RATE_LIMITED, PHIHAT_REFUSED, PHIHAT_SATURATED,
    PHIHAT_SECTIONS_MAX, phihat_command, phihat_joint, phihat_sample,
};
