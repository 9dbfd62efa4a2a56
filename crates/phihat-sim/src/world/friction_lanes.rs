//! The friction of one joint of many arms, one arm per lane.

use phihat_model::{Lanes, Scalar};

use super::friction::{COULOMB_VELOCITY, SimulatedFriction};

/// (FR1) in lanes, with the bits of [`SimulatedFriction::torque`] in each but for the sign of a zero.
#[derive(Debug, Clone, Copy)]
pub(super) struct FrictionLanes {
    viscous: Lanes,
    /// `None`: no arm has any.
    coulomb: Option<Lanes>,
    sigmoid: Option<SigmoidLanes>,
}

/// The smooth law; an arm without one has amplitude 0.
#[derive(Debug, Clone, Copy)]
struct SigmoidLanes {
    amplitude: Lanes,
    /// `−s`.
    falling: Lanes,
    offset: Lanes,
    /// Value at rest.
    rest: Lanes,
}

impl FrictionLanes {
    /// The frictions of as many arms as there are lanes.
    pub(super) fn of(frictions: &[SimulatedFriction; Lanes::COUNT]) -> Self {
        let lanes = |of: fn(&SimulatedFriction) -> f64| Lanes::from(frictions.each_ref().map(of));
        let dry = |friction: &SimulatedFriction| {
            if friction.coulomb > 0.0 { friction.coulomb } else { 0.0 }
        };
        let smooth = |of: fn(&phihat_model::Sigmoid) -> f64| {
            let each = frictions.each_ref();
            Lanes::from(each.map(|friction| friction.sigmoid.as_ref().map_or(0.0, of)))
        };
        let sigmoid = || SigmoidLanes {
            amplitude: smooth(|law| law.amplitude_nm),
            falling: smooth(|law| -law.steepness_s_rad),
            offset: smooth(|law| law.offset_rad_s),
            rest: smooth(|law| {
                law.amplitude_nm / (1.0 + libm::exp(-law.steepness_s_rad * law.offset_rad_s))
            }),
        };
        Self {
            viscous: lanes(|friction| friction.viscous),
            coulomb: frictions.iter().any(|f| f.coulomb > 0.0).then(|| lanes(dry)),
            sigmoid: frictions.iter().any(|f| f.sigmoid.is_some()).then(sigmoid),
        }
    }

    /// `τ_f` \[N·m\] at velocities \[rad/s\].
    #[inline]
    pub(super) fn torque(&self, v: Lanes) -> Lanes {
        let mut torque = self.viscous * v;
        if let Some(coulomb) = self.coulomb {
            let bend = Lanes::splat(COULOMB_VELOCITY * COULOMB_VELOCITY);
            torque += coulomb * v / (v * v + bend).sqrt();
        }
        if let Some(SigmoidLanes { amplitude, falling, offset, rest }) = self.sigmoid {
            let growth = (falling * (v + offset)).exp();
            torque += amplitude / (Lanes::splat(1.0) + growth) - rest;
        }
        torque
    }
}
