//! A multidimensional Taylor network as inverse controller, for the class of Zhang and Yan.

use crate::card::{Card, Grade};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::facts::Nothing;
use crate::measured::{Acceleration, MeasuredMotion};
use crate::rival::Rival;
use crate::shared::SURFACE;
use crate::tuning::{Scalar, Tuning};

/// Polynomial of the reference with adapted coefficients, and a PD.
///
/// # Law
///
/// ```text
/// s = ė + λ e,    τ = U (W p − k s),    Ẇ = −Γ s pᵀ/(1 + pᵀp) − σ W                    (1)
/// ```
///
/// `p` has all monomials up to degree 2 of `(q_d, q̇_d, q̈_d)`: `(3n + 2)(3n + 1)/2` of them, 55 for three
/// joints and 253 for seven; as many weights per joint. The leakage is taken implicitly; (1) stands still
/// while any joint's torque is limited.
///
/// # Guarantee
///
/// Bounded weights and errors where the network can represent the torque of the motion, by the usual argument for a
/// normalised gradient with leakage. The condition is the sampled one of the damping.
///
/// # Not claimed
///
/// A number for the bound; anything off the reference: `p` does not see the arm.
///
/// # References
///
/// C. Zhang, H.-S. Yan, "Inverse control of multi-dimensional Taylor network for permanent magnet synchronous motor",
/// COMPEL 36(6), 2017. Grade C: a law of its class, for an arm.
#[derive(Debug)]
pub(crate) struct TaylorNetwork {
    surface: f64,
    gain: f64,
    adaptation: f64,
    keep: f64,
    units: Vec<f64>,
    /// `1, q_d, q̇_d, q̈_d`
    inputs: Vec<f64>,
    monomials: Vec<f64>,
    /// `W`, joint by joint.
    weights: Vec<f64>,
    period: f64,
}

impl TaylorNetwork {
    fn expand(&mut self, wants: Acceleration<'_>) {
        let n = self.units.len();
        self.inputs[1..=n].copy_from_slice(wants.q);
        self.inputs[n + 1..=2 * n].copy_from_slice(wants.dq);
        self.inputs[2 * n + 1..].copy_from_slice(wants.ddq);
        let inputs = &self.inputs;
        let pairs =
            inputs.iter().enumerate().flat_map(|(i, x)| inputs[i..].iter().map(move |y| x * y));
        for (monomial, product) in self.monomials.iter_mut().zip(pairs) {
            *monomial = product;
        }
    }
}

impl Rival for TaylorNetwork {
    const CARD: Card = Card {
        id: "taylor-network",
        title: "Multidimensional Taylor network (Zhang, Yan, class)",
        reference: "[31]",
        source: "Zhang, Yan, COMPEL 36(6), 2017",
        grade: Grade::C,
        caveat: "the published law drives a motor: a polynomial network as inverse controller stands for it",
        law: "τ = U (W p(q_d, q̇_d, q̈_d) − k s),  Ẇ = −Γ s pᵀ/(1 + pᵀp) − σ W",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[
        SURFACE,
        Scalar {
            name: "gain",
            unit: "1/s",
            meaning: "k on s",
            default: 100.0,
            low: 10.0,
            high: 1000.0,
        },
        Scalar {
            name: "adaptation",
            unit: "1/s²",
            meaning: "Γ of the weights",
            default: 120.0,
            low: 12.0,
            high: 1200.0,
        },
        Scalar {
            name: "leakage",
            unit: "1/s",
            meaning: "σ of the weights",
            default: 0.01,
            low: 1e-3,
            high: 0.1,
        },
    ];
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Nothing;

    fn new(tuning: &Tuning, _: Nothing) -> Result<Self, RivalRefusal> {
        let [surface, gain, adaptation, leakage] = tuning.values()?;
        let (n, period) = (tuning.joints(), tuning.period());
        let monomials = vec![0.0; (3 * n + 2) * (3 * n + 1) / 2];
        let mut inputs = vec![0.0; 3 * n + 1];
        inputs[0] = 1.0;
        Ok(Self {
            surface,
            gain,
            adaptation,
            keep: 1.0 / (1.0 + period * leakage),
            units: tuning.units().to_vec(),
            inputs,
            weights: vec![0.0; n * monomials.len()],
            monomials,
            period,
        })
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Acceleration<'_>,
        clipped: &[bool],
        tau: &mut [f64],
    ) {
        self.expand(wants);
        let size = 1.0 + self.monomials.iter().map(|p| p * p).sum::<f64>();
        let still = clipped.contains(&true);
        let rows = self.weights.chunks_exact_mut(self.monomials.len());
        for (i, (tau, row)) in tau.iter_mut().zip(rows).enumerate() {
            let s = sees.dq[i] - wants.dq[i] + self.surface * (sees.q[i] - wants.q[i]);
            let step = self.period * self.adaptation * s / size;
            let mut network = 0.0;
            for (weight, p) in row.iter_mut().zip(&self.monomials) {
                if !still {
                    *weight = self.keep * (*weight - step * p);
                }
                network += *weight * p;
            }
            *tau = self.units[i] * (network - self.gain * s);
        }
    }

    fn states(&self) -> usize {
        self.weights.len()
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let [_, gain, ..] = tuning.values::<4>().ok()?;
        let floor = arm.ratio_min(gain, tuning.period());
        Some(Condition::above("k T < cμ; c = 2, behind one sample of delay 1", arm.ratio[0], floor))
    }
}
