//! The closed loop as one linear step: what the core, the drive and the inertia do in one sample.

use nalgebra::{DMatrix, DVector, RowDVector, Schur};
use phihat_certificate::extremes::Extremes as _;

use super::model::LoopModel;
use super::sample::{Input, SampledLoop};
use crate::JointRecord;
use crate::portable;

/// Reaction of the torque to an input: `u_k = state·x_k + direct·input_k`,
/// `x_{k+1} = A x_k + drives·input_k`.
#[derive(Debug, Clone, PartialEq)]
pub struct Reaction {
    /// Column of the input in the step.
    pub drives: DVector<f64>,
    /// Row of the torque on the state.
    pub state: RowDVector<f64>,
    /// The input's share in the torque of the same sample.
    pub direct: f64,
}

/// The closed loop of one joint at one inertia ratio, one sample to the next, in units of `M̄`.
///
/// The state is `(q, q̇/ω, ξ …)`, `ω = √K_p`, `ξ` the law's as in [`phihat::LinearLaw`], and, where the loop has them:
/// last sensed position, filtered velocity, mean torque of the interval just ended, torque at its end, the delay line,
/// the torques sent last; all divided by a power of `ω` so that they count in radians.
///
/// # Method
///
/// One sample is the law's linear system, as the core gives it, between the simulator's sensor and drive and the
/// exact solution of `μ q̈ = u − φ`; the matrix is this linear map on unit vectors.
#[derive(Debug, Clone, PartialEq)]
pub struct StateMatrix {
    a: DMatrix<f64>,
    encoder: Reaction,
    reference: [Reaction; 3],
    phi: DVector<f64>,
    mu: f64,
    /// `ω`: velocity is `ω` times entry 1.
    unit: f64,
    period: f64,
}

impl StateMatrix {
    /// The loop at inertia ratio `mu`.
    pub fn new(gains: &JointRecord, model: &LoopModel, mu: f64) -> Self {
        let sample = SampledLoop::new(gains, model, mu);
        let n = sample.length();
        let mut a = DMatrix::zeros(n, n);
        let mut torque = RowDVector::zeros(n);
        let scale = sample.scale();
        for i in 0..n {
            let mut x = vec![0.0; n];
            x[i] = scale[i];
            let (next, u) = sample.step(&x, &Input::default());
            a.set_column(i, &DVector::from_vec(next).component_div(&scale));
            torque[i] = u;
        }
        let rest = vec![0.0; n];
        let reaction = |input: &Input| {
            let (next, direct) = sample.step(&rest, input);
            let drives = DVector::from_vec(next).component_div(&scale);
            Reaction { drives, state: torque.clone(), direct }
        };
        let reference = |i: usize| {
            let mut input = Input::default();
            input.reference[i] = 1.0;
            reaction(&input)
        };
        Self {
            encoder: reaction(&Input { encoder: 1.0, ..Input::default() }),
            reference: [reference(0), reference(1), reference(2)],
            phi: reaction(&Input { phi: 1.0, ..Input::default() }).drives,
            a,
            mu,
            unit: scale[1],
            period: model.period_s,
        }
    }

    /// `A` in `x_{k+1} = A x_k`; position is entry 0, velocity [`Self::unit`] times entry 1.
    pub fn matrix(&self) -> &DMatrix<f64> {
        &self.a
    }

    /// `ω = √K_p` \[1/s\].
    pub fn unit(&self) -> f64 {
        self.unit
    }

    /// Torque in units of `M̄` after a position read wrong by 1 rad.
    pub fn encoder(&self) -> &Reaction {
        &self.encoder
    }

    /// Torque in units of `M̄` after a reference of 1 in `q_d`, `q̇_d`, `q̈_d`.
    pub fn reference(&self) -> &[Reaction; 3] {
        &self.reference
    }

    /// Column of `φ/M̄ = 1` held over one interval.
    pub fn disturbance(&self) -> &DVector<f64> {
        &self.phi
    }

    /// Inertia ratio `μ` of this matrix.
    pub fn mu(&self) -> f64 {
        self.mu
    }

    /// Sample period \[s\].
    pub fn period(&self) -> f64 {
        self.period
    }

    /// Largest magnitude of an eigenvalue; infinite should the eigenvalues not be found.
    pub fn spectral_radius(&self) -> f64 {
        Schur::try_new(self.a.clone(), 1e-15, 10_000).map_or(f64::INFINITY, |schur| {
            schur.complex_eigenvalues().iter().map(|z| portable::size(*z)).largest()
        })
    }

    /// Decay rate of the slowest mode \[1/s\]; negative when the loop is unstable.
    pub fn decay_rate(&self) -> f64 {
        -libm::log(self.spectral_radius()) / self.period
    }
}
