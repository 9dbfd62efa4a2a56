//! Loops of every form, velocity source, filter, drive and delay, and gains of every order.

use phihat::{Form, TorqueSource, VelocitySource};
use phihat_certificate::{JointRecord, LoopModel};

/// Gains whose estimator of order 1 to 4 has all poles at `w`.
pub(crate) fn record(order: usize, w: f64) -> JointRecord {
    let a = match order {
        1 => vec![w],
        2 => vec![w * w, 2.0 * w],
        3 => vec![w * w * w, 3.0 * w * w, 3.0 * w],
        _ => vec![w.powi(4), 4.0 * w.powi(3), 6.0 * w * w, 4.0 * w],
    };
    JointRecord {
        name: "joint".into(),
        inertia_kg_m2: 0.7,
        kp_per_s2: 150.0,
        kd_per_s: 25.0,
        a,
        observer: None,
    }
}

pub(crate) fn every_model(period_s: f64) -> Vec<LoopModel> {
    let mut models = Vec::new();
    for form in [Form::Observer, Form::Literal] {
        for velocity in [VelocitySource::Measured, VelocitySource::Differenced] {
            for velocity_filter_hz in [None, Some(90.0)] {
                for (drive_bandwidth_hz, torque) in [
                    (None, TorqueSource::Applied),
                    (Some(150.0), TorqueSource::Applied),
                    (Some(150.0), TorqueSource::Demanded),
                ] {
                    for delay_samples in [0, 2] {
                        models.push(LoopModel {
                            period_s,
                            delay_samples,
                            velocity,
                            velocity_filter_hz,
                            torque_filter_hz: None,
                            form,
                            drive_bandwidth_hz,
                            sample_delay_samples: delay_samples / 2,
                            torque,
                        });
                    }
                }
            }
        }
    }
    models
}
