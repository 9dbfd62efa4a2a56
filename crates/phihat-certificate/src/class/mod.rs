//! Error bound for every motion of a class: the document, and its second derivation.

mod check;
mod derive;
mod document;
mod dynamics;
mod sums;

pub use derive::{ClassAgain, JointOfClass};
pub use document::{ClassBound, ClassPace, ClassWitness};
