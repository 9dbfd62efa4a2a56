//! Inputs of the estimators of Figs. 12 and 13: gains, rates and φ.

use crate::gains::equal_rate;
use crate::joint::{Instant, PaperForm, PhiCourse, run};

/// `a_0` of Fig. 12 [1/s]: the paper prints none.
pub(super) const GAINS: [f64; 4] = [10.0, 20.0, 40.0, 69.6];

/// Every estimator pole of Fig. 13 [rad/s]: slow enough to be seen.
pub(super) const RATE: f64 = 20.0;

/// Steps of 1 ms.
pub(super) const STEP: f64 = 1e-3;

/// One φ with its derivatives, `Σ c_k t^k/k!` \[N·m\].
pub(super) struct PhiCase {
    pub(super) name: &'static str,
    pub(super) coefficients: &'static [f64],
}

pub(super) const CASES: [PhiCase; 3] = [
    PhiCase { name: "constant", coefficients: &[20.0] },
    PhiCase { name: "ramp", coefficients: &[0.0, 20.0] },
    PhiCase { name: "parabola", coefficients: &[0.0, 0.0, 20.0] },
];

/// Steps that a φ lasts.
fn steps(phi: &PhiCourse) -> usize {
    match phi {
        PhiCourse::Joined(values) => values.len().saturating_sub(1),
        PhiCourse::Generated { .. } => 2000,
    }
}

pub(super) fn runs(order: usize, rate: f64, phi: &PhiCourse) -> Vec<Instant> {
    run(&equal_rate(order, rate), PaperForm::Estimator, &[], phi, (STEP, steps(phi)))
}
