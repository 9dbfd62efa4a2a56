//! Torque noise: the part of a torque that no motion of an arm needs.

use core::f64::consts::PI;
use phihat_campaign::statistics::rms;

/// Lowest frequency at which a torque counts as noise \[Hz\]: motions of these arms have their harmonics
/// below 5 Hz.
pub const NOISE_FROM_HZ: f64 = 50.0;

/// Order of the filter.
const ORDER: u32 = 4;

/// Root mean square of the part of a torque above [`NOISE_FROM_HZ`], from sample `from` on, in the unit of
/// `tau`; `None` where nothing is left from there on, or samples of period `period` \[s\] do not reach that
/// frequency.
///
/// # Method
///
/// A Butterworth high-pass of order 4, by the bilinear transform with its edge at the frequency itself, run
/// from the first sample on as if the torque had always been what it is there:
///
/// ```text
/// |H|² = 1/(1 + (tan(π f_c T)/tan(π f T))⁸)                                              (1)
/// ```
///
/// A motion of 3 Hz is 100 dB down. A spectrum of the record would not do: a torque that does not end where
/// it began has a step in its periodic continuation, and that is noise that was not there.
pub fn noise_above(tau: &[f64], from: usize, period: f64) -> Option<f64> {
    let edge = (PI * NOISE_FROM_HZ * period).tan();
    if from >= tau.len() || period.is_nan() || period <= 0.0 || 2.0 * NOISE_FROM_HZ * period >= 1.0
    {
        return None;
    }
    let mut passed = tau.to_vec();
    for pair in 0..ORDER / 2 {
        let angle = PI * f64::from(2 * pair + 1) / f64::from(2 * ORDER);
        section(&mut passed, edge, 2.0 * angle.cos());
    }
    Some(rms(&passed[from..]))
}

/// `s²/(s² + d s + 1)` with `s = (1 − z⁻¹)/(1 + z⁻¹)/edge`, in place, from rest at the first value.
fn section(values: &mut [f64], edge: f64, d: f64) {
    let k = edge * edge;
    let norm = 1.0 + d * edge + k;
    let (gain, a1, a2) = (1.0 / norm, 2.0 * (k - 1.0) / norm, (1.0 - d * edge + k) / norm);
    let first = values.first().copied().unwrap_or(0.0);
    let (mut x, mut y) = ([first; 2], [0.0; 2]);
    for value in values {
        let now = gain * (*value - 2.0 * x[0] + x[1]) - a1 * y[0] - a2 * y[1];
        (x, y) = ([*value, x[0]], [now, y[0]]);
        *value = now;
    }
}

#[cfg(test)]
mod tests {
    use super::{PI, noise_above};
    use crate::sure::Sure as _;

    const T: f64 = 1e-3;

    /// (1) at five frequencies; the rms of a sine is its size over √2.
    #[test]
    fn a_sine_counts_by_the_closed_form() {
        for f in [20.0, 50.0, 80.0, 200.0, 450.0] {
            let tau: Vec<f64> =
                (0..20_000).map(|k| 3.0 * (2.0 * PI * f * f64::from(k) * T).sin()).collect();
            let ratio = (PI * 50.0 * T).tan() / (PI * f * T).tan();
            let exact = 3.0 / 2.0_f64.sqrt() / (1.0 + ratio.powi(8)).sqrt();
            let found = noise_above(&tau, 4000, T).sure();
            assert!((found - exact).abs() < 2e-4 * exact + 1e-9, "{f} Hz: {found} for {exact}");
        }
    }

    /// A motion, a load that grows and a constant are none; one that jumps from sample to sample is all noise.
    #[test]
    fn what_a_motion_asks_for_is_no_noise() {
        let smooth = |k: u32| {
            let t = f64::from(k) * T;
            80.0 + 5.0 * t + 40.0 * (2.0 * PI * 0.7 * t).sin()
        };
        let tau: Vec<f64> = (0..6000).map(smooth).collect();
        assert!(noise_above(&tau, 2000, T).sure() < 1e-5);
        let jumps: Vec<f64> =
            (0..6000).map(|k| smooth(k) + if k % 2 == 0 { 0.2 } else { -0.2 }).collect();
        assert!((noise_above(&jumps, 2000, T).sure() - 0.2).abs() < 1e-4);
        assert!(noise_above(&tau, 6000, T).is_none() && noise_above(&tau, 0, 0.01).is_none());
    }
}
