//! Estimates of the sampled gains, cheap enough for a search; the certificate proves the real ones.

use nalgebra::DVector;

use crate::JointRecord;
use crate::sampled::LoopParts;
use crate::sampled::{LoopModel, StateMatrix, left_by_acceleration};

/// Samples after which a response is cut off, should it not have died before.
const LONGEST: usize = 40_000;

/// A response has died when `e` and `ė` each stay below this share of their own largest value …
const DEAD: f64 = 1e-4;

/// … for so many samples.
const QUIET: usize = 64;

/// Peak-to-peak gains at one inertia ratio, in units of `M̄`; a few per mille low.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Quick {
    /// From `φ/M̄` to `∫e`, `e`, `ė`.
    pub(crate) jump: [f64; 3],
    /// From `φ̇/M̄` to the same; `None`: grows without bound.
    pub(crate) ramp: [Option<f64>; 3],
    /// From the encoder's error to `e`, `ė`.
    pub(crate) reading: [f64; 2],
    /// From the reference's acceleration to `e`, `ė`.
    pub(crate) moved: [f64; 2],
    /// From the encoder's error to the change of torque per sample, over `M̄`.
    pub(crate) change: f64,
}

impl Quick {
    /// `None` when a response does not die.
    pub(crate) fn at(law: &JointRecord, model: &LoopModel, mu: f64) -> Option<Self> {
        let matrix = StateMatrix::new(law, model, mu);
        let (unit, period) = (matrix.unit(), model.period_s);
        let (mut jump, mut ramp, mut sums) = ([0.0; 3], [0.0; 3], [0.0; 3]);
        let mut integral = 0.0;
        walk(&matrix, matrix.disturbance(), |x| {
            integral += period * x[0];
            for (i, value) in [integral, x[0], unit * x[1]].into_iter().enumerate() {
                jump[i] += value.abs();
                sums[i] += value;
                ramp[i] += sums[i].abs() * period;
            }
        })?;
        let encoder = matrix.encoder();
        let mut last = encoder.direct;
        let (mut change, mut reading) = (last.abs(), [0.0; 2]);
        walk(&matrix, &encoder.drives, |x| {
            reading[0] += x[0].abs();
            reading[1] += (unit * x[1]).abs();
            let torque = (&encoder.state * x)[0];
            change += (torque - last).abs();
            last = torque;
        })?;
        let mut moved = [0.0; 2];
        walk(&matrix, &left_by_acceleration(&matrix)?, |x| {
            moved[0] += x[0].abs();
            moved[1] += (unit * x[1]).abs();
        })?;
        let lasting = model.servo_type(law.order()) >= 2;
        let ramp = [lasting.then_some(ramp[0]), Some(ramp[1]), Some(ramp[2])];
        Some(Self { jump, ramp, reading, moved, change })
    }

    /// The larger of each.
    pub(crate) fn worse(self, other: Self) -> Self {
        let larger = |a: [f64; 3], b: [f64; 3]| core::array::from_fn(|i| a[i].max(b[i]));
        let both = |i: usize| self.ramp[i].zip(other.ramp[i]).map(|(a, b)| a.max(b));
        Self {
            jump: larger(self.jump, other.jump),
            ramp: core::array::from_fn(both),
            reading: core::array::from_fn(|i| self.reading[i].max(other.reading[i])),
            moved: core::array::from_fn(|i| self.moved[i].max(other.moved[i])),
            change: self.change.max(other.change),
        }
    }
}

/// Shows `b, Ab, A²b, …` until it has died; `None` when it does not.
fn walk(
    matrix: &StateMatrix,
    b: &DVector<f64>,
    mut visit: impl FnMut(&DVector<f64>),
) -> Option<()> {
    let a = matrix.matrix();
    let mut x = b.clone();
    let mut next = x.clone();
    let (mut largest, mut quiet) = ([0.0_f64; 2], 0);
    for _ in 0..LONGEST {
        visit(&x);
        // Each by itself: a reading's kick to the torque is large and short, what it leaves of `e` small and long.
        let sizes = [x[0].abs(), x[1].abs()];
        largest = core::array::from_fn(|i| largest[i].max(sizes[i]));
        let dead = (0..2).all(|i| sizes[i] < DEAD * largest[i]);
        quiet = if dead { quiet + 1 } else { 0 };
        if quiet > QUIET {
            return Some(());
        }
        next.gemv(1.0, a, &x, 0.0);
        core::mem::swap(&mut x, &mut next);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::Quick;
    use crate::JointRecord;
    use crate::sampled::{LoopModel, StateMatrix};
    use phihat::{Form, TorqueSource, VelocitySource};

    /// An encoder's error to `e`: the sum of the whole response.
    fn whole(law: &JointRecord, model: &LoopModel, mu: f64) -> f64 {
        let matrix = StateMatrix::new(law, model, mu);
        let mut x = matrix.encoder().drives.clone();
        let mut sum = 0.0;
        // The slowest loop here forgets within 0.4 s: in 40 s nothing is left.
        for _ in 0..80_000 {
            sum += x[0].abs();
            x = matrix.matrix() * &x;
        }
        assert!(x.amax() < 1e-12, "still alive");
        sum
    }

    #[test]
    fn what_an_encoder_does_to_the_error_is_not_cut_off() {
        let mut worst = 0.0_f64;
        for (k, w) in [4.0_f64, 10.0, 30.0].into_iter().enumerate() {
            for velocity in [VelocitySource::Measured, VelocitySource::Differenced] {
                for (velocity_filter_hz, period_s) in [(None, 1e-3), (Some(160.0), 5e-4)] {
                    let a = [vec![0.7 * w], vec![w * w, 2.0 * w]][k % 2].clone();
                    let name = "joint".to_owned();
                    let law = JointRecord {
                        name,
                        inertia_kg_m2: 1.0,
                        kp_per_s2: w * w,
                        kd_per_s: 2.0 * w,
                        a,
                        observer: None,
                    };
                    let model = LoopModel {
                        period_s,
                        delay_samples: 1,
                        sample_delay_samples: 0,
                        torque: TorqueSource::Applied,
                        velocity,
                        velocity_filter_hz,
                        form: Form::Observer,
                        drive_bandwidth_hz: None,
                    };
                    for mu in [0.3, 1.0] {
                        let Some(quick) = Quick::at(&law, &model, mu) else { continue };
                        let whole = whole(&law, &model, mu);
                        assert!(quick.reading[0] <= whole * (1.0 + 1e-9), "more than there is");
                        worst = worst.max(whole / quick.reading[0]);
                    }
                }
            }
        }
        assert!(worst < 1.02, "{worst} times what was estimated");
    }
}
