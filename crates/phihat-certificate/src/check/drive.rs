//! Numbers of a drive and of a velocity filter.

use core::f64::consts::TAU;

use phihat_kernel::DriveModel;

use crate::LoopModel;

/// A first-order drive over one interval, `lost = 1 − e^{−ωT}`; `None`: torque acts at once.
pub(crate) fn drive(model: &LoopModel) -> Option<DriveModel> {
    model.drive_bandwidth_hz.map(|hz| {
        let x = TAU * hz * model.period_s;
        let lost = -libm::expm1(-x);
        // (x − ℓ)/x² by its series where the difference would cancel.
        let bent = if x < 0.03 {
            0.5 - x / 6.0 + x * x / 24.0 - x * x * x / 120.0 + x * x * x * x / 720.0
        } else {
            (x - lost) / (x * x)
        };
        DriveModel { lost, mean: lost / x, double: bent * model.period_s * model.period_s }
    })
}

/// Gain of the velocity's low-pass per sample; `None`: no filter.
pub(crate) fn filter(model: &LoopModel) -> Option<f64> {
    model.velocity_filter_hz.map(|hz| -libm::expm1(-TAU * hz * model.period_s))
}
