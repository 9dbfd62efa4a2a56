//! All integration tests of this crate in one program, which is linked once.

mod support;

mod adaptive;
mod certainty;
mod coupled;
mod every_rival;
mod joints;
mod regressor;
mod simple;
