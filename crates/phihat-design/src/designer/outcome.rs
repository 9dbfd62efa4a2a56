//! Outcome of a design.

use super::infeasible::Infeasible;
use crate::Gains;

/// Outcome of a design: gains, or why there are none.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// Gains with their certificate: by our method they keep every clause; by the paper's the certificate says
    /// what holds.
    Designed(Box<Gains>),
    /// No gains keep every clause.
    Infeasible(Infeasible),
}
