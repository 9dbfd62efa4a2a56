//! What a design comes to.

use super::infeasible::Infeasible;
use crate::Gains;

/// What a design comes to: gains, or why there are none.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// Gains with their certificate: by our method they keep every clause; by the paper's the certificate says
    /// what holds.
    Designed(Box<Gains>),
    /// No gains keep every clause.
    Infeasible(Infeasible),
}
