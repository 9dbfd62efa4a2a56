//! Sliding mode with a disturbance observer, one mode of operation.

use crate::card::{Card, Grade, Tick, Ticks};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::measured::{Acceleration, MeasuredMotion, MotionAndTorque};
use crate::nominal::Nominal;
use crate::rival::Rival;
use crate::shared::SLIDING;
use crate::sliding::Sliding;
use crate::tuning::{Scalar, Tuning};

/// Sliding mode with a disturbance observer, in the class of Yu, Huang and Fei, in a single mode.
///
/// # Law
///
/// With `s, q̇_r, q̈_r` as of Slotine and Li, and `δ̂` the estimate of `M⁻¹ d`:
///
/// ```text
/// τ = M̂ (q̈_r − δ̂) + Ĉ q̇_r + Ĝ + F̂ q̇_r − K s − η sat(s/ε)                              (1)
/// δ̂ = z + L q̇,     ż = −L (M̂⁻¹(τ_applied − Ĉ q̇ − Ĝ − F̂ q̇) + δ̂)                         (2)
/// ```
///
/// so that `dδ̂/dt = L (δ − δ̂)`. `δ̂(0) = 0`. `K` and `η` are per unit of the joint's inertia. (2) is exact for what
/// is held over a sample.
///
/// # Guarantee
///
/// With an exact model and a constant disturbance `s → 0`: `V = ½ sᵀMs`, `dV/dt ≤ −sᵀKs` once `δ̂ = δ`, or where `η`
/// is above `|M̂(δ − δ̂)|`. With several modes, an average dwell time above `ln μ/λ_0`, with `μ` the largest ratio of
/// inertias between modes and `λ_0` the rate of decrease, keeps it.
///
/// # Not claimed
///
/// Switching: the table's arms have one mode of operation, and this has one model.
///
/// # References
///
/// L. Yu, J. Huang, S. Fei, "Sliding mode switching control of manipulators based on disturbance observer", Circuits,
/// Systems, and Signal Processing 36(6), 2017. Grade C: no public copy of the law was found. The title, and Table 1
/// of Hayat, Leibold and Buss, name its parts: sliding mode, disturbance observer, average dwell time. Unknown are
/// the observer's gain, whether the sliding variable is linear, what differs between modes, and the gains.
#[derive(Debug)]
pub(crate) struct Switching {
    sliding: Sliding,
    gain: [Vec<f64>; 2],
    boundary: f64,
    /// `L`, and `exp(−L T)`.
    observer: [f64; 2],
    model: Nominal,
    z: Vec<f64>,
    started: bool,
    ddq: Vec<f64>,
}

impl Rival for Switching {
    const CARD: Card = Card {
        id: "switching",
        title: "Sliding mode with observer (Yu, Huang, Fei)",
        reference: "[22]",
        source: "Yu, Huang, Fei, Circuits, Systems, Signal Process. 36(6), 2017",
        grade: Grade::C,
        caveat: "published law not found; the table has the single-mode case, without switching. Unknown: the \
            observer's gain, the sliding variable, what differs between modes",
        law: "τ = M̂ (q̈_r − δ̂) + Ĉ q̇_r + Ĝ + F̂ q̇_r − K s − η sat(s/ε)",
        printed: Some(Ticks {
            quantitative: Tick::Partly,
            easy: Tick::Yes,
            optimal: Tick::No,
            model_free: Tick::Partly,
        }),
    };
    const SCALARS: &'static [Scalar] = &[
        SLIDING,
        Scalar {
            name: "damping",
            unit: "1/s",
            meaning: "K of s",
            default: 20.0,
            low: 2.0,
            high: 200.0,
        },
        Scalar {
            name: "switching",
            unit: "rad/s²",
            meaning: "η of the switching term",
            default: 8.0,
            low: 0.8,
            high: 80.0,
        },
        Scalar {
            name: "boundary",
            unit: "rad/s",
            meaning: "ε, where it is smoothed",
            default: 0.05,
            low: 0.005,
            high: 0.5,
        },
        Scalar {
            name: "observer",
            unit: "rad/s",
            meaning: "L of the observer",
            default: 40.0,
            low: 4.0,
            high: 400.0,
        },
    ];
    type Sees<'a> = MotionAndTorque<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Nominal;

    fn new(tuning: &Tuning, model: Nominal) -> Result<Self, RivalRefusal> {
        let [sliding, damping, switching, boundary, observer] = tuning.values()?;
        let n = tuning.joints();
        Ok(Self {
            sliding: Sliding::new(sliding, n),
            gain: [tuning.per_joint(damping), tuning.per_joint(switching)],
            boundary,
            observer: [observer, (-observer * tuning.period()).exp()],
            model,
            z: vec![0.0; n],
            started: false,
            ddq: vec![0.0; n],
        })
    }

    fn update(
        &mut self,
        sees: MotionAndTorque<'_>,
        wants: Acceleration<'_>,
        _: &[bool],
        tau: &mut [f64],
    ) {
        let [rate, keep] = self.observer;
        self.model.acceleration(sees.q, sees.dq, sees.tau, &mut self.ddq);
        for (i, z) in self.z.iter_mut().enumerate() {
            let held = self.ddq[i] + rate * sees.dq[i];
            // Before the first torque there is nothing to observe.
            *z = if self.started { keep * *z - (1.0 - keep) * held } else { -rate * sees.dq[i] };
        }
        self.started = true;
        self.sliding.update(&MeasuredMotion { q: sees.q, dq: sees.dq }, &wants);
        let Sliding { s, v, a, .. } = &mut self.sliding;
        for (i, a) in a.iter_mut().enumerate() {
            *a -= self.z[i] + rate * sees.dq[i];
        }
        self.model.torque(sees.q, sees.dq, v, a, tau);
        for (i, tau) in tau.iter_mut().enumerate() {
            let smooth = (s[i] / self.boundary).clamp(-1.0, 1.0);
            *tau -= self.gain[0][i] * s[i] + self.gain[1][i] * smooth;
        }
    }

    fn states(&self) -> usize {
        self.z.len()
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let [_, damping, switching, boundary, _] = tuning.values().ok()?;
        let (gain, period) = (damping + switching / boundary, tuning.period());
        Some(Condition::sampled(
            "(K + η/ε) T below the smallest inertia's limit",
            gain,
            period,
            arm,
        ))
    }
}
