//! Regressor-free adaptive control by function approximation.

use crate::basis::{BASIS, Basis, sum};
use crate::card::{Card, Grade};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::facts::Period;
use crate::measured::{Acceleration, MeasuredMotion};
use crate::rival::Rival;
use crate::shared::{LEAKAGE, SLIDING, SLIDING_DAMPING};
use crate::sliding::Sliding;
use crate::tuning::{Scalar, Tuning};

/// Function approximation technique of Huang, Wu and Ting.
///
/// # Law
///
/// With `s, q̇_r, q̈_r` as of Slotine and Li, and every entry of `M̂, Ĉ, ĝ` a sum `wᵀ z(t)` over the constant
/// and five harmonics of the task's period:
///
/// ```text
/// τ = M̂ q̈_r + Ĉ q̇_r + ĝ − K_D s                                                        (1)
/// dw_M,ij/dt = −γ_M U_i s_i q̈_r,j z − σ w_M,ij       and with q̇_r,j for C                 (2)
/// dw_g,i/dt = −γ_g U_i s_i z − σ w_g,i
/// ```
///
/// All weights start at zero and stand still while any joint's torque is limited. `γ_C = γ_M`.
///
/// # Guarantee
///
/// With exact bases, `σ = 0`: `V = ½ sᵀMs + Σ w̃ᵀw̃/(2γU)`, `dV/dt = −sᵀK_D s`. Otherwise the error is bounded.
///
/// # Not claimed
///
/// That entries of `M(q(t))` are periodic when the arm is not on its task; the boundary that the approximation
/// error leaves has no figure. The task's period is knowledge of the task.
///
/// # References
///
/// A.-C. Huang, S.-C. Wu, W.-F. Ting, "A FAT-based adaptive controller for robot manipulators without regressor
/// matrix", Robotica 24(2), 2006; A.-C. Huang, M.-C. Chien, "Adaptive Control of Robot Manipulators", 2010. Grade B:
/// the update law is written after the monograph.
#[derive(Debug)]
pub(crate) struct Fat {
    sliding: Sliding,
    gain: Vec<f64>,
    rates: [Vec<f64>; 2],
    leakage: f64,
    period: f64,
    basis: Basis,
    /// Row by row: weights of `M_i1 … M_in`, `C_i1 … C_in`, `g_i`.
    weights: Vec<f64>,
    factors: Vec<f64>,
}

impl Rival for Fat {
    const CARD: Card = Card {
        id: "fat",
        title: "Function approximation (Huang, Wu, Ting)",
        reference: "[4]",
        source: "Huang, Wu, Ting, Robotica 24(2), 2006",
        grade: Grade::B,
        caveat: "the update law is written after the monograph of Huang and Chien; five harmonics and one rate for M \
            and C are this project's",
        law: "τ = M̂ q̈_r + Ĉ q̇_r + ĝ − K_D s,  every entry wᵀ z(t),  dw/dt = −γ s (·) z − σ w",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[
        SLIDING,
        SLIDING_DAMPING,
        Scalar {
            name: "inertia_rate",
            unit: "s²",
            meaning: "γ_M of the weights of M and C",
            default: 1.0,
            low: 0.1,
            high: 10.0,
        },
        Scalar {
            name: "load_rate",
            unit: "1/s²",
            meaning: "γ_g of the weights of g",
            default: 400.0,
            low: 40.0,
            high: 4000.0,
        },
        LEAKAGE,
    ];
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Period;

    fn new(tuning: &Tuning, task: Period) -> Result<Self, RivalRefusal> {
        let [sliding, damping, inertia, load, leakage] = tuning.values()?;
        let n = tuning.joints();
        Ok(Self {
            sliding: Sliding::new(sliding, n),
            gain: tuning.per_joint(damping),
            rates: [tuning.per_joint(inertia), tuning.per_joint(load)],
            leakage,
            period: tuning.period(),
            basis: Basis::new(task.seconds(), tuning.period()),
            weights: vec![0.0; n * (2 * n + 1) * BASIS],
            factors: vec![1.0; 2 * n + 1],
        })
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Acceleration<'_>,
        clipped: &[bool],
        tau: &mut [f64],
    ) {
        self.sliding.update(&sees, &wants);
        let (n, z) = (tau.len(), self.basis.next());
        let (free, keep) = (!clipped.contains(&true), 1.0 - self.leakage * self.period);
        self.factors[..n].copy_from_slice(&self.sliding.a);
        self.factors[n..2 * n].copy_from_slice(&self.sliding.v);
        let rows = self.weights.chunks_mut((2 * n + 1) * BASIS);
        for (i, (tau, row)) in tau.iter_mut().zip(rows).enumerate() {
            let s = self.sliding.s[i];
            *tau = -self.gain[i] * s;
            for (j, (w, factor)) in row.chunks_mut(BASIS).zip(&self.factors).enumerate() {
                *tau += factor * sum(w, &z);
                if free {
                    let step = self.period * self.rates[usize::from(j == 2 * n)][i] * s * factor;
                    w.iter_mut().zip(&z).for_each(|(w, z)| *w = keep * *w - step * z);
                }
            }
        }
    }

    fn states(&self) -> usize {
        self.weights.len()
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let [_, damping, ..] = tuning.values::<5>().ok()?;
        let period = tuning.period();
        Some(Condition::sampled("K_D T below the smallest inertia's limit", damping, period, arm))
    }
}
