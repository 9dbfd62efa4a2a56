//! How large the errors of the continuous law get: peak-to-peak gains, and the paper's bound beside them.

use serde::{Deserialize, Serialize};

use crate::check::agree::agrees;
use crate::check::free::Free;
use crate::{Iss, Law, Refutation};

const CLAIM: &str = "performance";

/// Rounding of two ways to compute the same.
const AGAIN: f64 = 1e-8;

/// A number known from both sides.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PeakGain {
    /// The number is at least this.
    pub lower: f64,
    /// The number is at most this: the guarantee.
    pub upper: f64,
}

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

/// The paper's bound on `|x|` per unit of φ, as printed and as it can be proven.
///
/// # Claim
///
/// ```text
/// printed:    |x| ≤ 2 |SB|/λ_min φ_max                                                      (40)
/// corrected:  limsup |x(t)| ≤ √cond(S) 2 |SB|/λ_min φ_max
/// ```
///
/// `V̇ < 0` outside the printed ball; what is invariant is the smallest level set of `V` around it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PaperRadius {
    /// (40) as printed; not a bound.
    pub printed: f64,
    /// The ultimate bound.
    pub corrected: f64,
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
    pub fn verify(&self, law: &Law) -> Result<(), Refutation> {
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

/// A claimed pair is right when it encloses the true one.
pub(crate) fn encloses(what: &str, claimed: PeakGain, again: PeakGain) -> Result<(), Refutation> {
    let enough = claimed.upper >= again.upper * (1.0 - AGAIN) && claimed.upper.is_finite();
    let above = format!("{what} ≤ its bound");
    Refutation::unless(CLAIM, &above, again.upper, claimed.upper, enough)?;
    let attained = claimed.lower <= again.lower * (1.0 + AGAIN);
    let below = format!("{what} ≥ its lower bound");
    Refutation::unless(CLAIM, &below, again.lower, claimed.lower, attained)?;
    let (low, high) = (claimed.lower, claimed.upper);
    let pair = format!("{what}: 0 ≤ lower bound ≤ bound");
    Refutation::unless(CLAIM, &pair, low, high, 0.0 <= low && low <= high)
}

impl PaperRadius {
    /// Checks the evidence, then the two numbers.
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming the inequality that fails.
    pub fn verify(&self, law: &Law, iss: &Iss) -> Result<(), Refutation> {
        iss.verify(law)?;
        let printed = 2.0 * iss.sb_norm / iss.w_min;
        agrees(CLAIM, "(40) = 2|SB|/λ_min", (self.printed, printed), 1e-9)?;
        let corrected = printed * iss.overshoot;
        agrees(CLAIM, "bound = √cond(S) (40)", (self.corrected, corrected), 1e-9)
    }
}
