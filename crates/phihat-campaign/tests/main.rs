//! All integration tests of this crate in one program, which is linked once.

mod journal;
mod payload_drop;
mod reliability;
