//! Request for a limit.

use super::error::LimitError;

/// Longest delay \[samples\].
const DELAY_MAX: usize = 32;

/// A joint, what acts on it, and how its torque may change: SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitRequest {
    /// Inertia `M` of the joint, constant and known \[kg·m²\].
    pub inertia: f64,
    /// Largest rate of the smooth part of `φ` \[N·m/s\].
    pub phi_rate: f64,
    /// Largest size of the rest of `φ`, which may jump at any sample \[N·m\].
    pub phi_jump: f64,
    /// Step `Δ` of the encoder \[rad\]: a reading is wrong by up to `Δ/2`. 0: the position is exact.
    pub quantum: f64,
    /// Largest change of the torque from one sample to the next by the encoder's errors \[N·m\].
    pub torque_change_max: f64,
    /// Whole samples from a measurement to the torque that it causes.
    pub delay: usize,
    /// Sample period `T` \[s\].
    pub period: f64,
}

impl LimitRequest {
    pub(super) fn check(&self) -> Result<(), LimitError> {
        let positive = [
            ("inertia", self.inertia),
            ("period", self.period),
            ("torque_change_max", self.torque_change_max),
        ];
        for (name, value) in positive {
            if !(value.is_finite() && value > 0.0) {
                return Err(LimitError::Number { name, value, needs: "finite and above 0" });
            }
        }
        let sizes =
            [("phi_rate", self.phi_rate), ("phi_jump", self.phi_jump), ("quantum", self.quantum)];
        for (name, value) in sizes {
            if !(value.is_finite() && value >= 0.0) {
                return Err(LimitError::Number { name, value, needs: "finite and at least 0" });
            }
        }
        if self.phi_rate <= 0.0 && self.phi_jump <= 0.0 {
            return Err(LimitError::NoPhi);
        }
        if self.delay > DELAY_MAX {
            return Err(LimitError::Delay { delay: self.delay, max: DELAY_MAX });
        }
        Ok(())
    }

    /// `(ramp·φ̇ + jump·φ_J)/M + read·Δ/2` \[rad\].
    pub(super) fn error(&self, [ramp, jump, read]: [f64; 3]) -> f64 {
        (ramp * self.phi_rate + jump * self.phi_jump) / self.inertia + read * 0.5 * self.quantum
    }
}
