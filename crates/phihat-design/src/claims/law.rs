//! The continuous law of one joint at unit inertia, and the answer of a claim that does not hold.

use core::fmt;

use serde::{Deserialize, Serialize};

use crate::JointRecord;
use crate::claims::matrix::Matrix;
use crate::claims::polynomial;

/// Gains of one joint, normalised by its nominal inertia `M̄`.
///
/// # Law
///
/// ```text
/// ẋ = A x + B (φ̂ − φ),   x = (∫…∫e, …, ∫e, e, ė),   φ̂ = −K x                      (15), (16)
/// K_i = a_{i−1} K_p + a_{i−2} K_d + a_{i−3}:  the coefficients of D(s) (a_{m−1}s^{m−1} + … + a_0), ascending
/// D(s) = s² + K_d s + K_p,   A_o(s) = s^m + a_{m−1}s^{m−1} + … + a_0
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Law {
    /// Outer loop `K_p` \[1/s²\].
    pub kp: f64,
    /// Outer loop `K_d` \[1/s\].
    pub kd: f64,
    /// Estimator coefficients `a_0 … a_{m−1}`, `a_i` in \[1/s^(m−i)\].
    pub a: Vec<f64>,
}

impl From<&JointRecord> for Law {
    fn from(joint: &JointRecord) -> Self {
        Self { kp: joint.kp_per_s2, kd: joint.kd_per_s, a: joint.a.clone() }
    }
}

impl Law {
    /// Order `m` of the estimator.
    pub fn order(&self) -> usize {
        self.a.len()
    }

    /// `a_{m−1} = R⁻¹` \[1/s\]; 0 without an estimator.
    pub fn a_top(&self) -> f64 {
        self.a.last().copied().unwrap_or(0.0)
    }

    /// Every claim starts here: order 1 … 4, finite gains, `a_{m−1} > 0`.
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming what fails.
    pub fn check(&self, claim: &str) -> Result<(), Refutation> {
        let order = self.order() as f64;
        holds(claim, "m ≥ 1", 1.0, order, order >= 1.0)?;
        holds(claim, "m ≤ 4", order, 4.0, order <= 4.0)?;
        for value in self.a.iter().chain([&self.kp, &self.kd]) {
            holds(claim, "|gain| < ∞", value.abs(), f64::INFINITY, value.is_finite())?;
        }
        holds(claim, "a_{m−1} > 0", self.a_top(), 0.0, self.a_top() > 0.0)
    }

    /// `D(s)`, ascending.
    pub fn d(&self) -> [f64; 3] {
        [self.kp, self.kd, 1.0]
    }

    /// `A_o(s)`, ascending, monic.
    pub fn a_o(&self) -> Vec<f64> {
        let mut a_o = self.a.clone();
        a_o.push(1.0);
        a_o
    }

    /// `g(s) = s^{m−1} + b_{m−2}s^{m−2} + … + b_0`, `b_i = a_i/a_{m−1}`, ascending.
    pub fn g(&self) -> Vec<f64> {
        self.a.iter().map(|a_i| a_i / self.a_top()).collect()
    }

    /// `A` of (15).
    pub fn a_matrix(&self) -> Matrix {
        let n = self.order() + 2;
        let mut a = vec![vec![0.0; n]; n];
        for i in 0..n - 1 {
            a[i][i + 1] = 1.0;
        }
        a[n - 1][n - 2] = -self.kp;
        a[n - 1][n - 1] = -self.kd;
        a
    }

    /// `K` of (16).
    pub fn k(&self) -> Vec<f64> {
        polynomial::product(&self.a, &self.d())
    }

    /// `A − BK`: the loop with the estimator closed.
    pub fn closed_loop(&self) -> Matrix {
        let mut a = self.a_matrix();
        if let Some(last) = a.last_mut() {
            for (entry, k_i) in last.iter_mut().zip(self.k()) {
                *entry -= k_i;
            }
        }
        a
    }

    /// Characteristic polynomial `D(s)A_o(s) + (μ−1)s^{m+2}` at inertia ratio `μ`, ascending.
    pub fn denominator(&self, mu: f64) -> Vec<f64> {
        let mut den = polynomial::product(&self.a_o(), &self.d());
        if let Some(top) = den.last_mut() {
            *top = mu;
        }
        den
    }
}

/// A claim that does not hold: the inequality that fails, with both its sides.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Refutation {
    /// Which claim.
    pub claim: String,
    /// The inequality as a formula; it should hold and does not.
    pub inequality: String,
    /// Value of its left side.
    pub left: f64,
    /// Value of its right side.
    pub right: f64,
}

impl Refutation {
    /// The same about a joint.
    #[must_use]
    pub fn on(mut self, joint: &str) -> Self {
        self.claim = format!("{joint}: {}", self.claim);
        self
    }
}

impl fmt::Display for Refutation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { claim, inequality, left, right } = self;
        write!(f, "{claim}: {inequality} fails with {left:.9e} against {right:.9e}")
    }
}

impl core::error::Error for Refutation {}

/// `Ok` when `truth`; otherwise the refutation. A NaN anywhere makes `truth` false.
pub(crate) fn holds(
    claim: &str,
    inequality: &str,
    left: f64,
    right: f64,
    truth: bool,
) -> Result<(), Refutation> {
    if truth {
        return Ok(());
    }
    Err(Refutation { claim: claim.to_owned(), inequality: inequality.to_owned(), left, right })
}

/// `Ok` when two numbers agree to the relative tolerance.
pub(crate) fn agrees(
    claim: &str,
    what: &str,
    left: f64,
    right: f64,
    tolerance: f64,
) -> Result<(), Refutation> {
    let scale = left.abs().max(right.abs());
    holds(claim, what, left, right, (left - right).abs() <= tolerance * scale)
}
