//! The proof of an arm's range of inertia, held against what a certificate states.

use crate::{Certificate, ProvedEnd, RangeProof, Refutation, Verified, VerifiedRange};

/// Claim that a posture refutes.
const CLAIM: &str = "range of the arm's inertia";

impl Certificate {
    /// The result of a check with a proof of the arm's range of inertia; assumption A11 is gone where the proved range
    /// lies inside of the window over which the loops are stable.
    ///
    /// # Errors
    ///
    /// [`Refutation`]: the proof met a posture outside of the range that the certificate states.
    pub fn with_range(
        &self,
        mut verified: Verified,
        proof: RangeProof,
    ) -> Result<Verified, Refutation> {
        if let Some(outside) = &proof.outside {
            let inequality = match outside.end {
                ProvedEnd::Low => "low M̄ ⪯ M(q)",
                ProvedEnd::High => "M(q) ⪯ high M̄",
            };
            let (left, right) = match outside.end {
                ProvedEnd::Low => (outside.stated, outside.eigenvalue),
                ProvedEnd::High => (outside.eigenvalue, outside.stated),
            };
            return Err(Refutation {
                claim: CLAIM.to_owned(),
                inequality: format!("{inequality} at q = {:?} rad", outside.q),
                left,
                right,
            });
        }
        let window = (self.arm.low / self.window_margin, self.arm.high * self.window_margin);
        let inside_window = window.0 <= proof.low && proof.high <= window.1;
        if inside_window {
            verified.assumptions.retain(|one| one.number != "A11");
        }
        verified.range = Some(VerifiedRange { proof, window, inside_window });
        Ok(verified)
    }
}
