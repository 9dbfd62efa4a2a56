//! A fuzzy estimate of the lumped dynamics, for the class of Fateh and others.

use crate::card::{Card, Grade};
use crate::error::RivalRefusal;
use crate::facts::Inertia;
use crate::math::Weighted;
use crate::measured::{Acceleration, MeasuredMotion};
use crate::rival::Rival;
use crate::rivals::proposed::{BANDWIDTH, DAMPING, outer_gains};
use crate::tuning::{Scalar, Tuning};

/// Adaptive fuzzy control of every joint.
///
/// # Law
///
/// ```text
/// q̈ = F + τ/M̄;    F̂ = pᵀ ξ(e, ė),    τ = M̄ (q̈_d − K_d ė − K_p e − F̂)                    (1)
/// p ← p + T γ BᵀPx ξ                                                                   (2)
/// ```
///
/// `ξ` are nine products of memberships *negative, zero, positive* in `e/e_s` and `ė/ė_s`: triangles with corners at
/// −1, 0, 1 that add up to 1, constant beyond. `P` solves `AᵀP + PA = −diag(100 1/s², 1)`. (2) stands still while the
/// joint's torque is limited.
///
/// # Guarantee
///
/// `V = ½ xᵀPx + |p − p*|²/(2γ)` falls wherever `½ xᵀQx` exceeds `BᵀPx` times what `ξ` cannot represent: ultimately
/// bounded, while `p` is; the published law has no leakage.
///
/// # Not claimed
///
/// A number for the bound. That this is the published law: it drives motors by voltage.
///
/// # References
///
/// M. M. Fateh, S. Azargoshasb, S. Khorashadizadeh, "Model-free discrete control for robot manipulators using a
/// fuzzy estimator", COMPEL 33(3), 2014. Grade C: a law of its class.
#[derive(Debug)]
pub(crate) struct Fuzzy {
    kp: f64,
    kd: f64,
    weight: Weighted,
    adaptation: f64,
    scales: [f64; 2],
    inertia: Vec<f64>,
    /// `p` \[rad/s²\] per joint.
    consequents: Vec<[f64; 9]>,
    period: f64,
}

/// Memberships negative, zero, positive.
fn memberships(x: f64) -> [f64; 3] {
    let x = x.clamp(-1.0, 1.0);
    [(-x).max(0.0), 1.0 - x.abs(), x.max(0.0)]
}

impl Rival for Fuzzy {
    const CARD: Card = Card {
        id: "fuzzy",
        title: "Fuzzy estimator (Fateh, class)",
        reference: "[32]",
        source: "Fateh, Azargoshasb, Khorashadizadeh, COMPEL 33(3), 2014",
        grade: Grade::C,
        caveat: "the published law commands voltages; this is its counterpart for torques",
        law: "τ = M̄ (q̈_d − K_d ė − K_p e − pᵀξ(e, ė)),  ṗ = γ BᵀPx ξ",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[
        BANDWIDTH,
        DAMPING,
        Scalar {
            name: "adaptation",
            unit: "1/s²",
            meaning: "γ",
            default: 4e4,
            low: 4e3,
            high: 4e5,
        },
        Scalar {
            name: "error_scale",
            unit: "rad",
            meaning: "e_s of the memberships",
            default: 0.1,
            low: 0.01,
            high: 1.0,
        },
        Scalar {
            name: "rate_scale",
            unit: "rad/s",
            meaning: "ė_s of the memberships",
            default: 1.0,
            low: 0.1,
            high: 10.0,
        },
    ];
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Inertia;

    fn new(tuning: &Tuning, inertia: Inertia) -> Result<Self, RivalRefusal> {
        let [omega, zeta, adaptation, error, rate] = tuning.values()?;
        let [kp, kd] = outer_gains(omega, zeta);
        let inertia = inertia.values().to_vec();
        let consequents = vec![[0.0; 9]; inertia.len()];
        let (weight, period) = (Weighted::new(kp, kd), tuning.period());
        let scales = [error, rate];
        Ok(Self { kp, kd, weight, adaptation, scales, inertia, consequents, period })
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
            let (first, second) =
                (memberships(e / self.scales[0]), memberships(de / self.scales[1]));
            let rule = |k: usize| first[k / 3] * second[k % 3];
            let step = self.period * self.adaptation * self.weight.of(e, de);
            let step = if clipped[i] { 0.0 } else { step };
            let mut estimate = 0.0;
            for (k, p) in self.consequents[i].iter_mut().enumerate() {
                *p += step * rule(k);
                estimate += *p * rule(k);
            }
            *tau = self.inertia[i] * (wants.ddq[i] - self.kd * de - self.kp * e - estimate);
        }
    }

    fn states(&self) -> usize {
        9 * self.consequents.len()
    }
}
