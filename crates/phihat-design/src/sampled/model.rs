//! Quantities that the finders derive from a loop model.

use core::f64::consts::TAU;

use phihat::Form;
pub use phihat_certificate::LoopModel;

/// Parts of the loop between the law and the inertia.
pub(crate) trait LoopParts {
    /// Samples from measuring to acting, both ways.
    fn late(&self) -> u32;

    /// Lead of the reference of the equivalent loop \[s\].
    fn lead(&self) -> f64;

    /// The filter's gain per sample, `1 − e^{−2πfT}`; 1 without a filter.
    fn filter_gain(&self) -> f64;

    /// Returns true if there is a velocity filter.
    fn filters(&self) -> bool;

    /// The drive over one held interval; `None` without a drive.
    fn drive(&self) -> Option<SampledDrive>;

    /// Type of the loop: number of coefficients of `φ` as a polynomial in time that leave no steady error.
    ///
    /// The literal form integrates `m` times whatever the delay; the observer knows the torque that
    /// acted, so a torque that comes late leaves an error under a ramp.
    fn servo_type(&self, order: usize) -> usize;
}

impl LoopParts for LoopModel {
    fn late(&self) -> u32 {
        self.delay_samples + self.sample_delay_samples
    }

    fn lead(&self) -> f64 {
        f64::from(self.sample_delay_samples) * self.period_s
    }

    fn filter_gain(&self) -> f64 {
        self.velocity_filter_hz.map_or(1.0, |f| -libm::expm1(-TAU * f * self.period_s))
    }

    fn filters(&self) -> bool {
        self.velocity_filter_hz.is_some()
    }

    fn drive(&self) -> Option<SampledDrive> {
        self.drive_bandwidth_hz.map(|hz| {
            let (t, rate) = (self.period_s, TAU * hz);
            let lost = -libm::expm1(-rate * t);
            SampledDrive { lost, mean: lost / (rate * t), double: (t - lost / rate) / rate }
        })
    }

    fn servo_type(&self, order: usize) -> usize {
        let lags = self.drive_bandwidth_hz.is_some() || self.torque_filter_hz.is_some();
        let late = self.late() > 0 || lags;
        match self.form {
            Form::Observer if late => order.min(1),
            Form::Observer | Form::Literal => order,
            // What it is not told of is late; else it makes up for its own lag.
            Form::Positions => {
                let told = !lags && self.sample_delay_samples == 0;
                order.min(if told { 2 } else { 1 })
            }
        }
    }
}

/// A first-order drive over one interval, for a unit gap between torque and demand at its start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SampledDrive {
    /// `1 − e^{−ωT}`: how much of the gap is closed at the end.
    pub(crate) lost: f64,
    /// Mean of the gap over the interval.
    pub(crate) mean: f64,
    /// `∫_0^T (T − t) e^{−ωt} dt` \[s²\].
    pub(crate) double: f64,
}
