//! Outcome of a design.

use super::infeasible::Infeasible;
use crate::Gains;

/// Outcome of a search for gains, or of a synthesis: gains, or the reason why there are none.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// Gains with the claims about them. From a search joint by joint these are a candidate: of a coupled arm the
    /// certificate then bounds no error, until `Certificate::bound_by` has taken a tube. From a synthesis the tube is
    /// in it, with the clauses that it does not prove.
    Designed(Box<Gains>),
    /// No gains keep every clause.
    Infeasible(Infeasible),
}
