//! The last samples, and their means over a window.

use super::body_set::{BodyRow, PARAMETERS};
use super::known_arm::KnownTorque;

/// One joint at one sample.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct WatchedJoint {
    /// Reading \[rad\], and what it is off the reference \[rad\].
    pub(super) q: f64,
    pub(super) e: f64,
    /// Velocity and acceleration of the reference.
    pub(super) dq: f64,
    pub(super) ddq: f64,
    /// Mean torque over the interval that ends here \[N·m\].
    pub(super) tau: f64,
    /// Torques of the model, see [`KnownTorque`].
    pub(super) bare: f64,
    pub(super) more: (f64, f64),
    pub(super) body: BodyRow,
}

/// Ring of the last samples of all joints.
#[derive(Debug)]
pub(super) struct LastSamples {
    joints: usize,
    room: usize,
    /// Place of the next sample.
    next: usize,
    /// Samples without a gap.
    pub(super) count: usize,
    samples: Vec<WatchedJoint>,
}

/// Mean of a joint over a window of two halves, by the weights (CW1).
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct WindowMean {
    pub(super) tau: f64,
    pub(super) bare: f64,
    pub(super) more: (f64, f64),
    pub(super) body: BodyRow,
    /// Mean acceleration beyond that of the reference, from the readings \[rad/s²\].
    pub(super) ddq: f64,
    /// Mean acceleration \[rad/s²\].
    pub(super) whole: f64,
    /// The same, weighed with time from the middle of the window, as (CW3) has it \[rad/s\].
    pub(super) turning: f64,
}

impl LastSamples {
    /// Room for so many samples of so many joints.
    pub(super) fn new(joints: usize, room: usize) -> Self {
        let samples = vec![WatchedJoint::default(); joints * room];
        Self { joints, room, next: 0, count: 0, samples }
    }

    /// The samples so far are followed by a gap.
    pub(super) fn forget(&mut self) {
        self.count = 0;
    }

    /// The place of the next sample.
    pub(super) fn push(&mut self) -> &mut [WatchedJoint] {
        let at = self.next;
        self.next = (at + 1) % self.room;
        self.count = self.count.saturating_add(1);
        &mut self.samples[at * self.joints..][..self.joints]
    }

    /// The sample `back` before the last one.
    pub(super) fn back(&self, back: usize) -> &[WatchedJoint] {
        let at = (self.next + 2 * self.room - 1 - back) % self.room;
        &self.samples[at * self.joints..][..self.joints]
    }

    /// Mean of every joint over the last `2 half + 1` samples.
    ///
    /// ```text
    /// Λ_j = (1 − |j|/N)/N,   ⟨x⟩ = Σ_{j=−N}^{N} Λ_j x_j
    /// ⟨q̈⟩ = (q_N − 2 q_0 + q_{−N})/(N T)²                                                  as (CW1)
    /// ⟨t ë⟩ = [e_N − e_{−N} − (2/N)(Σ_{j>0} e_j − Σ_{j<0} e_j)]/(N T)                       as (CW3)
    /// ```
    ///
    /// with half of the end samples in the sums of (CW3).
    pub(super) fn means(&self, half: usize, period: f64, out: &mut [WindowMean]) {
        out.fill(WindowMean::default());
        let n = half as f64;
        for back in 0..=2 * half {
            let off = back.abs_diff(half) as f64;
            let weight = (1.0 - off / n) / n;
            // Of the interval that ends at the sample: mean of the weights of its ends.
            let before = (back + 1).abs_diff(half) as f64;
            let held = if back < 2 * half { weight + (1.0 - before / n) / n } else { 0.0 };
            let side = if back < half { 1.0 } else { -1.0 };
            let end = match back {
                _ if back == half => 0.0,
                0 => 0.5,
                _ if back == 2 * half => 0.5,
                _ => 1.0,
            };
            for (out, one) in out.iter_mut().zip(self.back(back)) {
                out.tau += 0.5 * held * one.tau;
                out.bare += weight * one.bare;
                out.more.0 += weight * one.more.0;
                out.more.1 += weight * one.more.1;
                for k in 0..PARAMETERS {
                    out.body[k] += weight * one.body[k];
                }
                out.ddq -= weight * one.ddq;
                out.turning -= 2.0 / n * side * end * one.e;
            }
        }
        let (last, middle, first) = (self.back(0), self.back(half), self.back(2 * half));
        let length = n * period;
        for (i, out) in out.iter_mut().enumerate() {
            let (a, b, c) = (last[i].q, middle[i].q, first[i].q);
            out.whole = ((a - b) - (b - c)) / (length * length);
            out.ddq += out.whole;
            out.turning = (out.turning + last[i].e - first[i].e) / length;
        }
    }
}

impl WatchedJoint {
    /// Takes over what the model says of joint `i`.
    pub(super) fn takes(&mut self, known: &KnownTorque, i: usize) {
        self.bare = known.bare[i];
        self.more = known.more[i];
        self.body = known.body[i];
    }
}

/// A number of samples.
pub(super) fn count(of: f64) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a time over a sample period: positive, and what is too large is most"
    )]
    let samples = of.round() as usize;
    samples
}
