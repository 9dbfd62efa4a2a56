//! Budget of the allowed error, and changes that would help: plain data, and each joint's share by its own
//! loop.

mod document;
mod own;
mod stable;

pub use document::{Budget, BudgetBasis, BudgetPart, Cause, JointBudget, TriedChange};
pub use own::by_own_loop;
pub use stable::{largest_stable, loop_in_words};
