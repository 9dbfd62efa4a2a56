//! The envelope as it is found: bounds in every bin of the run.

use phihat_certificate::extremes::{hull, larger};

/// Bounds on one joint, one entry per bin.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct JointEnvelope {
    /// `e` \[rad\], low and high.
    pub error: Vec<(f64, f64)>,
    /// `ė` \[rad/s\].
    pub velocity: Vec<(f64, f64)>,
    /// `|τ|` commanded \[N·m\].
    pub torque: Vec<f64>,
    /// `|τ_k − τ_{k−1}|` commanded \[N·m\].
    pub step: Vec<f64>,
}

/// Envelope of all joints.
#[derive(Debug, Clone, PartialEq)]
pub struct Envelope {
    /// Length of a bin \[s\].
    pub bin_s: f64,
    /// Per joint.
    pub joints: Vec<JointEnvelope>,
    /// Slices of the payload's mass.
    pub slices: u32,
}

impl Envelope {
    /// The union of two.
    pub(super) fn join(&mut self, other: &Self) {
        let hull = |a: &mut [(f64, f64)], b: &[(f64, f64)]| {
            for (a, b) in a.iter_mut().zip(b) {
                *a = hull([*a, *b].into_iter());
            }
        };
        let larger = |a: &mut [f64], b: &[f64]| {
            for (a, b) in a.iter_mut().zip(b) {
                *a = larger(*a, *b);
            }
        };
        for (a, b) in self.joints.iter_mut().zip(&other.joints) {
            hull(&mut a.error, &b.error);
            hull(&mut a.velocity, &b.velocity);
            larger(&mut a.torque, &b.torque);
            larger(&mut a.step, &b.step);
        }
    }
}
