//! Inverse optimality: the law is the optimal one of a game, whose weights are the evidence.

use core::fmt;

use serde::{Deserialize, Serialize};

use crate::Matrix;

/// What the mathematics says about a law at one value of `K̃`.
///
/// # Claim
///
/// ```text
/// AᵀS + SA − K̃ S B Bᵀ S + Q = 0,   Q = diag(q_1 … q_{m+2}) ≻ 0,   S ≻ 0                      (13)
/// a_{m−1} BᵀS = K,   a_{m−1} = R⁻¹ = K̃ + 1/γ²                                              (14), (20)
/// q_i = coefficient of ω^{2(i−1)} in (1/K̃) |D(jω)|² (|(jω)^m + K̃ g(jω)|² − ω^{2m})            (T5)
/// ```
///
/// Then the L2-gain from `d = −φ` to the cost `xᵀQx + uᵀRu` is at most `γ²` (11), and the worst
/// disturbance is `d = BᵀSx/γ²`.
///
/// # Not claimed
///
/// A refusal says that no *diagonal* `Q` exists at this `K̃`, not that the loop is unstable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, tag = "outcome", rename_all = "snake_case")]
pub enum Optimality {
    /// The weights exist; here they are.
    Certified(Certified),
    /// They do not; this is the condition in the way.
    Refuted(Refused),
}

/// The evidence of inverse optimality.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Certified {
    /// `K̃` \[1/s\].
    pub k_tilde: f64,
    /// Attenuation level `γ`.
    pub gamma: f64,
    /// Diagonal of `Q`.
    pub q: Vec<f64>,
    /// `S`, row by row.
    pub s: Matrix,
    /// Worst-case disturbance feedback: `d = worstᵀx`, `worst = SB/γ²`.
    pub worst: Vec<f64>,
}

/// Why there is no certificate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Refused {
    /// `K̃` at which it was asked for \[1/s\].
    pub k_tilde: f64,
    /// The paper's name of the condition (A1 … A3, B1, B2), or `Q33` and so on for higher orders.
    pub condition: String,
    /// Which number decides, such as `Q44`.
    pub quantity: String,
    /// Its value; it should be positive.
    pub value: f64,
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "refused on {} with {} = {:.4}", self.condition, self.quantity, self.value)
    }
}

impl Optimality {
    /// The certificate, if there is one.
    pub fn certified(&self) -> Option<&Certified> {
        match self {
            Self::Certified(certified) => Some(certified),
            Self::Refuted(_) => None,
        }
    }
}
