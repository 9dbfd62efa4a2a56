#![doc = include_str!("../README.md")]
//!
//! # Parts
//!
//! The paper's figures, tables and theorems, computed again, each with a verdict.
//!
//! R. Hayat, M. Leibold, M. Buss, "Robust-Adaptive Controller Design for Robot Manipulators Using the
//! H-infinity Approach", IEEE Access, 2018. [`reproduce`] does every part and leaves a [`Reproduction`];
//! what the paper does not print is an [`Assumption`], named and where possible varied.
#![forbid(unsafe_code)]

mod agreement;
pub mod arm;
mod choice;
mod compose;
mod coverage;
mod details;
mod draw;
mod figure;
mod gains;
mod item;
mod joint;
mod options;
mod orders;
mod own;
mod page;
mod part;
mod published;
pub mod reach;
mod record;
mod reproduce;
mod table1;
mod table2;
mod table3;
mod theory;

pub use agreement::{Kept, KeptError};
pub use choice::{only_help, part};
pub use coverage::{Coverage, NotCovered, coverage};
pub use figure::reproduction_figures;
pub use item::{Item, Kind};
pub use options::{Paint, PaintError, ReproduceAnswer, ReproduceOptions};
pub use own::{
    LeftOutOfPaper, OWN_FORMAT, OwnAnswer, OwnError, OwnOptions, OwnReproduction, own, own_page,
};
pub use page::reproduction_page;
pub use part::{Extent, PaperPart, PartError};
pub use record::{
    Assumption, FORMAT, Origin, PaperNumber, Reproduction, Section, Statement, Table, Verdict,
};
pub use reproduce::{ReproduceError, parts, reproduce, reproduce_only, studies};
