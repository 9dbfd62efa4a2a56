//! The columns as printed, and the φ_max that their rows ask for.

use phihat_design::claims::paper::Feedback;
use phihat_design::claims::weights::q_diagonal;
use phihat_design::claims::{LevelRefused, Optimality, UnitLaw, polynomial};
use phihat_design::prelude::*;

use crate::part::PartError;

/// One column as printed.
pub(super) struct Table2Column {
    pub(super) name: &'static str,
    pub(super) k_tilde: f64,
    pub(super) kp: f64,
    pub(super) kd: f64,
    /// `b_0`; `None` at m = 1.
    pub(super) b: Option<f64>,
}

pub(super) const COLUMNS: [Table2Column; 6] = [
    Table2Column { name: "m = 1 (A)", k_tilde: 222.0, kp: 200.0, kd: 32.3, b: None },
    Table2Column { name: "m = 1 (B)", k_tilde: 3.3, kp: 78.0, kd: 0.0, b: None },
    Table2Column { name: "m = 1 (C)", k_tilde: 68.9, kp: 400.0, kd: 40.0, b: None },
    Table2Column { name: "m = 2 (A)", k_tilde: 174.7, kp: 57.0, kd: 39.9, b: Some(0.0) },
    Table2Column { name: "m = 2 (B)", k_tilde: 63.4, kp: 100.0, kd: 20.0, b: Some(20.0) },
    Table2Column { name: "m = 2 (C)", k_tilde: 68.9, kp: 400.0, kd: 40.0, b: Some(69.6) },
];

/// (48) and (49).
pub(super) fn limits(order: usize) -> Vec<f64> {
    let all = [1e-4, 1e-3, 1e-2, 1e-1];
    all[2 - order.min(2)..].to_vec()
}

impl Table2Column {
    fn order(&self) -> usize {
        if self.b.is_some() { 2 } else { 1 }
    }

    /// With the least `a_{m−1} = K̃` (γ → ∞).
    pub(super) fn law(&self) -> UnitLaw {
        let a = self.b.iter().map(|b| b * self.k_tilde).chain([self.k_tilde]).collect();
        UnitLaw { kp: self.kp, kd: self.kd, a }
    }

    /// `φ_max` at which each row of (44) is an equality at the limits (48), (49).
    pub(super) fn phi_of_rows(&self, feedback: Feedback) -> Vec<Option<f64>> {
        let (law, x) = (self.law(), limits(self.order()));
        let (q, d) = (q_diagonal(&law, self.k_tilde), polynomial::product(&law.g(), &law.d()));
        let pull: f64 = match feedback {
            Feedback::Ignored => 0.0,
            Feedback::Included => self.k_tilde * d.iter().zip(&x).map(|(d, x)| d * x).sum::<f64>(),
        };
        let row = |i: usize| 0.5 * (q[i] * x[i] / d[i] + pull);
        (0..x.len()).map(|i| Some(row(i)).filter(|phi| phi.is_finite())).collect()
    }
}

pub(super) fn refusal(law: &UnitLaw, k_tilde: f64) -> Result<Option<LevelRefused>, PartError> {
    match Optimality::at(law, k_tilde)? {
        Optimality::Refuted(refused) => Ok(Some(refused)),
        Optimality::Certified(_) => Ok(None),
    }
}
