//! The sampled loop around one joint: what is between the law and the inertia.

use core::f64::consts::TAU;

use phihat_study::{LawForm, Study, TorqueSource, VelocitySource};
use serde::{Deserialize, Serialize};

use crate::gains::Gains;

/// Which form of the law runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LoopForm {
    /// Disturbance observer fed with the torque that acted.
    Observer,
    /// The paper's integrals of the error.
    Literal,
}

/// Where the law's velocity comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LoopVelocity {
    /// The true velocity at the sample.
    Measured,
    /// Backward difference of the position.
    Differenced,
}

/// Which torque the observer is fed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LoopTorque {
    /// The torque that acted: mean over the interval just ended, behind the drive.
    #[default]
    Applied,
    /// The torque that the drive was told over that interval.
    Demanded,
}

/// Everything of the sampled loop that is neither gain nor inertia.
///
/// ```text
/// sense q, q̇ (filtered) → law → delay of whole samples → drive (first order) → held torque → M q̈ = τ − φ
/// ```
///
/// The same law as in `phihat` and the same loop as in the simulator, without limits and friction.
///
/// Measurements that arrive `s` samples late (position, velocity and torque in one message) make the loop that
/// `s` more samples of transport delay make, on a reference that is `sT` ahead: only the sum of both delays
/// counts for stability, and the error has `sT |q̇_d|` on top.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoopModel {
    /// Sample period `T` \[s\].
    pub period_s: f64,
    /// Transport delay from sample to acting torque \[samples\].
    pub delay_samples: u32,
    /// How late measurements arrive \[samples\].
    #[serde(default)]
    pub sample_delay_samples: u32,
    /// Torque that the observer is fed.
    #[serde(default)]
    pub torque: LoopTorque,
    /// Velocity source.
    pub velocity: LoopVelocity,
    /// First-order low-pass on the velocity \[Hz\]; `None`: none.
    pub velocity_filter_hz: Option<f64>,
    /// Form of the law.
    pub form: LoopForm,
    /// Bandwidth of the drive's torque loop \[Hz\]; `None`: torque acts at once.
    pub drive_bandwidth_hz: Option<f64>,
}

impl LoopModel {
    /// The loop that a study puts around a joint, by its index.
    pub fn from_study(study: &Study, joint: usize) -> Self {
        let drives = study.world.drive_bandwidth_hz.as_ref();
        Self {
            period_s: study.control.period_ns as f64 * 1e-9,
            delay_samples: study.control.delay_samples,
            sample_delay_samples: study.sensor.delay_samples,
            torque: match study.sensor.torque {
                TorqueSource::Applied => LoopTorque::Applied,
                TorqueSource::Demanded => LoopTorque::Demanded,
            },
            velocity: match study.sensor.velocity {
                VelocitySource::Measured => LoopVelocity::Measured,
                VelocitySource::Differenced => LoopVelocity::Differenced,
            },
            velocity_filter_hz: study.sensor.velocity_filter_hz,
            form: match study.control.form {
                LawForm::Observer => LoopForm::Observer,
                LawForm::Literal => LoopForm::Literal,
            },
            drive_bandwidth_hz: drives.and_then(|d| d.get(joint)).copied(),
        }
    }

    /// The same with the velocity filter that gains carry, where the study leaves it to them.
    #[must_use]
    pub fn with_filter_of(mut self, gains: &Gains, study: &Study) -> Self {
        if study.sensor.velocity_filter_designed {
            self.velocity_filter_hz = gains.velocity_filter_hz;
        }
        self
    }

    /// Samples from measuring to acting, both ways.
    pub(crate) fn late(&self) -> u32 {
        self.delay_samples + self.sample_delay_samples
    }

    /// How far the reference of the equivalent loop is ahead \[s\].
    pub(crate) fn lead(&self) -> f64 {
        f64::from(self.sample_delay_samples) * self.period_s
    }

    /// The filter's gain per sample, `1 − e^{−2πfT}`; 1 without a filter.
    pub(crate) fn filter_gain(&self) -> f64 {
        self.velocity_filter_hz.map_or(1.0, |f| -(-TAU * f * self.period_s).exp_m1())
    }

    /// Whether a velocity filter is there.
    pub(crate) fn filters(&self) -> bool {
        self.velocity_filter_hz.is_some()
    }

    /// The drive over one held interval; `None` without a drive.
    pub(crate) fn drive(&self) -> Option<Drive> {
        self.drive_bandwidth_hz.map(|hz| {
            let (t, rate) = (self.period_s, TAU * hz);
            let lost = -(-rate * t).exp_m1();
            Drive { lost, mean: lost / (rate * t), double: (t - lost / rate) / rate }
        })
    }

    /// How many samples of `φ`'s polynomial are answered without a steady error: the loop's type.
    ///
    /// The literal form integrates `m` times whatever the delay; the observer knows the torque that
    /// acted, so a torque that comes late leaves an error under a ramp.
    pub(crate) fn servo_type(&self, order: usize) -> usize {
        let late = self.late() > 0 || self.drive_bandwidth_hz.is_some();
        if self.form == LoopForm::Observer && late { order.min(1) } else { order }
    }
}

/// A first-order drive over one interval, for a unit gap between torque and demand at its start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Drive {
    /// `1 − e^{−ωT}`: how much of the gap is closed at the end.
    pub(crate) lost: f64,
    /// Mean of the gap over the interval.
    pub(crate) mean: f64,
    /// `∫_0^T (T − t) e^{−ωt} dt` \[s²\].
    pub(crate) double: f64,
}
