//! Integral suboptimal sliding mode control of second order.

use crate::card::{Card, Grade};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::measured::{Acceleration, MeasuredMotion};
use crate::nominal::Nominal;
use crate::rival::Rival;
use crate::shared::SURFACE;
use crate::tuning::{Scalar, Tuning};

/// Integral suboptimal sliding mode control of second order, after Ferrara and Incremona.
///
/// # Law
///
/// ```text
/// τ = M̂ (q̈_d − λ ė + v) + Ĉ q̇ + Ĝ + F̂ q̇,     v̇ = −W sign(σ − ½ σ_M)                     (1)
/// σ = s − s(0) (1 + 2t/T_r)(1 − t/T_r)²,     s = ė + λ e                                  (2)
/// ```
///
/// `σ_M` is the last extremal value of `σ`, `v(0) = 0`. The cubic of (2) goes from 1 to 0 with no slope at either end
/// and is 0 from `T_r` on, so that `σ(0) = 0`: there is no reaching phase but for what the model lacks. The torque is
/// continuous: the sign acts on its rate. Sampled, an extremal value is the middle one of three samples between which
/// `σ` turns; `v` stands still while its joint's torque is limited.
///
/// # Guarantee
///
/// With `M̂ = M`, `σ = σ̇ = 0` after a finite time when all that acts on a joint's `σ̇` but `v` (what the model
/// lacks, per unit of inertia, and the slope of the transient) changes at most at the rate `Φ`, and `W > 2 Φ`. This
/// is the published rule `W Γ_m > max(Φ/α*, 4Φ/(3 − α* Γ_M/Γ_m))` at `α* = 1`, `Γ_m = Γ_M = 1`.
///
/// # Not claimed
///
/// The rule where dry friction jumps. That the transient is the published one.
///
/// # References
///
/// A. Ferrara, G. P. Incremona, "Design of an integral suboptimal second-order sliding mode controller for the robust
/// motion control of robot manipulators", IEEE Trans. Control Systems Technology 23(6), 2015; the abstract of the
/// authors' copy (123dok.org, document 1y9w8llz) confirms the second order, the integral form that leaves hardly any
/// reaching phase, and the continuous torque. G. Bartolini, A. Ferrara, E. Usai, "Chattering avoidance by
/// second-order sliding mode control", IEEE Trans. Automatic Control 43(2), 1998, for the suboptimal rule; A. Levant,
/// L. Alelishvili, "Integral high-order sliding modes", IEEE Trans. Automatic Control 52(7), 2007, for transients of
/// the kind of (2). Grade B.
#[derive(Debug)]
pub(crate) struct Suboptimal {
    surface: f64,
    authority: f64,
    transient: f64,
    period: f64,
    samples: u64,
    model: Nominal,
    joints: Vec<Turning>,
    wanted: Vec<f64>,
}

/// Memory of a joint.
#[derive(Debug, Clone, Default)]
struct Turning {
    /// `s(0)` \[rad/s\].
    first: f64,
    /// `σ` of the last two samples \[rad/s\].
    past: [f64; 2],
    /// `σ_M` \[rad/s\].
    extremal: f64,
    /// `v` \[rad/s²\].
    auxiliary: f64,
}

impl Turning {
    /// `sign(σ − ½ σ_M)` at a sample; `samples` came before it.
    fn side(&mut self, sigma: f64, samples: u64) -> f64 {
        let [before, last] = self.past;
        if samples == 0 {
            self.extremal = sigma;
        } else if samples > 1 && (last - before) * (sigma - last) <= 0.0 {
            self.extremal = last;
        }
        self.past = [last, sigma];
        let beyond = sigma - 0.5 * self.extremal;
        if beyond.abs() > 0.0 { beyond.signum() } else { 0.0 }
    }
}

/// The share of `s(0)` that (2) leaves at a time over `T_r`.
fn transient(x: f64) -> f64 {
    if x < 1.0 { (1.0 + 2.0 * x) * (1.0 - x).powi(2) } else { 0.0 }
}

impl Rival for Suboptimal {
    const CARD: Card = Card {
        id: "integral-suboptimal",
        title: "Integral suboptimal sliding mode (Ferrara, Incremona)",
        reference: "[21]",
        source: "Ferrara, Incremona, IEEE T-CST 23(6), 2015; Bartolini, Ferrara, Usai, IEEE T-AC 43(2), 1998",
        grade: Grade::B,
        caveat: "second order, integral form and continuous torque confirmed by the abstract; the transient, and the \
            inverse dynamics around it, are this project's",
        law: "τ = M̂ (q̈_d − λ ė + v) + Ĉ q̇ + Ĝ + F̂ q̇,  v̇ = −W sign(σ − ½ σ_M),\n\
              σ = s − s(0) (1 + 2t/T_r)(1 − t/T_r)²,  s = ė + λ e",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[
        SURFACE,
        Scalar {
            name: "authority",
            unit: "rad/s³",
            meaning: "W, rate of the auxiliary acceleration",
            default: 300.0,
            low: 30.0,
            high: 3000.0,
        },
        Scalar {
            name: "transient",
            unit: "s",
            meaning: "T_r, of the way to s = 0",
            default: 0.5,
            low: 0.05,
            high: 5.0,
        },
    ];
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Nominal;

    fn new(tuning: &Tuning, model: Nominal) -> Result<Self, RivalRefusal> {
        let [surface, authority, transient] = tuning.values()?;
        Ok(Self {
            surface,
            authority,
            transient,
            period: tuning.period(),
            samples: 0,
            model,
            joints: vec![Turning::default(); tuning.joints()],
            wanted: vec![0.0; tuning.joints()],
        })
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Acceleration<'_>,
        clipped: &[bool],
        tau: &mut [f64],
    ) {
        let left = transient(self.samples as f64 * self.period / self.transient);
        for (i, (joint, wanted)) in self.joints.iter_mut().zip(&mut self.wanted).enumerate() {
            let (e, de) = (sees.q[i] - wants.q[i], sees.dq[i] - wants.dq[i]);
            let s = de + self.surface * e;
            if self.samples == 0 {
                joint.first = s;
            }
            let side = joint.side(s - left * joint.first, self.samples);
            if !clipped[i] {
                joint.auxiliary -= self.period * self.authority * side;
            }
            *wanted = wants.ddq[i] - self.surface * de + joint.auxiliary;
        }
        self.samples += 1;
        self.model.torque(sees.q, sees.dq, sees.dq, &self.wanted, tau);
    }

    fn states(&self) -> usize {
        // s(0), two of σ, σ_M and v per joint, and the time.
        5 * self.joints.len() + 1
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let [_, authority, _] = tuning.values().ok()?;
        let rates = arm.phi_rate.iter().zip(tuning.units());
        let rate = rates.map(|(rate, unit)| rate / unit).fold(0.0, f64::max);
        Some(Condition::above("W > 2Φ, Φ = max|φ̇|/M̄", authority, 2.0 * rate))
    }
}

#[cfg(test)]
mod tests {
    use super::{Turning, transient};

    /// `σ̈ = −W sign(σ − ½ σ_M)` from rest is the time-optimal motion: half-way at `√(σ_0/W)`, there at twice that. A
    /// sign that turns a sample late leaves `2 T √(σ_0 W)`.
    #[test]
    fn without_disturbance_the_way_is_time_optimal() {
        let (period, authority, start) = (1e-4, 100.0_f64, 1.0_f64);
        let half = (start / authority).sqrt();
        let late = 2.02 * period * (start * authority).sqrt();
        let (mut joint, mut sigma, mut rate) = (Turning::default(), start, 0.0);
        for sample in 0..10_000_u32 {
            let t = f64::from(sample) * period;
            if (t - half).abs() < 0.4 * period {
                assert!((sigma - 0.5 * start).abs() < late, "{sigma} at {t}");
            }
            assert!(t < 2.0 * half || sigma.abs() < late, "{sigma} at {t}");
            assert!(t > 1.8 * half || sigma > 0.015, "{sigma} at {t}");
            let push = -authority * joint.side(sigma, u64::from(sample));
            sigma += period * rate + 0.5 * period * period * push;
            rate += period * push;
        }
    }

    #[test]
    fn the_transient_begins_and_ends_without_a_slope() {
        assert!((transient(0.0) - 1.0).abs() < 1e-15 && transient(1.0).abs() < 1e-15);
        assert!((transient(0.5) - 0.5).abs() < 1e-15 && transient(7.0).abs() < 1e-15);
        for x in [1e-6, 1.0 - 1e-6] {
            let slope = (transient(x + 1e-7) - transient(x - 1e-7)) / 2e-7;
            assert!(slope.abs() < 1e-4, "{slope} at {x}");
        }
    }
}
