//! The linear programme's numbers, scaled so that a solver meets sizes near 1.

use super::error::LimitError;
use super::request::LimitRequest;

/// First and longest length, in `1/W`; each other one is half as long again. Longer ones mean numbers further apart: a
/// force of so long ago has moved the joint by the square.
const FIRST: f64 = 4.0;
const LAST: f64 = 25.0;

/// Shortest response \[samples\], beside four for each sample of delay.
const LENGTH_MIN: usize = 16;

/// Response of a law for an exact position \[samples\]: such laws are as short as the delay lets them be.
const LENGTH_EXACT: usize = 32;

/// `T W` at most: a bandwidth below the rate.
const FASTEST: f64 = 0.3;
const SLOWEST: f64 = 1e-3;

/// `Σ|ρ_k − ρ_{k−1}|` of a good law, in `W²`.
const CHANGE: f64 = 50.0;

/// Numbers of one length; time in `1/W`, torque over inertia in `W²`, cost in `unit_rad`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Programme {
    /// Samples.
    pub(super) length: usize,
    /// Whole samples from measuring to acting.
    pub(super) delay: usize,
    /// `W` \[1/s\], about the loop's bandwidth.
    pub(super) frequency: f64,
    /// `T W`.
    pub(super) step: f64,
    /// Cost of a unit of each response's L1 norm: `φ̇`, `φ_J`, `Δ/2`.
    pub(super) ramp: f64,
    pub(super) jump: f64,
    pub(super) read: f64,
    /// Largest `Σ|ρ_k − ρ_{k−1}|`; `None`: the position is exact.
    pub(super) change: Option<f64>,
    /// Unit of the cost \[rad\].
    pub(super) unit_rad: f64,
}

impl Programme {
    pub(super) fn of(request: &LimitRequest, length: usize) -> Result<Self, LimitError> {
        let frequency = frequency(request);
        let ramp = request.phi_rate / request.inertia / frequency.powi(3);
        let jump = request.phi_jump / request.inertia / frequency.powi(2);
        let read = 0.5 * request.quantum;
        let unit_rad = ramp.max(jump).max(read);
        let change = (request.quantum > 0.0).then(|| change(request) / frequency.powi(2));
        let numbers = [ramp / unit_rad, jump / unit_rad, read / unit_rad, change.unwrap_or(0.0)];
        if !(unit_rad.is_normal() && numbers.iter().all(|number| number.is_finite())) {
            return Err(LimitError::Scale);
        }
        Ok(Self {
            length,
            delay: request.delay,
            frequency,
            step: frequency * request.period,
            ramp: ramp / unit_rad,
            jump: jump / unit_rad,
            read: read / unit_rad,
            change,
            unit_rad,
        })
    }

    /// `(T W)²/2`: position after one sample of a unit of torque over inertia, from rest.
    pub(super) fn half(&self) -> f64 {
        0.5 * self.step * self.step
    }
}

/// Lengths to try, growing.
pub(super) fn lengths(request: &LimitRequest, max: usize) -> Vec<usize> {
    if request.quantum <= 0.0 {
        return vec![LENGTH_EXACT + 4 * request.delay];
    }
    let step = frequency(request) * request.period;
    let least = LENGTH_MIN + 4 * request.delay;
    // By counting: it may be anything up to `max`.
    let least_of = |time: f64| (least..max).find(|n| *n as f64 * step >= time).unwrap_or(max);
    let (first, last) = (least_of(FIRST), least_of(LAST));
    let longer = |length: &usize| (*length < last).then(|| (length + length / 2).min(last));
    core::iter::successors(Some(first), longer).collect()
}

/// `M Δ/2 Σ|ρ_k − ρ_{k−1}| ≤` the largest change \[N·m\], solved for the sum \[1/s²\].
fn change(request: &LimitRequest) -> f64 {
    request.torque_change_max / (0.5 * request.quantum * request.inertia)
}

/// About the bandwidth that the torque's change, the encoder and the rate leave \[1/s\]; what is wrong in it
/// costs time.
fn frequency(request: &LimitRequest) -> f64 {
    let (slowest, fastest) = (SLOWEST / request.period, FASTEST / request.period);
    if request.quantum <= 0.0 {
        return fastest;
    }
    let read = 0.5 * request.quantum * request.inertia;
    let useful = libm::cbrt(request.phi_rate / read).max((request.phi_jump / read).sqrt());
    (change(request) / CHANGE).sqrt().min(useful).clamp(slowest, fastest)
}
