//! The low-passed lumped dynamics of every joint, for laws that add something to its estimator.

use crate::measured::MotionAndTorque;

/// `φ̂ = g/(s + g) φ`, `φ = τ_applied − M̄ q̈`, with its exact sampled pole and without a derivative:
///
/// ```text
/// φ̂ ← φ̂ + (1 − e^{−gT}) (τ_applied − M̄ (q̇_k − q̇_{k−1})/T − φ̂)                          (1)
/// ```
///
/// `φ̂ = 0` at the first sample.
#[derive(Debug)]
pub(crate) struct Lumped {
    inertia: Vec<f64>,
    share: f64,
    estimate: Vec<f64>,
    dq: Vec<f64>,
    started: bool,
    period: f64,
}

impl Lumped {
    pub(crate) fn new(inertia: &[f64], cutoff: f64, period: f64) -> Self {
        Self {
            inertia: inertia.to_vec(),
            share: -(-cutoff * period).exp_m1(),
            estimate: vec![0.0; inertia.len()],
            dq: vec![0.0; inertia.len()],
            started: false,
            period,
        }
    }

    /// (1); what is there to be changed by the law is its estimate \[N·m\] per joint.
    pub(crate) fn advance(&mut self, sees: MotionAndTorque<'_>) -> &mut [f64] {
        for (i, phi) in self.estimate.iter_mut().enumerate() {
            if self.started {
                let inertial = self.inertia[i] * (sees.dq[i] - self.dq[i]) / self.period;
                *phi += self.share * (sees.tau[i] - inertial - *phi);
            }
            self.dq[i] = sees.dq[i];
        }
        self.started = true;
        &mut self.estimate
    }

    /// Scalars that it remembers, as an observer in continuous time counts them.
    pub(crate) fn states(&self) -> usize {
        self.estimate.len()
    }
}
