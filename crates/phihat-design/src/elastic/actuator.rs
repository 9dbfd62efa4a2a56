//! Rotor, spring and law of one joint as the links meet them, at one frequency.

use nalgebra::Complex;
use phihat_certificate::extremes::smaller;
use phihat_certificate::{ElasticJoint, EncoderSide};

/// Ratio of neighbouring stiffnesses of an interval that are tried.
const STEP: f64 = 1.02;

/// Largest ratio of stiffnesses of an interval that are tried, but its end.
const REACH: f64 = 1e3;

/// Rotor inertia, compliance and damping of one joint, per unit of its link inertia.
#[derive(Debug, Clone, Copy)]
pub(super) struct Actuator {
    pub(super) rotor: f64,
    /// `1/k`; 0: a rigid joint.
    pub(super) compliance: f64,
    pub(super) damping: f64,
}

impl Actuator {
    /// `1/L″` of (EL1) at `ω` \[rad/s\], by the law's `L` per unit of acceleration of what it reads.
    pub(super) fn admittance(
        &self,
        law: Complex<f64>,
        omega: f64,
        side: EncoderSide,
    ) -> Complex<f64> {
        let both = law + self.rotor;
        let lost = Complex::new(1.0, omega * self.damping * self.compliance);
        let bend = Complex::new(omega * omega * self.compliance, 0.0) / lost;
        match side {
            EncoderSide::Motor => both.inv() - bend,
            EncoderSide::Link => (Complex::new(1.0, 0.0) - bend * self.rotor) / both,
        }
    }

    /// Points of a joint's intervals: stiffness by steps of 2 %, damping and rotor at both ends.
    pub(super) fn points(joint: &ElasticJoint, unit: f64) -> Vec<Self> {
        let (low, high) = (joint.stiffness_nm_rad.0, joint.stiffest());
        let most = smaller(high, REACH * low);
        let next = |k: &f64| Some(k * STEP).filter(|k| *k < most);
        let mut stiffnesses: Vec<f64> = core::iter::successors(Some(low), next).collect();
        stiffnesses.push(high);
        let mut points = Vec::with_capacity(4 * stiffnesses.len());
        for stiffness in stiffnesses {
            let (c, b) = (joint.damping_nm_s_rad, joint.rotor_kg_m2);
            for (damping, rotor) in [(c.0, b.0), (c.0, b.1), (c.1, b.0), (c.1, b.1)] {
                let point = Self {
                    rotor: rotor / unit,
                    compliance: unit / stiffness,
                    damping: damping / unit,
                };
                points.push(point);
            }
        }
        points
    }
}

/// Interval of `κ` whose circles through `−a` and `−b` have every `L″` so far outside, and the joints that set its
/// ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct CircleRoom {
    pub(super) low: (f64, usize),
    pub(super) high: (f64, usize),
}

impl CircleRoom {
    pub(super) const ALL: Self = Self { low: (f64::NEG_INFINITY, 0), high: (f64::INFINITY, 0) };

    /// Takes in one `1/L″`: `1 + (a + b) Re + ab |1/L″|² − κ Im > 0`.
    pub(super) fn add(&mut self, joint: usize, at: Complex<f64>, (a, b): (f64, f64)) {
        let outside = 1.0 + (a + b) * at.re + a * b * at.norm_sqr();
        let edge = outside / at.im;
        if at.im > 0.0 && edge < self.high.0 {
            self.high = (edge, joint);
        }
        if at.im < 0.0 && edge > self.low.0 {
            self.low = (edge, joint);
        }
        // On the real axis between −1/a and −1/b, or no number: no circle helps.
        if !(at.im.abs() > 0.0 || outside > 0.0) {
            *self = Self { low: (f64::INFINITY, joint), high: (f64::NEG_INFINITY, joint) };
        }
    }

    /// The part that both leave.
    pub(super) fn and(self, other: &Self) -> Self {
        Self {
            low: if other.low.0 > self.low.0 { other.low } else { self.low },
            high: if other.high.0 < self.high.0 { other.high } else { self.high },
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        // No number is no room.
        self.low.0.partial_cmp(&self.high.0) != Some(core::cmp::Ordering::Less)
    }
}
