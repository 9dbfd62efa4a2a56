//! Torques of the imperfect drives of one joint of many arms for demanded torques, one arm per lane.

use phihat_model::{Lanes, Scalar};

use super::shape::DriveImperfections;

/// (D2) and (D3) in lanes, with the bits of [`DriveImperfections::torque`] in each but for the sign of a zero.
#[derive(Debug, Clone, Copy)]
pub(super) struct ShapeLanes {
    gain: Lanes,
    drift: Lanes,
    fault_gain: Lanes,
    /// `None`: no arm has any.
    wave: Option<WaveLanes>,
    /// The drives' own limits, and these or those of faults.
    own_limit: Lanes,
    limit: Lanes,
    no_load_speed: Lanes,
}

/// Part of the torque that varies with the rotor's angle.
#[derive(Debug, Clone, Copy)]
struct WaveLanes {
    per_turn: Lanes,
    ripple: Lanes,
    cogging: Lanes,
}

impl ShapeLanes {
    /// The shapes of as many arms as there are lanes; `None`: a perfect drive.
    pub(super) fn of(shapes: &[Option<&DriveImperfections>; Lanes::COUNT]) -> Self {
        let lanes = |of: fn(&DriveImperfections) -> f64| {
            Lanes::from(shapes.map(|shape| of(shape.unwrap_or(&DriveImperfections::PERFECT))))
        };
        let waves = shapes.iter().flatten().any(|shape| shape.waves());
        let wave = || WaveLanes {
            per_turn: lanes(|s| s.per_turn),
            ripple: lanes(|s| if s.waves() { s.ripple } else { 0.0 }),
            cogging: lanes(|s| if s.waves() { s.cogging } else { 0.0 }),
        };
        Self {
            gain: lanes(|s| s.gain),
            drift: lanes(|s| s.drift),
            fault_gain: lanes(|s| s.fault_gain),
            wave: waves.then(wave),
            own_limit: lanes(|s| s.max),
            limit: lanes(|s| s.max.min(s.fault_max)),
            no_load_speed: lanes(|s| s.no_load_speed),
        }
    }

    /// Torque that acts \[N·m\].
    #[inline]
    pub(super) fn torque(&self, told: Lanes, t: f64, q: Lanes, dq: Lanes) -> Lanes {
        let (zero, one) = (Lanes::splat(0.0), Lanes::splat(1.0));
        let mut tau = self.gain * (one + self.drift * Lanes::splat(t)) * self.fault_gain * told;
        if let Some(WaveLanes { per_turn, ripple, cogging }) = self.wave {
            let angles = <[f64; Lanes::COUNT]>::from(per_turn * q);
            let wave = Lanes::from(angles.map(libm::sin));
            tau = tau * (one + ripple * wave) + cogging * wave;
        }
        let left = self.own_limit * (one - dq.abs() / self.no_load_speed).larger(zero);
        let less = self.limit.exceeds(left).pick(left, self.limit);
        let limit = (tau * dq).exceeds(zero).pick(less, self.limit);
        let above = (-limit).exceeds(tau).pick(-limit, tau);
        tau.exceeds(limit).pick(limit, above)
    }
}
