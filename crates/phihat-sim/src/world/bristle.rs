//! Dry friction that sticks.

use phihat_study::Stiction;

/// One joint's bristles: the LuGre model.
///
/// # Law
///
/// ```text
/// ż = v − σ_0 |v| z/g(v),   g(v) = c (1 + (ρ − 1) e^{−(v/v_s)²})                                (LG1)
/// τ_f = σ_0 z + σ_1 ż                                                                          (LG2)
/// ```
///
/// | symbol | unit | meaning |
/// |---|---|---|
/// | `z` | rad | mean deflection of the bristles |
/// | `c` | N·m | Coulomb level; `ρ c` is the breakaway level |
/// | `v_s` | rad/s | Stribeck velocity |
/// | `σ_0, σ_1` | N·m/rad, N·m·s/rad | stiffness and damping of the bristles |
///
/// # Method
///
/// Over a step, `v` is held at the mean of its start and the instant; (LG1) is then linear in `z` and solved
/// exactly: its rate `σ_0|v|/g` bounds no step, however fast the joint slides.
///
/// # References
///
/// C. Canudas de Wit, H. Olsson, K. J. Åström, P. Lischinsky, A new model for control of systems with
/// friction, IEEE TAC 40(3), 1995.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bristle {
    ratio: f64,
    stribeck: f64,
    pub(super) stiffness: f64,
    pub(super) damping: f64,
    z: f64,
    /// Velocity at the start of the step.
    before: f64,
}

impl Bristle {
    pub(super) fn new(stiction: &Stiction, i: usize) -> Self {
        Self {
            ratio: stiction.breakaway_ratio[i],
            stribeck: stiction.stribeck_velocity[i],
            stiffness: stiction.stiffness[i],
            damping: stiction.damping[i],
            z: 0.0,
            before: 0.0,
        }
    }

    /// Begins an integration step at velocity `v`.
    pub(super) fn begin(&mut self, v: f64) {
        self.before = v;
    }

    /// Friction torque `elapsed` seconds into the step, at velocity `v` and Coulomb level `c`.
    pub(super) fn torque(&self, v: f64, c: f64, elapsed: f64) -> f64 {
        if c <= 0.0 {
            return 0.0;
        }
        let z = self.deflection(v, c, elapsed);
        let slip = self.stiffness * v.abs() / self.level(v, c);
        self.stiffness * z + self.damping * (v - slip * z)
    }

    /// Ends the step, `length` seconds long, at velocity `v`.
    pub(super) fn end(&mut self, v: f64, c: f64, length: f64) {
        self.z = if c > 0.0 { self.deflection(v, c, length) } else { 0.0 };
    }

    fn deflection(&self, v: f64, c: f64, elapsed: f64) -> f64 {
        let v = 0.5 * (self.before + v);
        let level = self.level(v, c);
        let gone = -libm::expm1(-self.stiffness * v.abs() / level * elapsed);
        self.z + (level / self.stiffness * v.signum() - self.z) * gone
    }

    fn level(&self, v: f64, c: f64) -> f64 {
        let x = v / self.stribeck;
        c * (1.0 + (self.ratio - 1.0) * libm::exp(-x * x))
    }
}
