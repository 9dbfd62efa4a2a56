//! All integration tests of this crate in one program, which is linked once.

mod support;

mod claims;
mod escaping;
mod self_contained;
mod shapes;
mod verdict;
