//! The continuous law of one joint at unit inertia.

use serde::{Deserialize, Serialize};

use crate::{JointRecord, Matrix, Refutation};

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
pub struct UnitLaw {
    /// Outer loop `K_p` \[1/s²\].
    pub kp: f64,
    /// Outer loop `K_d` \[1/s\].
    pub kd: f64,
    /// Estimator coefficients `a_0 … a_{m−1}`, `a_i` in \[1/s^(m−i)\].
    pub a: Vec<f64>,
}

impl From<&JointRecord> for UnitLaw {
    fn from(joint: &JointRecord) -> Self {
        Self { kp: joint.kp_per_s2, kd: joint.kd_per_s, a: joint.a.clone() }
    }
}

impl UnitLaw {
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
        Refutation::unless(claim, "m ≥ 1", 1.0, order, order >= 1.0)?;
        Refutation::unless(claim, "m ≤ 4", order, 4.0, order <= 4.0)?;
        for value in self.a.iter().chain([&self.kp, &self.kd]) {
            Refutation::unless(claim, "|gain| < ∞", value.abs(), f64::INFINITY, value.is_finite())?;
        }
        Refutation::unless(claim, "a_{m−1} > 0", self.a_top(), 0.0, self.a_top() > 0.0)
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
        product(&self.a, &self.d())
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
        let mut den = product(&self.a_o(), &self.d());
        if let Some(top) = den.last_mut() {
            *top = mu;
        }
        den
    }
}

/// Product of two polynomials with ascending coefficients.
fn product(p: &[f64], q: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; (p.len() + q.len()).saturating_sub(1)];
    for (i, x) in p.iter().enumerate() {
        for (j, y) in q.iter().enumerate() {
            out[i + j] += x * y;
        }
    }
    out
}
