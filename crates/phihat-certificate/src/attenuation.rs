//! The values of `K̃` that admit a certificate of optimality.

use serde::{Deserialize, Serialize};

/// An open interval of `K̃` \[1/s\].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// The values of `K̃` in `(0, a_{m−1})` for which a law is inverse optimal.
///
/// # Claim
///
/// ```text
/// diagonal:            q_i(K̃) > 0 for all i, exactly for low < K̃ < high                         (T5)
/// return difference:   |(jω)^m + K̃g(jω)|² ≥ ω^{2m} for all ω, exactly for K̃ ≥ K̃_min
/// γ = 1/√(a_{m−1} − K̃)
/// ```
///
/// The second is necessary and sufficient for optimality with *some* `Q ⪰ 0`; it does not involve
/// `K_p`, `K_d`. Both sides are affine in `K̃`, and the second grows with it (`|g|² ≥ 0`): so each
/// set is an interval, and its edges are what has to be checked.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Attenuation {
    /// `K̃` with a diagonal `Q ≻ 0`; `None`: there is none in `(0, a_{m−1})`.
    pub diagonal: Option<Interval>,
    /// Smallest `K̃` whose return difference holds; `None`: it is not below `a_{m−1}`.
    pub return_difference: Option<f64>,
    /// Where the return difference fails just below that value, `ω²` \[rad²/s²\]; `None`: as ω → ∞, or never.
    pub blocking_w: Option<f64>,
    /// Infimum of `γ` with a diagonal `Q`.
    pub gamma_diagonal: Option<f64>,
    /// Infimum of `γ` by the return difference.
    pub gamma_return_difference: Option<f64>,
}

impl Attenuation {
    /// A `K̃` well inside the diagonal interval: the geometric mean of its ends, or a third of the
    /// upper one where the lower is 0.
    pub fn k_tilde(&self) -> Option<f64> {
        let Interval { low, high } = self.diagonal?;
        Some(if low > 0.0 { (low * high).sqrt() } else { high / 3.0 })
    }
}
