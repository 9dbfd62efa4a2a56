//! Functions of time that a periodic unknown is a sum of.

use core::f64::consts::TAU;

/// Harmonics of the task's frequency.
const HARMONICS: usize = 5;

/// Length of the basis: the constant, and a cosine and a sine of each harmonic.
pub(crate) const BASIS: usize = 2 * HARMONICS + 1;

/// `z(t) = [1, cos ωt, sin ωt, …, cos 5ωt, sin 5ωt]`, sample by sample.
#[derive(Debug)]
pub(crate) struct Basis {
    turn: f64,
    phase: f64,
}

impl Basis {
    pub(crate) fn new(task_period: f64, period: f64) -> Self {
        Self { turn: period / task_period, phase: 0.0 }
    }

    /// `z` now; the next call is a sample later.
    pub(crate) fn next(&mut self) -> [f64; BASIS] {
        let mut z = [1.0; BASIS];
        let angle = TAU * self.phase;
        let mut multiple = 0.0;
        for pair in z[1..].chunks_mut(2) {
            multiple += angle;
            let (sin, cos) = multiple.sin_cos();
            pair.copy_from_slice(&[cos, sin]);
        }
        self.phase = (self.phase + self.turn).fract();
        z
    }
}

/// `wᵀ z`
pub(crate) fn sum(w: &[f64], z: &[f64]) -> f64 {
    w.iter().zip(z).map(|(w, z)| w * z).sum()
}
