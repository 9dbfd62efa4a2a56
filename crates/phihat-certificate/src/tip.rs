//! Bounds on the tip's deviation from the reference: a claim that follows from a tube.

use serde::{Deserialize, Serialize};

/// Bounds on the tip's deviation from the reference, along a [`Tube`](crate::Tube).
///
/// # Claim
///
/// ```text
/// ‖p(q_d + e) − p(q_d)‖ ≤ Σ_i ℓ_i(q_d) |e_i|,      ∠(R(q_d + e), R(q_d)) ≤ Σ_turning |e_i|             (1)
/// ```
///
/// for the origin `p` and the axes `R` of the tip's frame; `ℓ_i` \[m\] is the distance of the tip from the
/// axis of joint `i` in the posture `q_d`, 1 for a joint that slides, 0 for one that does not move the tip.
/// It is the norm of the joint's column of the position's Jacobian.
///
/// # Proof
///
/// Number the joints from the base to the tip, and go from `q_d` to `q_d + e` one joint after the other,
/// joint 1 first. While joint `i` moves, the joints between it and the tip still stand as in `q_d`; those
/// before it have moved its axis and the tip together, as one rigid body. So the tip is `ℓ_i(q_d)` away from
/// that axis, whatever was moved before, and goes along a circle about it by the angle `e_i`: by a chord of
/// `2 ℓ_i |sin(e_i/2)| ≤ ℓ_i |e_i|`; along a straight line by `|e_i|` where it slides. The sum is the
/// triangle inequality. The frame turns by `|e_i|` with each turning joint, and angles between rotations obey
/// the triangle inequality too. ∎
///
/// Nothing is linearised: there is no remainder of second order that would have to be bounded.
///
/// # Not claimed
///
/// That so much is reached: the joints' contributions rarely point the same way. A payload, or a tool beyond the frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TubeTip {
    /// The tip's frame (link).
    pub frame: String,
    /// True for each joint that turns the tip; one that does not may slide, or not be on the way to the tip.
    pub turns: Vec<bool>,
    /// `ℓ_i` per joint and bin: the largest over the samples of the bin \[m; 1 of a joint that slides\].
    pub lever_m: Vec<Vec<f64>>,
    /// Largest distance of the tip from where the reference has it, of the bins from the tube's `settle_s` on \[m\].
    #[serde(alias = "error_max_m")]
    pub error_bound_m: f64,
    /// Largest angle between the tip's axes and those of the reference, of the same bins \[rad\].
    pub angle_max_rad: f64,
}

impl TubeTip {
    /// Largest deviation of the tip \[m\] and of its axes \[rad\] in a bin, from the largest `|e|` of each
    /// joint there \[rad; m\]. Infinite where a lever arm is missing.
    pub fn off(&self, bin: usize, sizes: &[f64]) -> (f64, f64) {
        let (mut off, mut turned) = (0.0, 0.0);
        for (i, size) in sizes.iter().enumerate() {
            let lever = self.lever_m.get(i).and_then(|of| of.get(bin));
            off += lever.copied().unwrap_or(f64::INFINITY) * size;
            turned += if self.turns.get(i).copied().unwrap_or(true) { *size } else { 0.0 };
        }
        (off, turned)
    }
}
