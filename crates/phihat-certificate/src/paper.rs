//! The paper's bound on the whole state, and the one that holds.

use serde::{Deserialize, Serialize};

use crate::check::agree::agrees;
use crate::{Iss, Refutation, UnitLaw};

const CLAIM: &str = "performance";

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

impl PaperRadius {
    /// Checks the evidence, then the two numbers.
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming the inequality that fails.
    pub fn verify(&self, law: &UnitLaw, iss: &Iss) -> Result<(), Refutation> {
        iss.verify(law)?;
        let printed = 2.0 * iss.sb_norm / iss.w_min;
        agrees(CLAIM, "(40) = 2|SB|/λ_min", (self.printed, printed), 1e-9)?;
        let corrected = printed * iss.overshoot;
        agrees(CLAIM, "bound = √cond(S) (40)", (self.corrected, corrected), 1e-9)
    }
}
