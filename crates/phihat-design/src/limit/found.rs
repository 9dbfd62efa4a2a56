//! A limit that was enclosed.

use super::programme::Programme;
use super::request::LimitRequest;
use super::responses::{Responses, change};

/// Two figures with the smallest error bound of any linear law at this inertia between them, and the law of the larger.
#[derive(Debug, Clone, PartialEq)]
pub struct Limit {
    /// No linear law has a smaller bound \[rad\].
    pub low_rad: f64,
    /// `law` has this bound \[rad\]: `(ramp·φ̇ + jump·φ_J)/M + read·Δ/2`.
    pub high_rad: f64,
    /// Samples after which the responses of `law` are 0.
    pub length: usize,
    /// Peak-to-peak gain of `law` from the rate of `φ/M` to `e` \[s³\].
    pub ramp: f64,
    /// The same from `φ/M` \[s²\].
    pub jump: f64,
    /// The same from the encoder's error \[–\].
    pub read: f64,
    /// Largest change of the torque per sample by the encoder's errors, with `law` \[N·m\].
    pub torque_change: f64,
    /// `ρ`: what `τ/M` does in the closed loop after an error of the encoder for one sample \[1/s²\]; then 0.
    ///
    /// The law itself is `τ_k/M = Σ_j r_j ν_{k−j}`, where `ν` is the measured error minus that which the
    /// torques made by themselves.
    pub law: Vec<f64>,
}

impl Limit {
    /// The gains of a response, summed up; nothing from below yet.
    pub(super) fn of(request: &LimitRequest, programme: &Programme, r: &[f64]) -> Self {
        let w = programme.frequency;
        let [ramp, jump, read] = Responses::of(programme, r).sums();
        let gains = [ramp / w.powi(3), jump / w.powi(2), read];
        let per_s2 = w * w;
        Self {
            low_rad: 0.0,
            high_rad: request.error(gains),
            length: programme.length,
            ramp: gains[0],
            jump: gains[1],
            read: gains[2],
            torque_change: 0.5 * request.inertia * request.quantum * change(r) * per_s2,
            law: r.iter().map(|r| r * per_s2).collect(),
        }
    }
}
