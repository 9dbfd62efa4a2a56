//! Range of a robot's inertia over its postures, which a constant nominal inertia must cover.

use crate::{Joint, Robot, Workspace};

/// Range of the mass matrix over sampled postures, armature included.
#[derive(Debug, Clone, PartialEq)]
pub struct InertiaRange {
    /// Smallest `M_ii` \[kg·m²\] per joint.
    pub min: Vec<f64>,
    /// Largest `M_ii` \[kg·m²\] per joint.
    pub max: Vec<f64>,
    /// `M̄ = √(min · max)` \[kg·m²\] per joint.
    pub mean: Vec<f64>,
    /// Smallest eigenvalue of `M̄^{-1/2} M M̄^{-1/2}` over the postures.
    pub lambda_min: f64,
    /// Largest eigenvalue of `M̄^{-1/2} M M̄^{-1/2}` over the postures.
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
    ///
    /// # Law
    ///
    /// The law divides torque by one constant inertia per joint. How far that is from the truth is
    /// in the eigenvalues of
    ///
    /// ```text
    /// M̄^{-1/2} M(q) M̄^{-1/2}                                                          (1)
    /// ```
    ///
    /// # Not claimed
    ///
    /// Extremes between the samples: the true range is a little wider.
    ///
    /// # Example
    ///
    /// ```
    /// use phihat_model::Robot;
    ///
    /// let range = Robot::named("planar3r")?.inertia_range(500, 1);
    /// // Nominal inertias that centre each joint's own range, and what the arm does around them.
    /// assert!(range.mean.iter().all(|m| *m > 0.1));
    /// assert!(range.lambda_min < 1.0 && 1.0 < range.lambda_max);
    /// # Ok::<(), phihat_model::RobotError>(())
    /// ```
    pub fn inertia_range(&self, samples: usize, seed: u64) -> InertiaRange {
        let model = self.plant_model();
        let n = model.joint_count();
        let mut ws = Workspace::new(&model);
        let mut m = vec![0.0; n * n];
        let (mut min, mut max) = (vec![f64::INFINITY; n], vec![0.0_f64; n]);
        let mut random = seed;
        for _ in 0..samples {
            model.mass_matrix(&mut ws, &self.posture(&mut random), &mut m);
            for i in 0..n {
                min[i] = min[i].min(m[i * n + i]);
                max[i] = max[i].max(m[i * n + i]);
            }
        }
        let mean: Vec<f64> = min.iter().zip(&max).map(|(low, high)| (low * high).sqrt()).collect();
        let (mut lambda_min, mut lambda_max) = (f64::INFINITY, 0.0_f64);
        let mut random = seed;
        for _ in 0..samples {
            model.mass_matrix(&mut ws, &self.posture(&mut random), &mut m);
            for i in 0..n {
                for j in 0..n {
                    m[i * n + j] /= (mean[i] * mean[j]).sqrt();
                }
            }
            for eigenvalue in eigenvalues(&mut m, n) {
                lambda_min = lambda_min.min(eigenvalue);
                lambda_max = lambda_max.max(eigenvalue);
            }
        }
        InertiaRange { min, max, mean, lambda_min, lambda_max }
    }

    /// The next posture inside the limits; within half a turn for endless joints.
    fn posture(&self, random: &mut u64) -> Vec<f64> {
        let half_turn = (-core::f64::consts::PI, core::f64::consts::PI);
        let within = |joint: &Joint| {
            let (low, high) = joint.position.unwrap_or(half_turn);
            low + (high - low) * uniform(random)
        };
        self.joints.iter().map(within).collect()
    }
}

/// Splitmix64, in [0, 1).
fn uniform(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// Eigenvalues of the symmetric `n × n` matrix `a`, by Jacobi's rotations; leaves `a` diagonal.
fn eigenvalues(a: &mut [f64], n: usize) -> Vec<f64> {
    const SWEEPS: usize = 16;
    for _ in 0..SWEEPS {
        for p in 0..n {
            for q in p + 1..n {
                rotate(a, n, p, q);
            }
        }
    }
    (0..n).map(|i| a[i * n + i]).collect()
}

/// One rotation in the plane of axes `p` and `q`, which makes `a_pq` 0.
fn rotate(a: &mut [f64], n: usize, p: usize, q: usize) {
    let off = a[p * n + q];
    if off.abs() <= f64::MIN_POSITIVE {
        return;
    }
    let theta = 0.5 * (a[q * n + q] - a[p * n + p]) / off;
    let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
    let c = 1.0 / (t * t + 1.0).sqrt();
    let s = t * c;
    for k in 0..n {
        let (kp, kq) = (a[k * n + p], a[k * n + q]);
        a[k * n + p] = c * kp - s * kq;
        a[k * n + q] = s * kp + c * kq;
    }
    for k in 0..n {
        let (pk, qk) = (a[p * n + k], a[q * n + k]);
        a[p * n + k] = c * pk - s * qk;
        a[q * n + k] = s * pk + c * qk;
    }
}
