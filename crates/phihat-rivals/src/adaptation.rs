//! Parameters of a regressor, estimated while the arm runs.

use crate::regressor::{ParameterGroup, Regressor};
use crate::tuning::Tuning;

/// `Y θ̂` over the identifiable columns of a regressor, and `dθ̂/dt = −Γ Yᵀ s − σ θ̂` (1).
///
/// `Γ = γ U_j` for a parameter of joint `j`; `θ̂(0) = 0`.
#[derive(Debug)]
pub(crate) struct AdaptedEstimate {
    pub(crate) regressor: Regressor,
    columns: Vec<usize>,
    full: Vec<f64>,
    /// The chosen columns of `Y`, `n × p` row by row.
    pub(crate) y: Vec<f64>,
    /// `θ̂`
    pub(crate) theta: Vec<f64>,
    /// `Γ`, its diagonal.
    pub(crate) rate: Vec<f64>,
}

impl AdaptedEstimate {
    pub(crate) fn new(regressor: Regressor, tuning: &Tuning, gain: f64) -> Self {
        Self::by_group(regressor, tuning, |_| gain)
    }

    /// With a rate of its own for the parameters of each unit.
    pub(crate) fn by_group(
        mut regressor: Regressor,
        tuning: &Tuning,
        gain: impl Fn(ParameterGroup) -> f64,
    ) -> Self {
        let columns = regressor.identifiable();
        let unit =
            |c: &usize| gain(regressor.group_of(*c)) * tuning.units()[regressor.joint_of(*c)];
        let rate: Vec<f64> = columns.iter().map(unit).collect();
        let (n, p) = (regressor.joints(), columns.len());
        Self {
            full: vec![0.0; n * regressor.parameters()],
            y: vec![0.0; n * p],
            theta: vec![0.0; p],
            rate,
            regressor,
            columns,
        }
    }

    /// Number of parameters.
    pub(crate) fn parameters(&self) -> usize {
        self.columns.len()
    }

    /// The chosen columns of a matrix of the regressor.
    pub(crate) fn columns_of(
        &mut self,
        matrix: impl FnOnce(&mut Regressor, &mut [f64]),
        out: &mut [f64],
    ) {
        matrix(&mut self.regressor, &mut self.full);
        let whole = self.full.chunks(self.regressor.parameters());
        for (row, whole) in out.chunks_mut(self.columns.len()).zip(whole) {
            row.iter_mut().zip(&self.columns).for_each(|(y, c)| *y = whole[*c]);
        }
    }

    /// `τ = Y(q, v, w, a) θ̂`; keeps `Y`.
    pub(crate) fn torque(&mut self, q: &[f64], v: &[f64], w: &[f64], a: &[f64], tau: &mut [f64]) {
        let mut y = core::mem::take(&mut self.y);
        self.columns_of(|regressor, out| regressor.at(q, v, w, a, out), &mut y);
        self.y = y;
        for (tau, row) in tau.iter_mut().zip(self.y.chunks(self.columns.len())) {
            *tau = row.iter().zip(&self.theta).map(|(y, theta)| y * theta).sum();
        }
    }

    /// `Yᵀ s` for one parameter.
    pub(crate) fn against(&self, parameter: usize, s: &[f64]) -> f64 {
        let p = self.columns.len();
        s.iter().enumerate().map(|(i, s)| self.y[i * p + parameter] * s).sum()
    }

    /// (1) over one period.
    pub(crate) fn adapt(&mut self, s: &[f64], leakage: f64, period: f64) {
        for k in 0..self.theta.len() {
            let slope = self.rate[k] * self.against(k, s) + leakage * self.theta[k];
            self.theta[k] -= period * slope;
        }
    }
}
