//! All integration tests of this crate in one program, which is linked once.

mod support;

mod both_sides;
mod hostile;
mod layout;
mod no_allocation;
mod sessions;
