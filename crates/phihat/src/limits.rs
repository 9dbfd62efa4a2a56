//! Torque and torque-rate limits that report what they did.

use crate::{Command, Gain, GainError, Real, Status};

/// Limits of one joint's torque; infinite means none.
///
/// # Example
///
/// ```
/// use phihat::Limits;
///
/// // 87 N·m, and 1 N·m per millisecond.
/// let limits = Limits::<f64>::new(Some(87.0), Some(1000.0), 1e-3)?;
/// let command = limits.command(5.0, 0.0); // 5 N·m are asked for after 0 N·m
/// assert_eq!(command.tau, 1.0);
/// assert!(command.status.rate_limited && !command.status.saturated);
/// # Ok::<(), phihat::GainError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits<R> {
    torque: R,
    step: R,
}

/// A torque after the limits, and which of them acted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Limited<R> {
    pub(crate) tau: R,
    pub(crate) over_torque: bool,
    pub(crate) over_rate: bool,
}

impl<R: Real> Limits<R> {
    /// Limits that never act.
    pub fn none() -> Self {
        Self { torque: R::from_f64(f64::INFINITY), step: R::from_f64(f64::INFINITY) }
    }

    /// Limits from the largest |τ| \[N·m\] and the largest |τ̇| \[N·m/s\] at a sample period \[s\].
    ///
    /// # Errors
    ///
    /// [`GainError::NotPositive`] when a stated limit or the period is not positive and finite.
    pub fn new(
        torque_max: Option<f64>,
        torque_rate_max: Option<f64>,
        period: f64,
    ) -> Result<Self, GainError> {
        Gain::Period.positive(period)?;
        let mut limits = Self::none();
        if let Some(value) = torque_max {
            limits.torque = R::from_f64(Gain::TorqueMax.positive(value)?);
        }
        if let Some(value) = torque_rate_max {
            Gain::TorqueRateMax.positive(value)?;
            limits.step = R::from_f64(Gain::TorqueRateMax.positive(value * period)?);
        }
        Ok(limits)
    }

    /// Largest |τ| \[N·m\]; infinite when there is no limit.
    pub fn torque(&self) -> R {
        self.torque
    }

    /// Largest |τ_k − τ_{k−1}| \[N·m\]; infinite when there is no limit.
    pub fn step(&self) -> R {
        self.step
    }

    /// The answer for a torque that another law computed, `previous` being the answer before: the change is
    /// limited first, the size last. A torque that is not finite is refused, `previous` held.
    pub fn command(&self, tau: R, previous: R) -> Command<R> {
        if tau.is_finite() {
            self.apply(tau, previous).command(R::ZERO)
        } else {
            let status = Status { refused: true, ..Status::default() };
            Command { tau: previous, phi_hat: R::ZERO, status }
        }
    }

    /// Limits the change from `previous` first, the size last, so that the size always holds.
    pub(crate) fn apply(&self, tau: R, previous: R) -> Limited<R> {
        let change = tau - previous;
        let over_rate = change.abs() > self.step;
        let over_torque = tau.abs() > self.torque;
        let mut limited = tau;
        // Where no limit acts, keep tau to the last bit.
        if over_rate {
            limited = previous + change.saturate(self.step);
        }
        if over_rate || over_torque {
            limited = limited.saturate(self.torque);
        }
        Limited { tau: limited, over_torque, over_rate }
    }
}

impl<R: Real> Limited<R> {
    /// The answer of a sample that counts.
    pub(crate) fn command(self, phi_hat: R) -> Command<R> {
        let status =
            Status { saturated: self.over_torque, rate_limited: self.over_rate, refused: false };
        Command { tau: self.tau, phi_hat, status }
    }
}
