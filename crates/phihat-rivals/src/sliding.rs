//! The sliding variable and the motion that goes with it.

use crate::measured::{Acceleration, MeasuredMotion};

/// `s = ė + Λ e`, `q̇_r = q̇_d − Λ e`, `q̈_r = q̈_d − Λ ė`.
#[derive(Debug)]
pub(crate) struct Sliding {
    pub(crate) lambda: f64,
    /// `s` \[rad/s\]
    pub(crate) s: Vec<f64>,
    /// `q̇_r` \[rad/s\]
    pub(crate) v: Vec<f64>,
    /// `q̈_r` \[rad/s²\]
    pub(crate) a: Vec<f64>,
}

impl Sliding {
    pub(crate) fn new(lambda: f64, joints: usize) -> Self {
        Self { lambda, s: vec![0.0; joints], v: vec![0.0; joints], a: vec![0.0; joints] }
    }

    pub(crate) fn update(&mut self, sees: &MeasuredMotion<'_>, wants: &Acceleration<'_>) {
        for i in 0..self.s.len() {
            let (e, de) = (sees.q[i] - wants.q[i], sees.dq[i] - wants.dq[i]);
            self.s[i] = de + self.lambda * e;
            self.v[i] = wants.dq[i] - self.lambda * e;
            self.a[i] = wants.ddq[i] - self.lambda * de;
        }
    }
}
