//! Bounds on one joint's error from peak-to-peak gains and a known `φ`.

use phihat::{Form, VelocitySource};
use phihat_certificate::Bounds;
use phihat_certificate::extremes::Extremes as _;

use crate::sampled::LoopParts;
use crate::sampled::{LoopModel, ReadingError, ReferenceError, SampledPeaks};
use crate::{JointCertificate, JointRecord, Phi};

/// Estimate of the bounds on one joint's error from the claims about its loop, an encoder's quantum \[rad\] and the
/// length of the run \[s\]: a bound of joints that no other joint moves; `None`: nothing follows.
pub(crate) fn alone(
    record: &JointRecord,
    claims: &JointCertificate,
    phi: &Phi,
    given: (f64, f64),
) -> Option<Bounds> {
    let (peaks, moved) = (claims.sampled.as_ref()?, claims.reference.as_ref());
    let known = moved.is_some() || phi.motion.is_none();
    let evidence = || {
        BoundsEvidence::new((record, &claims.model), peaks, claims.reading.as_ref(), moved, given)
    };
    known.then(|| evidence().bounds(phi))
}

/// Data from which bounds are computed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BoundsEvidence<'a> {
    pub(crate) record: &'a JointRecord,
    pub(crate) model: &'a LoopModel,
    /// Gains from `φ/M̄` to `∫e, e, ė`.
    pub(crate) jump: [f64; 3],
    /// Gains from `φ̇/M̄`.
    pub(crate) ramp: [Option<f64>; 3],
    /// Gains from the encoder's error to `e`, `ė`.
    pub(crate) reading: [f64; 2],
    /// Gains from the reference's acceleration and jerk to `e`, `ė`.
    pub(crate) moved: [(f64, Option<f64>); 2],
    pub(crate) quantum: f64,
    /// Smallest inertia ratio.
    pub(crate) low: f64,
    /// Length of the run \[s\].
    pub(crate) duration: f64,
}

impl<'a> BoundsEvidence<'a> {
    pub(crate) fn new(
        (record, model): (&'a JointRecord, &'a LoopModel),
        peaks: &SampledPeaks,
        reading: Option<&ReadingError>,
        moved: Option<&ReferenceError>,
        (quantum, duration): (f64, f64),
    ) -> Self {
        Self {
            record,
            model,
            jump: peaks.jump,
            ramp: peaks.ramp,
            reading: reading.map_or([0.0; 2], |r| [r.error, r.velocity_per_s]),
            moved: moved.map_or([(0.0, None); 2], |m| {
                [(m.acceleration, m.jerk), (m.velocity_acceleration, m.velocity_jerk)]
            }),
            quantum,
            low: peaks.mu.iter().copied().least(),
            duration,
        }
    }

    pub(crate) fn bounds(&self, phi: &Phi) -> Bounds {
        let inertia = self.record.inertia_kg_m2;
        let half = 0.5 * self.quantum;
        let state = |i: usize| phi.bound(self.jump[i], self.ramp[i]) / inertia;
        let besides = |i: usize| {
            let (acceleration, jerk) = self.moved[i];
            let moved = phi.motion.map_or(0.0, |motion| {
                let ahead = [motion.velocity_rad_s, motion.acceleration_rad_s2][i];
                motion.costs(acceleration, jerk) + self.model.lead() * ahead
            });
            self.reading[i] * half + moved
        };
        let error_bound_rad = state(1) + besides(0);
        let period = self.model.period_s;
        let within = if self.model.form == Form::Observer
            && self.model.velocity == VelocitySource::Measured
        {
            let lag = self.record.kd_per_s / self.record.kp_per_s2;
            lag * period * period * phi.rate_nm_s / (12.0 * self.low * inertia)
        } else {
            0.0
        };
        // The trapezoid of the run's record and the sum of the claim differ by half a sample at each end.
        let integral = state(0) + self.duration * (besides(0) + within) + period * error_bound_rad;
        Bounds {
            error_bound_rad,
            velocity_error_bound_rad_s: state(2) + besides(1),
            integral_rad_s: integral.is_finite().then_some(integral),
        }
    }
}
