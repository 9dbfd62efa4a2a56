//! The unknown dynamics `φ`, observed in a run.

use crate::demand::PhiAlong;
use crate::trace::Trace;

/// Windows over which the smooth part is averaged \[s\].
const WINDOWS: [f64; 6] = [0.0, 0.005, 0.01, 0.02, 0.05, 0.1];

/// Weight of a rate of φ against a jump \[s\]: about the ratio of a loop's gains from both.
const RAMP: f64 = 0.02;

/// `φ = τ_applied − M̄ q̈` of a run, in its steady part.
#[derive(Debug, Clone, PartialEq)]
pub struct Observed {
    period: f64,
    /// `tau[joint][sample]`.
    tau: Vec<Vec<f64>>,
    /// `ddq[joint][sample]`.
    ddq: Vec<Vec<f64>>,
}

impl Observed {
    /// The part of a trace from `settle` \[s\] on.
    pub fn of(trace: &Trace, settle: f64) -> Self {
        let from = trace.index_at(settle);
        let part = |values: &Vec<f64>| values.get(from..).unwrap_or_default().to_vec();
        Self {
            period: trace.period_ns as f64 * 1e-9,
            tau: trace.joints.iter().map(|joint| part(&joint.tau_applied)).collect(),
            ddq: trace.joints.iter().map(|joint| part(&joint.ddq)).collect(),
        }
    }

    /// Signals of every joint at equal times: torque that acted \[N·m\], acceleration \[rad/s²\]; `period` in s.
    pub fn of_signals(joints: &[(&[f64], &[f64])], period: f64) -> Self {
        let (tau, ddq) = joints.iter().map(|(tau, ddq)| (tau.to_vec(), ddq.to_vec())).unzip();
        Self { period, tau, ddq }
    }

    /// Bounds on a joint's `φ` as the run showed it, for a nominal inertia `M̄` \[kg·m²\].
    ///
    /// # Method
    ///
    /// `φ` is split into a moving average and the rest. Any split of what was recorded is a true one; of a
    /// few windows, the one with the least `0.02 s · max|φ̇_smooth| + max|φ_jump|` is taken.
    pub fn phi(&self, joint: usize, inertia: f64) -> PhiAlong {
        let phi: Vec<f64> =
            self.tau[joint].iter().zip(&self.ddq[joint]).map(|(t, a)| t - inertia * a).collect();
        let size = largest(phi.iter().copied());
        let split = |window: f64| {
            let smooth = averaged(&phi, (0.5 * window / self.period).round());
            let jump = largest(phi.iter().zip(&smooth).map(|(all, smooth)| all - smooth));
            let steps = smooth.windows(2).map(|pair| pair[1] - pair[0]);
            PhiAlong { size, rate: largest(steps) / self.period, jump }
        };
        let cost = |phi: &PhiAlong| RAMP * phi.rate + phi.jump;
        let better = |a: PhiAlong, b: PhiAlong| if cost(&b) < cost(&a) { b } else { a };
        let first = split(WINDOWS[0]);
        WINDOWS[1..].iter().map(|window| split(*window)).fold(first, better)
    }
}

/// Mean over `half` samples on both sides, fewer at the ends.
fn averaged(values: &[f64], half: f64) -> Vec<f64> {
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "at most 0.1 s in samples of at least 50 µs"
    )]
    let half = half as usize;
    let mut sums = vec![0.0];
    for value in values {
        sums.push(sums[sums.len() - 1] + value);
    }
    let mean = |k: usize| {
        // As many on both sides, so that a ramp stays the same ramp.
        let reach = half.min(k).min(values.len() - 1 - k);
        let (from, to) = (k - reach, k + reach + 1);
        (sums[to] - sums[from]) / (to - from) as f64
    };
    (0..values.len()).map(mean).collect()
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |most, value| value.abs().max(most))
}
