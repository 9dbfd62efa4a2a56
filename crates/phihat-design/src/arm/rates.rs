//! Rates of change of the inertia of a moving arm.

use nalgebra::{DMatrix, DVector};
use phihat_certificate::extremes::{Extremes as _, larger};
use phihat_model::Workspace;

use super::postures::{PostureSet, scaled_mass_matrix};

/// Step of the central differences \[rad, m\].
const STEP: f64 = 1e-5;

/// Postures at which all joints are let go at their speed limits, and those from which the search goes on.
const SAMPLES: usize = 150;
const FOLLOWED: usize = 3;

/// Turns of the search between signs and vector, and halvings of its step in posture.
const TURNS: u32 = 4;
const HALVINGS: u32 = 6;

/// Largest `‖dW/dt‖` \[1/s\] of `W = M̄^{-1/2} M M̄^{-1/2}`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct InertiaRates {
    /// Along the reference, at the postures that were handed over; `None`: none were.
    pub motion_per_s: Option<f64>,
    /// With every joint at its speed limit: the largest found; `None`: a joint states no limit.
    pub limits_per_s: Option<f64>,
}

pub(super) fn rates(postures: &PostureSet, nominal: &[f64]) -> InertiaRates {
    let at = RateAt { postures, nominal };
    InertiaRates { motion_per_s: at.along(), limits_per_s: at.at_limits() }
}

struct RateAt<'a> {
    postures: &'a PostureSet,
    nominal: &'a [f64],
}

impl RateAt<'_> {
    fn along(&self) -> Option<f64> {
        let payloads = 0..=self.postures.heaviest;
        let passing = self.postures.passing.iter();
        let all = passing.flat_map(|(q, dq)| {
            payloads.clone().map(move |payload| largest(&self.slope(q, dq, payload)).0.abs())
        });
        all.reduce(larger)
    }

    /// `Σ_j ∂W/∂q_j q̇_j`.
    fn slope(&self, q: &[f64], dq: &[f64], payload: usize) -> DMatrix<f64> {
        let speed = dq.iter().map(|dq| dq.abs()).largest();
        let step = STEP / speed.max(f64::MIN_POSITIVE);
        let model = &self.postures.payloads[payload].model;
        let mut workspace = Workspace::new(model);
        let mut w = |sign: f64| {
            let q: Vec<f64> = q.iter().zip(dq).map(|(q, dq)| q + sign * step * dq).collect();
            scaled_mass_matrix(model, &mut workspace, &q, self.nominal)
        };
        if speed > 0.0 {
            (w(1.0) - w(-1.0)) / (2.0 * step)
        } else {
            DMatrix::zeros(q.len(), q.len())
        }
    }

    fn at_limits(&self) -> Option<f64> {
        let speeds: Vec<f64> = self.postures.speeds.iter().copied().collect::<Option<_>>()?;
        let (stride, last) =
            (self.postures.heavy.len() / SAMPLES, self.postures.payloads.len() - 1);
        let some = self.postures.heavy.iter().step_by(stride.max(1));
        let mut best: Vec<(f64, Vec<f64>)> =
            some.map(|tried| (self.fastest(&tried.q, &speeds, last), tried.q.clone())).collect();
        best.sort_by(|a, b| b.0.total_cmp(&a.0));
        let ends = best.into_iter().take(FOLLOWED).map(|(_, q)| {
            let over = (1..=self.postures.heaviest).map(|load| self.fastest(&q, &speeds, load));
            let load =
                over.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).map_or(1, |(i, _)| i + 1);
            self.climb(q, &speeds, load)
        });
        ends.reduce(larger)
    }

    /// Steps from posture to posture while it grows.
    fn climb(&self, mut q: Vec<f64>, speeds: &[f64], payload: usize) -> f64 {
        let mut best = self.fastest(&q, speeds, payload);
        let mut step = 0.4;
        for _ in 0..HALVINGS {
            for joint in 0..q.len() {
                for change in [step, -step] {
                    let (low, high) = self.postures.travel[joint];
                    let mut next = q.clone();
                    next[joint] = (next[joint] + change).clamp(low, high);
                    let value = self.fastest(&next, speeds, payload);
                    if value > best {
                        (best, q) = (value, next);
                    }
                }
            }
            step *= 0.5;
        }
        best
    }

    /// The largest `|vᵀ (Σ ± s_j ∂W/∂q_j) v|` over unit `v` and all signs, by turns: signs for a vector, the vector for
    /// the signs.
    fn fastest(&self, q: &[f64], speeds: &[f64], payload: usize) -> f64 {
        let n = q.len();
        let alone = |j: usize| {
            let dq: Vec<f64> = (0..n).map(|i| if i == j { speeds[j] } else { 0.0 }).collect();
            self.slope(q, &dq, payload)
        };
        let parts: Vec<DMatrix<f64>> = (0..n).map(alone).collect();
        let from = |start: &DMatrix<f64>| {
            let (mut value, mut vector) = largest(start);
            for _ in 0..TURNS {
                let along = |part: &DMatrix<f64>| (vector.transpose() * part * &vector)[(0, 0)];
                let signs: Vec<f64> = parts.iter().map(|part| along(part).signum()).collect();
                let mut sum = DMatrix::zeros(n, n);
                for (part, sign) in parts.iter().zip(signs) {
                    sum += part * sign;
                }
                (value, vector) = largest(&sum);
            }
            value.abs()
        };
        parts.iter().map(from).largest()
    }
}

/// The eigenvalue of largest size, with its vector.
fn largest(w: &DMatrix<f64>) -> (f64, DVector<f64>) {
    let all = w.clone().symmetric_eigen();
    let sizes = all.eigenvalues.iter().enumerate();
    let at = sizes.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).map_or(0, |(i, _)| i);
    (all.eigenvalues[at], all.eigenvectors.column(at).into_owned())
}
