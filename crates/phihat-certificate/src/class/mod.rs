//! Error bound for every motion of a class: the document, and its second derivation.
//!
//! docs/theory/class.md has the theorem; `derive` is the way in of the second derivation:
//!
//! 1. `setting`, `signals`: class, forces, readings, payloads and start, imperfect signals, read from a study.
//! 2. `places`: numbers of a seed, and postures drawn by them.
//! 3. `dynamics`, `bends`: the arm's matrices at a posture, and maxima of their derivatives.
//! 4. `maxima`: torques and their rates over the class.
//! 5. `sums`, `forget`: kicks played at a posture, and what comes after the last sample.
//! 6. `solve`: the least solution of (CM5).
//! 7. `along`: the same for one motion of the class, at its own postures and speeds.

mod along;
mod bends;
mod check;
mod derive;
mod document;
mod dynamics;
mod forget;
mod maxima;
mod places;
mod setting;
mod signals;
mod solve;
mod sums;
mod words;

pub use along::{AlongBound, KnownMotion};
pub use derive::{ClassAgain, ClassPair, JointOfClass};
pub use document::{ClassBound, ClassPace, ClassPart, ClassSignals, ClassWitness};
