//! All integration tests of this crate in one program, which is linked once.

mod support;

mod accuracy;
mod blocks;
mod driver;
mod held;
mod imperfections;
mod interface;
mod mcap;
mod mechanics;
mod motion;
mod one_joint;
mod overload;
mod parquet;
mod supervised;
mod trace;
