//! Certificates: what they claim, and checks of it by methods of their own.
#![forbid(unsafe_code)]

pub mod tube;
