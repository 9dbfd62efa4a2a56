//! Measurements of a joint: quantised position, measured or differenced velocity.

use core::f64::consts::TAU;
use phihat::VelocitySource;

/// One joint's encoder and velocity source.
///
/// # Law
///
/// ```text
/// q_m = Δ round(q/Δ),  Δ = 2π/2^bits                                                            (EN1)
/// v_k = (q_m,k − q_m,k−1)/T   or   q̇                                                            (EN2)
/// y_k = y_{k−1} + (1 − e^{−2πf T})(v_k − y_{k−1})                                               (EN3)
/// ```
///
/// For prismatic joints Δ counts in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct JointSensor {
    quantum: Option<f64>,
    source: VelocitySource,
    /// `1 − e^{−2πfT}`; 1 without a filter.
    filter: f64,
    period: f64,
    last: Option<(f64, f64)>,
}

impl JointSensor {
    pub(crate) fn new(
        bits: Option<u32>,
        source: VelocitySource,
        filter_hz: Option<f64>,
        period: f64,
    ) -> Self {
        Self {
            quantum: bits.map(|b| TAU / 2.0_f64.powi(b.cast_signed())),
            source,
            filter: filter_hz.map_or(1.0, |f| -libm::expm1(-TAU * f * period)),
            period,
            last: None,
        }
    }

    /// Its quantum \[rad\], whether its velocity is the difference of positions, and the weight of its filter; 1: none.
    pub(super) fn numbers(&self) -> (Option<f64>, bool, f64) {
        (self.quantum, self.source == VelocitySource::Differenced, self.filter)
    }

    /// Position and velocity as the controller gets them. The first sample differences to the true
    /// velocity: a real driver has been running before the controller starts.
    pub(crate) fn sense(&mut self, q: f64, dq: f64) -> (f64, f64) {
        let position = self.quantum.map_or(q, |quantum| quantum * (q / quantum).round());
        let Some((before, filtered)) = self.last else {
            self.last = Some((position, dq));
            return (position, dq);
        };
        let raw = match self.source {
            VelocitySource::Measured => dq,
            VelocitySource::Differenced => (position - before) / self.period,
        };
        let velocity =
            if self.filter < 1.0 { filtered + self.filter * (raw - filtered) } else { raw };
        self.last = Some((position, velocity));
        (position, velocity)
    }
}
