//! An ultra-local model with robust adaptive laws, for the class of Safaei and others.

use crate::card::{Card, Grade};
use crate::error::RivalRefusal;
use crate::facts::Inertia;
use crate::math::Weighted;
use crate::measured::{Acceleration, MeasuredMotion};
use crate::rival::Rival;
use crate::rivals::proposed::{BANDWIDTH, DAMPING, outer_gains};
use crate::tuning::{Scalar, Tuning};

/// Adaptive model-free control by an ultra-local model.
///
/// # Law
///
/// ```text
/// q̈ = θᵀ(q, q̇) + δ + τ/M̄;    τ = M̄ (q̈_d − K_d ė − K_p e − θ̂ᵀ(q, q̇) − δ̂)                (1)
/// θ̂˙ = Γ_1 BᵀPx (q, q̇) − σ θ̂,    δ̂˙ = Γ_2 BᵀPx − σ δ̂                                     (2)
/// ```
///
/// `P` solves `AᵀP + PA = −diag(100 1/s², 1)`. (2) takes its leakage implicitly and stands still while the joint's
/// torque is limited.
///
/// # Guarantee
///
/// Ultimately bounded: `V = ½ xᵀPx + |θ̃|²/(2Γ_1) + δ̃²/(2Γ_2)` falls but for `σ` and for how `δ` and `θ` change.
///
/// # Not claimed
///
/// A number for the bound. `δ̂` alone is an integral of `BᵀPx`: this is a PID with a little more.
///
/// # References
///
/// A. Safaei, Y. C. Koo, M. N. Mahyuddin, "Adaptive model-free control for robotic manipulators", IEEE IRIS 2017.
/// Grade C: a law of its class; the adaptation gains are this file's.
#[derive(Debug)]
pub(crate) struct UltraLocal {
    kp: f64,
    kd: f64,
    weight: Weighted,
    /// `T Γ` for `q`, `q̇` and the constant.
    steps: [f64; 3],
    keep: f64,
    inertia: Vec<f64>,
    /// `θ̂, δ̂` per joint.
    estimates: Vec<[f64; 3]>,
}

impl Rival for UltraLocal {
    const CARD: Card = Card {
        id: "ultra-local",
        title: "Adaptive ultra-local model (Safaei, class)",
        reference: "[33]",
        source: "Safaei, Koo, Mahyuddin, IEEE IRIS 2017",
        grade: Grade::C,
        caveat: "the published law was not found: an ultra-local model with leaky adaptation stands for it",
        law: "τ = M̄ (q̈_d − K_d ė − K_p e − θ̂ᵀ(q, q̇) − δ̂),  θ̂˙ = Γ₁ BᵀPx (q, q̇) − σ θ̂,  δ̂˙ = Γ₂ BᵀPx − σ δ̂",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[
        BANDWIDTH,
        DAMPING,
        Scalar {
            name: "adaptation",
            unit: "1/s²",
            meaning: "Γ₁ of θ̂",
            default: 2e4,
            low: 2e3,
            high: 2e5,
        },
        Scalar {
            name: "offset_adaptation",
            unit: "1/s²",
            meaning: "Γ₂ of δ̂",
            default: 2e4,
            low: 2e3,
            high: 2e5,
        },
        Scalar {
            name: "leakage",
            unit: "1/s",
            meaning: "σ of both",
            default: 0.1,
            low: 1e-3,
            high: 1.0,
        },
    ];
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Inertia;

    fn new(tuning: &Tuning, inertia: Inertia) -> Result<Self, RivalRefusal> {
        let [omega, zeta, adaptation, offset, leakage] = tuning.values()?;
        let [kp, kd] = outer_gains(omega, zeta);
        let inertia = inertia.values().to_vec();
        let (h, estimates) = (tuning.period(), vec![[0.0; 3]; inertia.len()]);
        Ok(Self {
            kp,
            kd,
            weight: Weighted::new(kp, kd),
            steps: [h * adaptation, h * adaptation, h * offset],
            keep: 1.0 / (1.0 + h * leakage),
            inertia,
            estimates,
        })
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Acceleration<'_>,
        clipped: &[bool],
        tau: &mut [f64],
    ) {
        for (i, tau) in tau.iter_mut().enumerate() {
            let (e, de) = (sees.q[i] - wants.q[i], sees.dq[i] - wants.dq[i]);
            let (weighted, input) = (self.weight.of(e, de), [sees.q[i], sees.dq[i], 1.0]);
            let mut lumped = 0.0;
            for ((estimate, step), x) in self.estimates[i].iter_mut().zip(self.steps).zip(input) {
                if !clipped[i] {
                    *estimate = self.keep * (*estimate + step * weighted * x);
                }
                lumped += *estimate * x;
            }
            *tau = self.inertia[i] * (wants.ddq[i] - self.kd * de - self.kp * e - lumped);
        }
    }

    fn states(&self) -> usize {
        3 * self.estimates.len()
    }
}
