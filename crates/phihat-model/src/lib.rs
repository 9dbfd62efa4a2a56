//! Robot description and rigid-body dynamics.
#![forbid(unsafe_code)]

/// Stub until the model lands.
#[derive(Debug, Clone)]
pub struct Robot;
