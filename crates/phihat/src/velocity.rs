//! Velocity when only position is measured.

use crate::sampled::sampled_coefficients;
use crate::{Gain, GainError, Real};

/// Differenced position behind a first-order low-pass.
///
/// # Law
///
/// ```text
/// v_k = (q_k − q_{k−1})/Δt
/// y_k = y_{k−1} + (1 − e^{−2πf T})(v_k − y_{k−1})
/// ```
///
/// The design's model of the sampled loop has this very filter (`[sensor] velocity = "differenced"`,
/// `velocity_filter_hz`), so that what it does to the inertia window is part of the certificate.
///
/// # Example
///
/// ```
/// use phihat::{VelocityFilter, VelocityState};
///
/// let filter = VelocityFilter::<f64>::new(Some(45.0), 1e-3)?;
/// let mut state = VelocityState::default();
/// let mut dq = 0.0;
/// for k in 0..200 {
///     let q = 0.5 * 1e-3 * f64::from(k); // turns at 0.5 rad/s
///     dq = filter.estimate(&mut state, q, 1e-3);
/// }
/// assert!((dq - 0.5).abs() < 1e-9);
/// # Ok::<(), phihat::GainError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VelocityFilter<R> {
    gain: R,
}

/// State of a [`VelocityFilter`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct VelocityState<R> {
    last: Option<(R, R)>,
}

impl<R: Real> VelocityState<R> {
    /// The state after a sample at this position, with this velocity as its answer.
    pub fn after(q: R, velocity: R) -> Self {
        Self { last: Some((q, velocity)) }
    }
}

impl<R: Real> VelocityFilter<R> {
    /// A filter of a bandwidth \[Hz\] at a sample period \[s\]; `None`: differences only.
    ///
    /// # Errors
    ///
    /// [`GainError::NotPositive`] when the bandwidth or the period is not positive and finite.
    pub fn new(bandwidth_hz: Option<f64>, period: f64) -> Result<Self, GainError> {
        Gain::Period.positive(period)?;
        let Some(bandwidth) = bandwidth_hz else { return Ok(Self { gain: R::from_f64(1.0) }) };
        let rate = core::f64::consts::TAU * Gain::VelocityFilter.positive(bandwidth)?;
        let [alpha, ..] = sampled_coefficients(&[rate], period);
        Ok(Self { gain: R::from_f64(alpha * period) })
    }

    /// Velocity at a position measured `interval` seconds after the last one. The first answer is zero. Where the
    /// position or the velocity is not finite, or beyond ±2³², the last velocity is the answer and nothing changes.
    pub fn estimate(&self, state: &mut VelocityState<R>, q: R, interval: R) -> R {
        let last = state.last.map_or(R::ZERO, |(_, filtered)| filtered);
        let velocity = match state.last {
            Some((before, _)) if interval > R::ZERO => {
                (last + self.gain * ((q - before) / interval - last)).snap()
            }
            _ => last,
        };
        if R::doubt([q, velocity]) != R::ZERO {
            return last;
        }
        state.last = Some((q, velocity));
        velocity
    }
}
