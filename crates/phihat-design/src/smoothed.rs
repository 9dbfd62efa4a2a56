//! A record of positions and torques, seen through one filter: what least squares can be done on.

use crate::trace::JointSignals;

/// Record of one joint at every sample.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedJoint {
    /// Joint name.
    pub name: String,
    /// Position as the encoder said it \[rad\].
    pub q: Vec<f64>,
    /// Torque that acted from this sample to the next \[N·m\].
    pub tau: Vec<f64>,
}

/// Samples within `reach` of one between which and the next a joint turns round: a filter mixes both directions there.
pub fn near_turns(dq: &[f64], reach: usize) -> Vec<bool> {
    let mut near = vec![false; dq.len()];
    for (k, pair) in dq.windows(2).enumerate() {
        if pair[0] * pair[1] < 0.0 {
            near[k.saturating_sub(reach)..(k + reach + 1).min(dq.len())].fill(true);
        }
    }
    near
}

/// Variance of a fourth difference of white noise of variance 1: `1 + 16 + 36 + 16 + 1`.
pub const FOURTH_VARIANCE: f64 = 70.0;

/// Fourth differences: what they leave of a motion is as fast as its samples.
pub fn fourth_differences(x: &[f64]) -> impl Iterator<Item = f64> + '_ {
    x.windows(5).map(|x| x[0] - 4.0 * x[1] + 6.0 * x[2] - 4.0 * x[3] + x[4])
}

/// The joints of a record with the derivatives that an estimate needs.
///
/// # Method
///
/// With `B` the mean over a box of width `w`, and `Δ` the difference over it, `B⁴τ` is paired with
/// `B²Δ²q/w² = B⁴q̈` and `B³Δq/w = B⁴q̇`. Positions are never differenced over one sample, and what is linear
/// with constant coefficients, `τ = M q̈ + d q̇ + G q + τ_0`, stays exactly so, because all of it went
/// through the same `B⁴`. Row `k` is about the time from sample `k` to `4w` later.
///
/// # Example
///
/// ```
/// use phihat_design::{RecordedJoint, enclose_inertia};
///
/// // 0.3 kg·m² and 2 N·m·s/rad on two sines at 1 kHz.
/// let at = |k: u32, of: fn(f64) -> f64| of(f64::from(k) * 1e-3);
/// let q: Vec<f64> = (0..6000).map(|k| at(k, |t| 0.4 * (2.0 * t).sin() + 0.1 * (9.0 * t).sin())).collect();
/// let tau = (0..6000).map(|k| {
///     at(k, |t| {
///         let t = t + 5e-4; // the middle of the sample
///         let dq = 0.8 * (2.0 * t).cos() + 0.9 * (9.0 * t).cos();
///         let ddq = -1.6 * (2.0 * t).sin() - 8.1 * (9.0 * t).sin();
///         0.3 * ddq + 2.0 * dq
///     })
/// });
/// let record = [RecordedJoint { name: "axis".into(), q, tau: tau.collect() }];
/// let found = enclose_inertia(&record, 1_000_000, 0.01)?;
/// let found = found[0].map_err(|why| why.to_string())?;
/// assert!((found.low_kg_m2 - 0.3).abs() < 1e-3 && (found.high_kg_m2 - 0.3).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Smoothed {
    /// Time between rows \[ns\].
    pub period_ns: u64,
    /// Rows between two that have no sample in common.
    reach: usize,
    joints: Vec<SmoothedJoint>,
}

#[derive(Debug, Clone, PartialEq)]
struct SmoothedJoint {
    name: String,
    q: Vec<f64>,
    dq: Vec<f64>,
    ddq: Vec<f64>,
    tau: Vec<f64>,
}

impl Smoothed {
    /// A record filtered by boxes of a width \[s\]; `None` where it is too short for them, or its joints
    /// differ in length.
    #[must_use]
    pub fn new(joints: &[RecordedJoint], period_ns: u64, width: f64) -> Option<Self> {
        let period = period_ns as f64 * 1e-9;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
        let n = (width / period).round().clamp(1.0, 1e6) as usize;
        let samples = joints.first()?.q.len();
        let rows = samples.checked_sub(4 * n).filter(|rows| *rows > 0)?;
        let fits = |joint: &RecordedJoint| joint.q.len() == samples && joint.tau.len() == samples;
        if !joints.iter().all(fits) {
            return None;
        }
        let w = n as f64 * period;
        let change =
            |x: &[f64]| -> Vec<f64> { x.windows(n + 1).map(|x| (x[n] - x[0]) / w).collect() };
        let mean = |x: &[f64], times: usize| {
            let mut x = x.to_vec();
            for _ in 0..times {
                x = box_mean(&x, n);
            }
            x.truncate(rows);
            x
        };
        let smooth = |joint: &RecordedJoint| {
            let once = change(&joint.q);
            // Torque is held from sample to sample: its impulse is known exactly, and so is its first mean.
            let mut impulse = vec![0.0];
            impulse.extend(joint.tau.iter().scan(0.0, |sum, tau| {
                *sum += tau * period;
                Some(*sum)
            }));
            SmoothedJoint {
                name: joint.name.clone(),
                q: mean(&joint.q, 4),
                dq: mean(&once, 3),
                ddq: mean(&change(&once), 2),
                tau: mean(&change(&impulse), 3),
            }
        };
        Some(Self { period_ns, reach: 4 * n, joints: joints.iter().map(smooth).collect() })
    }

    /// Width of a box in samples.
    pub(crate) fn width_samples(&self) -> usize {
        self.reach / 4
    }

    /// Rows between two that have no sample in common.
    pub fn reach(&self) -> usize {
        self.reach
    }

    /// The signals, joint by joint.
    #[must_use]
    pub fn signals(&self) -> Vec<JointSignals<'_>> {
        let signals = self.joints.iter().map(|joint| JointSignals {
            name: &joint.name,
            q: &joint.q,
            dq: &joint.dq,
            ddq: &joint.ddq,
            tau: &joint.tau,
        });
        signals.collect()
    }
}

/// The mean over each `n` intervals between samples, by the trapezoid rule.
fn box_mean(x: &[f64], n: usize) -> Vec<f64> {
    let mut sums = vec![0.0];
    sums.extend(x.windows(2).scan(0.0, |sum, pair| {
        *sum += 0.5 * (pair[0] + pair[1]);
        Some(*sum)
    }));
    sums.windows(n + 1).map(|sums| (sums[n] - sums[0]) / n as f64).collect()
}
