//! The sampled loop around one joint: what is between the law and the inertia.

use phihat_study::{LawForm, Study, TorqueSource, VelocitySource};
use serde::{Deserialize, Serialize};

/// Which form of the law runs in a sampled loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LoopForm {
    /// Disturbance observer fed with the torque that acted.
    Observer,
    /// The paper's integrals of the error.
    Literal,
}

/// Where the law's velocity comes from in a sampled loop.
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
}
