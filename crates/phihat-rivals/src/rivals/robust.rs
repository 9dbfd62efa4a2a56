//! Inverse dynamics with a unit-vector term against what the model lacks.

use crate::card::{Card, Grade, Tick, Ticks};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::measured::{Acceleration, MeasuredMotion};
use crate::nominal::Nominal;
use crate::rival::Rival;
use crate::tuning::{Scalar, Tuning};

/// Robust inverse dynamics with a Riccati direction, in the class of Bascetta and Rocco.
///
/// # Law
///
/// ```text
/// τ = M̂(q) (q̈_d − z − ρ z/max(‖z‖, ε)) + Ĉ(q, q̇) q̇ + Ĝ(q) + F̂ q̇                        (1)
/// z = BᵀP x = p_12 e + p_22 ė,     p_12 = √q_1,  p_22 = √(q_2 + 2 √q_1)                   (2)
/// ```
///
/// (2) solves `AᵀP + PA − PBBᵀP + diag(q_1, q_2) = 0` for the double integrator: `K_p = p_12` and `K_d = p_22`, so that
/// the gains need not be paid for by `ρ` as with a Lyapunov equation. `ε = δ p_22`, `δ` in units of velocity.
///
/// # Guarantee
///
/// If `ρ` is above the size of `(M⁻¹M̂ − 1)(q̈_d + u) + M⁻¹(n̂ − n)`, which requires `‖M⁻¹M̂ − 1‖ < 1`, the
/// error ends within a ball whose radius goes to zero with `ε`.
///
/// # Not claimed
///
/// The radius itself, and that `ρ` is large enough: the bound is the user's.
///
/// # References
///
/// L. Bascetta, P. Rocco, "Revising the robust-control design for rigid robot manipulators", IEEE Trans. Robotics
/// 26(1), 2010. M. W. Spong, M. Vidyasagar, "Robot Dynamics and Control", 1989, for the class. Grade C: no public
/// copy of the law was found. Public is what Hayat, Leibold and Buss say of it in Table 1: a Riccati inequality, a
/// regressor, and nominal PD gains that do not weigh on the robustness. Unknown are the weights of the inequality,
/// the bound that `ρ` stands for and whether it depends on the state, and how the regressor enters: (1) takes a
/// nominal model in its place.
#[derive(Debug)]
pub(crate) struct Robust {
    direction: [f64; 2],
    rho: f64,
    boundary: f64,
    model: Nominal,
    z: Vec<f64>,
}

impl Rival for Robust {
    const CARD: Card = Card {
        id: "robust",
        title: "Robust inverse dynamics (Bascetta, Rocco)",
        reference: "[25]",
        source: "Bascetta, Rocco, IEEE T-RO 26(1), 2010",
        grade: Grade::C,
        caveat: "published law not found: a unit-vector law with a Riccati direction stands for it. Unknown: the \
            weights, the bound of ρ, how the regressor enters",
        law: "τ = M̂ (q̈_d − z − ρ z/max(‖z‖, ε)) + Ĉ q̇ + Ĝ + F̂ q̇,  z = BᵀP x",
        printed: Some(Ticks {
            quantitative: Tick::No,
            easy: Tick::Partly,
            optimal: Tick::No,
            model_free: Tick::No,
        }),
    };
    const SCALARS: &'static [Scalar] = &[
        Scalar {
            name: "position_weight",
            unit: "1/s⁴",
            meaning: "q_1, K_p = √q_1",
            default: 1e4,
            low: 1e2,
            high: 1e6,
        },
        Scalar {
            name: "velocity_weight",
            unit: "1/s²",
            meaning: "q_2 of K_d = √(q_2 + 2√q_1)",
            default: 200.0,
            low: 2.0,
            high: 2000.0,
        },
        Scalar {
            name: "robust",
            unit: "rad/s²",
            meaning: "ρ, what the unit vector can take",
            default: 30.0,
            low: 3.0,
            high: 300.0,
        },
        Scalar {
            name: "boundary",
            unit: "rad/s",
            meaning: "δ, where the unit vector is smoothed",
            default: 0.05,
            low: 0.005,
            high: 0.5,
        },
    ];
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Nominal;

    fn new(tuning: &Tuning, model: Nominal) -> Result<Self, RivalRefusal> {
        let [position, velocity, robust, boundary] = tuning.values()?;
        let p22 = (velocity + 2.0 * position.sqrt()).sqrt();
        let z = vec![0.0; tuning.joints()];
        Ok(Self {
            direction: [position.sqrt(), p22],
            rho: robust,
            boundary: boundary * p22,
            model,
            z,
        })
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Acceleration<'_>,
        _: &[bool],
        tau: &mut [f64],
    ) {
        let [p12, p22] = self.direction;
        for (i, z) in self.z.iter_mut().enumerate() {
            *z = p12 * (sees.q[i] - wants.q[i]) + p22 * (sees.dq[i] - wants.dq[i]);
        }
        let size = self.z.iter().map(|z| z * z).sum::<f64>().sqrt().max(self.boundary);
        for (i, z) in self.z.iter_mut().enumerate() {
            *z = wants.ddq[i] - *z - self.rho * *z / size;
        }
        self.model.torque(sees.q, sees.dq, sees.dq, &self.z, tau);
    }

    fn states(&self) -> usize {
        0
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let [position, velocity, robust, boundary] = tuning.values().ok()?;
        let gain = (velocity + 2.0 * position.sqrt()).sqrt() + robust / boundary;
        // The gain is on M̂ itself: every eigenvalue of M⁻¹M̂ is taken as 1.
        let arm = DeclaredArm { ratio: [1.0, 1.0], ..arm.clone() };
        Some(Condition::sampled("(K_d + ρ/δ) T < 2 with M̂ = M", gain, tuning.period(), &arm))
    }
}
