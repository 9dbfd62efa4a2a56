//! Decentralised adaptive robust control with disturbance observers, after Yang, Fukushima and Qin.

use crate::card::{Card, Grade, Tick, Ticks};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::facts::Inertia;
use crate::lumped::Lumped;
use crate::measured::{Acceleration, MotionAndTorque};
use crate::rival::Rival;
use crate::rivals::proposed::window;
use crate::shared::SURFACE;
use crate::tuning::{Scalar, Tuning};

/// Disturbance observer, adaptive sliding term and nonlinear damping of every joint.
///
/// # Law
///
/// ```text
/// s = ė + λ e,     φ̂ = g/(s + g) (τ_applied − M̄ q̈)                                     (1)
/// τ = M̄ [q̈_d − λ ė − k s − κ (1 + e² + ė² + e⁴) s − β̂ tanh(s/ε)] + φ̂
/// β̂˙ = γ |s| − σ β̂                                                                     (2)
/// ```
///
/// (2) is taken implicitly in its leakage, and stands still while its joint's torque is limited. `M̄` multiplies
/// the gains of the source, which are torques.
///
/// # Guarantee
///
/// With `κ = β̂ = 0` this is the paper's law of order 1, `a_0 = g`, `K_d = λ + k`, `K_p = λ k`; the condition is its
/// inertia window.
///
/// # Not claimed
///
/// That the window holds with the gain of the sliding term, `β̂/ε`, on top. Ultimate boundedness has no number.
///
/// # References
///
/// Z.-J. Yang, Y. Fukushima, P. Qin, "Decentralized adaptive robust control of robot manipulators using disturbance
/// observers", IEEE Trans. Control Systems Technology 20(5), 2012. Grade B: abstract read, details reconstructed.
#[derive(Debug)]
pub(crate) struct Yang {
    surface: f64,
    gain: f64,
    damping: f64,
    adaptation: f64,
    leakage: f64,
    layer: f64,
    inertia: Vec<f64>,
    lumped: Lumped,
    /// `β̂` \[rad/s²\] per joint.
    switching: Vec<f64>,
    period: f64,
}

impl Rival for Yang {
    const CARD: Card = Card {
        id: "adaptive-robust-dob",
        title: "Decentralised adaptive robust control with DOBs (Yang)",
        reference: "[30]",
        source: "Yang, Fukushima, Qin, IEEE T-CST 20(5), 2012",
        grade: Grade::B,
        caveat: "parts of the law from the abstract; their form and gains are reconstructed",
        law: "τ = M̄ [q̈_d − λ ė − k s − κ (1 + e² + ė² + e⁴) s − β̂ tanh(s/ε)] + φ̂,  β̂˙ = γ|s| − σ β̂",
        printed: Some(Ticks {
            quantitative: Tick::Partly,
            easy: Tick::No,
            optimal: Tick::No,
            model_free: Tick::Yes,
        }),
    };
    const SCALARS: &'static [Scalar] = &[
        SURFACE,
        Scalar {
            name: "gain",
            unit: "1/s",
            meaning: "k on s",
            default: 50.0,
            low: 5.0,
            high: 500.0,
        },
        Scalar {
            name: "damping",
            unit: "1/s",
            meaning: "κ of the nonlinear damping",
            default: 0.3,
            low: 0.03,
            high: 3.0,
        },
        Scalar {
            name: "cutoff",
            unit: "rad/s",
            meaning: "g of the observer",
            default: 50.0,
            low: 5.0,
            high: 200.0,
        },
        Scalar {
            name: "adaptation",
            unit: "1/s²",
            meaning: "γ of the switching gain",
            default: 130.0,
            low: 13.0,
            high: 1300.0,
        },
        Scalar {
            name: "leakage",
            unit: "1/s",
            meaning: "σ of the same",
            default: 2.0,
            low: 0.2,
            high: 20.0,
        },
        Scalar {
            name: "layer",
            unit: "rad/s",
            meaning: "ε in which the switching is smooth",
            default: 0.1,
            low: 0.01,
            high: 1.0,
        },
    ];
    type Sees<'a> = MotionAndTorque<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Inertia;

    fn new(tuning: &Tuning, inertia: Inertia) -> Result<Self, RivalRefusal> {
        let [surface, gain, damping, cutoff, adaptation, leakage, layer] = tuning.values()?;
        let period = tuning.period();
        let lumped = Lumped::new(inertia.values(), cutoff, period);
        let inertia = inertia.values().to_vec();
        let switching = vec![0.0; inertia.len()];
        Ok(Self {
            surface,
            gain,
            damping,
            adaptation,
            leakage,
            layer,
            inertia,
            lumped,
            switching,
            period,
        })
    }

    fn update(
        &mut self,
        sees: MotionAndTorque<'_>,
        wants: Acceleration<'_>,
        clipped: &[bool],
        tau: &mut [f64],
    ) {
        let phi = self.lumped.advance(sees);
        for (i, tau) in tau.iter_mut().enumerate() {
            let (e, de) = (sees.q[i] - wants.q[i], sees.dq[i] - wants.dq[i]);
            let s = de + self.surface * e;
            let beta = &mut self.switching[i];
            if !clipped[i] {
                *beta += self.period * self.adaptation * s.abs();
                *beta /= 1.0 + self.period * self.leakage;
            }
            let damping = self.gain + self.damping * (1.0 + e * e + de * de + e.powi(4));
            let robust = damping * s + *beta * (s / self.layer).tanh();
            *tau = self.inertia[i] * (wants.ddq[i] - self.surface * de - robust) + phi[i];
        }
    }

    fn states(&self) -> usize {
        self.lumped.states() + self.switching.len()
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let [surface, gain, _, cutoff, ..] = tuning.values::<7>().ok()?;
        Some(window(surface * gain, surface + gain, cutoff, tuning.period(), arm))
    }
}
