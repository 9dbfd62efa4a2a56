//! Check that a claim about the tip follows from its tube.

use crate::check::agree::agrees;
use crate::check::plausible::at_most;
use crate::{Refutation, Tube, TubeTip};

const CLAIM: &str = "tube of the tip";

/// Two ways to compute the same number of a document.
const SAME: f64 = 1e-9;

impl TubeTip {
    /// The claim fits the tube that it is about: one lever per joint and bin, and the summaries are those of the bins.
    pub(super) fn fits(&self, tube: &Tube) -> Result<(), Refutation> {
        let (n, bins) = (tube.joints.len(), tube.bins());
        let whole = self.turns.len() == n
            && self.lever_m.len() == n
            && self.lever_m.iter().all(|levers| levers.len() == bins);
        Refutation::unless(CLAIM, "one lever arm per joint and bin", 0.0, 1.0, whole)?;
        Refutation::unless(CLAIM, "it has a name", 0.0, 1.0, !self.frame.trim().is_empty())?;
        for lever in self.lever_m.iter().flatten() {
            at_most(CLAIM, "0 ≤ lever arm", 0.0, *lever)?;
            at_most(CLAIM, "lever arm < ∞", *lever, f64::MAX)?;
        }
        // Bins that end by the settling time are none of the steady part; the last one always is.
        let (mut off, mut turned) = (0.0_f64, 0.0_f64);
        for bin in tube.first_steady()..bins {
            let mut sums = (0.0, 0.0);
            for (i, joint) in tube.joints.iter().enumerate() {
                let most = joint.error_low_rad[bin].abs().max(joint.error_high_rad[bin].abs());
                sums.0 += self.lever_m[i][bin] * most;
                sums.1 += if self.turns[i] { most } else { 0.0 };
            }
            (off, turned) = (off.max(sums.0), turned.max(sums.1));
        }
        let what = "largest error of the tip from the settling time on";
        agrees(CLAIM, what, (self.error_bound_m, off), SAME)?;
        agrees(CLAIM, "largest angle of the tip likewise", (self.angle_max_rad, turned), SAME)
    }
}
