//! The H-infinity norm from φ to the error.

use serde::{Deserialize, Serialize};

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
    /// It is at most this.
    pub upper: f64,
    /// Where the lower side is attained \[rad/s\].
    pub frequency_rad_s: f64,
}
