//! The H-infinity norm from φ to the error.

use serde::{Deserialize, Serialize};

use crate::check::free::Free;
use crate::check::polynomial::{not_negative, product, squared, value};
use crate::{Refutation, UnitLaw};

const CLAIM: &str = "H-infinity norm";

/// `sup_ω |e(jω)/φ(jω)|` of one joint at a frozen inertia ratio `μ`, for `M̄ = 1`.
///
/// # Claim
///
/// ```text
/// G = −s^m/p(s),   p = D(s)A_o(s) + (μ−1)s^{m+2} Hurwitz
/// |G(jω*)| ≥ lower,      upper² |p(jω)|² − ω^{2m} ≥ 0 for all ω
/// ```
///
/// The first is one evaluation, the second the positivity of a polynomial in `ω²`: no eigenvalue is needed to
/// check either.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NormH {
    /// Inertia ratio.
    pub mu: f64,
    /// The norm is at least this \[rad/(N·m) at M̄ = 1 kg·m²\].
    pub lower: f64,
    /// The norm is at most this.
    pub upper: f64,
    /// Frequency at which the lower side is attained \[rad/s\].
    pub frequency_rad_s: f64,
}

impl NormH {
    /// Checks both sides and that the loop is stable.
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming the inequality that fails.
    pub fn verify(&self, law: &UnitLaw) -> Result<(), Refutation> {
        let yes = Refutation::unless;
        law.check(CLAIM)?;
        yes(CLAIM, "μ > 0", self.mu, 0.0, self.mu > 0.0)?;
        yes(CLAIM, "lower > 0", self.lower, 0.0, self.lower > 0.0)?;
        yes(CLAIM, "upper > 0", self.upper, 0.0, self.upper > 0.0)?;
        let at = self.frequency_rad_s;
        yes(CLAIM, "0 ≤ frequency < ∞", at, 0.0, at >= 0.0 && at.is_finite())?;
        Free::new(CLAIM, law, self.mu)?;
        let mut a_o = law.a.clone();
        a_o.push(1.0);
        let mut p = product(&[law.kp, law.kd, 1.0], &a_o);
        if let Some(top) = p.last_mut() {
            *top = self.mu;
        }
        let p = squared(&p);
        let m = law.order();
        let w = self.frequency_rad_s * self.frequency_rad_s;
        let there = ((0..m).fold(1.0, |power, _| power * w) / value(&p, w)).sqrt();
        yes(CLAIM, "|G(jω*)| ≥ lower", there, self.lower, there >= self.lower)?;
        let mut distance: Vec<f64> = p.iter().map(|c| self.upper * self.upper * c).collect();
        if let Some(c) = distance.get_mut(m) {
            *c -= 1.0;
        }
        let below = not_negative(&distance);
        yes(CLAIM, "upper² |p(jω)|² ≥ ω^{2m} for all ω", self.upper, there, below)
    }
}
