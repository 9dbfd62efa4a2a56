//! Values of a joint at a sample that a page shows, from a live run or a record.

use phihat_sim::Row;

/// One joint at one sample.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Sampled {
    /// Position and desired position \[rad\].
    pub(crate) q: f64,
    pub(crate) q_d: f64,
    /// Error `q − q_d` \[rad\].
    pub(crate) e: f64,
    /// Commanded torque \[N·m\].
    pub(crate) tau: f64,
    /// `φ̂` \[N·m\].
    pub(crate) phi_hat: f64,
}

impl Sampled {
    pub(crate) fn of(row: &Row) -> Self {
        let (q, q_d) = (row.acted.q, row.reference.q);
        let Row { command, .. } = row;
        Self { q, q_d, e: q - q_d, tau: command.tau, phi_hat: command.phi_hat }
    }
}
