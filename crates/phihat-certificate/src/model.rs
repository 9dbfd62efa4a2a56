//! The sampled loop around one joint: what is between the law and the inertia.

use phihat::{Form, TorqueSource, VelocitySource};
use phihat_study::Study;
use serde::{Deserialize, Serialize};

/// Spelling of the core's words in a document: the core itself knows no file format.
mod spelling {
    use serde::{Deserialize, Serialize};

    #[derive(Serialize, Deserialize)]
    #[serde(remote = "phihat::Form", rename_all = "snake_case")]
    pub(super) enum Form {
        Observer,
        Literal,
        Positions,
    }

    #[derive(Serialize, Deserialize)]
    #[serde(remote = "phihat::VelocitySource", rename_all = "snake_case")]
    pub(super) enum VelocitySource {
        Measured,
        Differenced,
    }

    #[derive(Serialize, Deserialize)]
    #[serde(remote = "phihat::TorqueSource", rename_all = "snake_case")]
    pub(super) enum TorqueSource {
        Applied,
        Demanded,
    }
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
    /// Delay of the measurements \[samples\].
    #[serde(default)]
    pub sample_delay_samples: u32,
    /// Torque that the observer is fed.
    #[serde(default, with = "spelling::TorqueSource")]
    pub torque: TorqueSource,
    /// Velocity source.
    #[serde(with = "spelling::VelocitySource")]
    pub velocity: VelocitySource,
    /// First-order low-pass on the velocity \[Hz\]; `None`: none.
    pub velocity_filter_hz: Option<f64>,
    /// First-order low-pass on the torque command \[Hz\], a part of the law; `None`: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub torque_filter_hz: Option<f64>,
    /// Form of the law.
    #[serde(with = "spelling::Form")]
    pub form: Form,
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
            torque: study.sensor.torque,
            velocity: study.sensor.velocity,
            velocity_filter_hz: study.sensor.velocity_filter_hz,
            torque_filter_hz: study.control.torque_filter_hz,
            form: study.control.form,
            drive_bandwidth_hz: drives.and_then(|d| d.get(joint)).copied(),
        }
    }
}
