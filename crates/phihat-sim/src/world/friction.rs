//! Friction torque of a joint, as a function of its velocity.

use phihat_model::Sigmoid;
use phihat_study::{Fault, FaultKind};

use super::fault::{Acts, FrictionFault};

/// Velocity at which the regularised Coulomb law reaches 1/√2 of its level \[rad/s\].
///
/// Small against what encoders resolve at 1 kHz (an 18-bit encoder: 24 mrad/s), large enough for RK4 at
/// 1 ms on rotor inertias of 0.1 kg·m² and up.
pub const COULOMB_VELOCITY: f64 = 1e-3;

/// Friction of one joint; the torque opposes the motion.
///
/// # Law
///
/// ```text
/// τ_f(v) = b v + c v/√(v² + v_c²) + a/(1 + e^{−s(v + o)}) − a/(1 + e^{−s o})                  (FR1)
/// ```
///
/// | symbol | code | unit | meaning |
/// |---|---|---|---|
/// | `b` | `viscous` | N·m·s/rad | viscous |
/// | `c` | `coulomb` | N·m | Coulomb level, regularised at `v_c` = [`COULOMB_VELOCITY`] |
/// | `a, s, o` | `sigmoid` | N·m, s/rad, rad/s | identified smooth law (Gaz et al. 2019) |
///
/// # Not claimed
///
/// The regularised law has no stiction: a loaded joint at rest creeps at a fraction of `v_c`. A study that
/// needs it has `[world.stiction]`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SimulatedFriction {
    /// `b`.
    pub viscous: f64,
    /// `c`.
    pub coulomb: f64,
    /// `a, s, o`, where a smooth law was identified.
    pub sigmoid: Option<Sigmoid>,
}

impl SimulatedFriction {
    /// This friction under those faults of joint `i` that are chosen.
    pub(super) fn faulty(
        self,
        faults: &[Fault],
        i: usize,
        chosen: impl Fn(&Fault) -> bool,
    ) -> Self {
        let mut friction = self;
        for fault in faults.iter().filter(|fault| fault.concerns(i) && chosen(fault)) {
            let Acts::Friction(what) = Acts::of(fault.kind) else { continue };
            match what {
                FrictionFault::Times => friction = friction.times(fault.size),
                FrictionFault::Brake => friction.coulomb += fault.size,
            }
        }
        friction
    }

    /// The stiffest that it becomes under faults of joint `i`.
    pub(super) fn worst(self, faults: &[Fault], i: usize) -> Self {
        self.faulty(faults, i, |fault| fault.kind == FaultKind::Brake || fault.size > 1.0)
    }

    /// All of it, so many times.
    pub(crate) fn times(self, factor: f64) -> Self {
        Self {
            viscous: self.viscous * factor,
            coulomb: self.coulomb * factor,
            sigmoid: self
                .sigmoid
                .map(|law| Sigmoid { amplitude_nm: law.amplitude_nm * factor, ..law }),
        }
    }

    #[allow(
        clippy::imprecise_flops,
        reason = "hypot guards against overflow, at ten times the cost"
    )]
    /// `τ_f` \[N·m\] at a velocity \[rad/s\]; subtract it from the joint torque.
    pub fn torque(&self, v: f64) -> f64 {
        let mut torque = self.viscous * v;
        if self.coulomb > 0.0 {
            torque += self.coulomb * v / (v * v + COULOMB_VELOCITY * COULOMB_VELOCITY).sqrt();
        }
        if let Some(sigmoid) = &self.sigmoid {
            torque += sigmoid.torque(v);
        }
        torque
    }

    /// `τ_f` without its Coulomb part.
    pub(super) fn smooth(&self, v: f64) -> f64 {
        self.viscous * v + self.sigmoid.as_ref().map_or(0.0, |law| law.torque(v))
    }

    /// Largest slope `dτ_f/dv` \[N·m·s/rad\]: what makes the differential equation stiff.
    pub fn stiffness(&self) -> f64 {
        let sigmoid = self
            .sigmoid
            .as_ref()
            .map_or(0.0, |law| 0.25 * (law.amplitude_nm * law.steepness_s_rad).abs());
        self.viscous + self.coulomb / COULOMB_VELOCITY + sigmoid
    }
}
