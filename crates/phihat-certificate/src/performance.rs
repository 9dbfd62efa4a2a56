//! Peak-to-peak gains: bounds on the errors of the continuous law.

use serde::{Deserialize, Serialize};

use crate::check::free::Free;
use crate::peak_gain::encloses;
use crate::{PeakGain, Refutation, UnitLaw};

const CLAIM: &str = "performance";

/// Peak-to-peak gains of one joint at a frozen inertia ratio `μ`, for `M̄ = 1` (divide by `M̄` for real units).
///
/// # Claim
///
/// ```text
/// |x_i|_∞ ≤ ‖G_{x_i←φ}‖₁ |φ|_∞,   G_{x_i←φ} = −s^i/(D(s)A_o(s) + (μ−1)s^{m+2})
/// x = (∫…∫e, …, ∫e, e, ė),  i = 0 … m+1;   G_{x_i}/s = G_{x_{i−1}}
/// φ̂ − φ = D(s) e
/// ```
///
/// from rest, and attained by a φ that switches between its extremes (`WorstCase`). The errors that
/// derivatives of φ cause are further down the ladder: `|e|_∞ ≤ ‖G_{∫e}‖₁ |φ̇|_∞`.
///
/// # Not claimed
///
/// At `μ ≠ 1`, φ here is the part that does not come from the loop's own acceleration: loads, and
/// `(μ−1) M̄ q̈_d`. Sampling, delay and saturation are not in it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PeakGains {
    /// Inertia ratio.
    pub mu: f64,
    /// From φ to each state of the ladder, `∫…∫e` first, `ė` last.
    pub states: Vec<PeakGain>,
    /// From φ to the estimation error `φ̂ − φ`.
    pub estimate: PeakGain,
}

impl PeakGains {
    /// Gain from the `derivative`-th derivative of φ to a state of the ladder (0: the lowest integral);
    /// `None` when there is no finite one.
    pub fn state(&self, index: usize, derivative: usize) -> Option<PeakGain> {
        self.states.get(index.checked_sub(derivative)?).copied()
    }

    /// Gain from the `derivative`-th derivative of φ to `e`; finite for `derivative ≤ m`.
    pub fn error(&self, derivative: usize) -> Option<PeakGain> {
        self.state(self.states.len().checked_sub(2)?, derivative)
    }

    /// Gain from the `derivative`-th derivative of φ to `ė`; finite for `derivative ≤ m + 1`.
    pub fn velocity_error(&self, derivative: usize) -> Option<PeakGain> {
        self.state(self.states.len().checked_sub(1)?, derivative)
    }

    /// Gain from φ to the lowest running integral `∫e`.
    pub fn integral(&self) -> Option<PeakGain> {
        self.error(1)
    }

    /// `|e|_∞ ≤ ‖G/s‖₁ |φ̇_smooth|_∞ + ‖G‖₁ |φ_jump|_∞`: φ split into a smooth part and jumps.
    pub fn error_bound(&self, phi_smooth_rate: f64, phi_jump: f64) -> Option<f64> {
        Some(self.error(1)?.upper * phi_smooth_rate + self.error(0)?.upper * phi_jump)
    }
}

impl PeakGains {
    /// Finds the areas under the loop's answer to an impulse; what is claimed must enclose them.
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming the gain that is not what it should be.
    pub fn verify(&self, law: &UnitLaw) -> Result<(), Refutation> {
        let free = Free::new(CLAIM, law, self.mu)?;
        let n = free.len();
        let (own, right) = (self.states.len() as f64, n as f64);
        Refutation::unless(CLAIM, "gains of m+2 states", own, right, self.states.len() == n)?;
        let mut rows: Vec<Vec<f64>> = vec![vec![0.0; n]; n];
        for (i, row) in rows.iter_mut().enumerate() {
            row[i] = free.unit(i);
        }
        // φ̂ − φ = ë + K_d ė + K_p e, of which ë begins with an impulse of 1/μ.
        let mut last = free.acceleration();
        last[n - 1] += law.kd * free.unit(n - 1);
        last[n - 2] += law.kp * free.unit(n - 2);
        rows.push(last);
        let found = free.areas(&rows);
        for (i, (claimed, found)) in self.states.iter().zip(&found).enumerate() {
            encloses(&format!("‖G_x{}‖₁", i + 1), *claimed, *found)?;
        }
        let Some(rest) = found.last() else { return Ok(()) };
        let jump = 1.0 / self.mu;
        let again = PeakGain { lower: jump + rest.lower, upper: jump + rest.upper };
        encloses("‖G_(φ̂−φ)‖₁", self.estimate, again)
    }
}
