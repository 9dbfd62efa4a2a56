//! Peak-to-peak gains of the sampled loop: how large an error a bounded `φ` can make.

use serde::{Deserialize, Serialize};

/// Worst errors at the samples, worst over some inertia ratios.
///
/// # Claim
///
/// From rest, at every sample, with `x = (∫e, e, ė)`:
///
/// ```text
/// |x_i| ≤ jump_i max|φ|/M̄          |x_i| ≤ ramp_i max|φ̇|/M̄      (φ continuous, φ(0) = 0)        (S1)
/// |x_i| ≤ bend_i max|φ̈|/M̄                                        (φ(0) = φ̇(0) = 0)
/// ```
///
/// For `e` and `ė` with `φ` of any shape in continuous time; for `∫e`, and for `bend`, with `φ` held over each sample
/// interval (steps of at most `φ̇ T`, that differ by at most `φ̈ T²`). For `φ = φ_smooth + φ_jump` the sum of both. `φ` is what comes from outside: gravity, coupling,
/// friction, load; the part `(M − M̄)q̈` is in the loop already. `∫e` is `T Σ e_k`.
///
/// # Evidence
///
/// The L1 norms: the response to an impulse at any instant of an interval is linear in that instant, so its
/// absolute integral is exact; what the sum leaves out is bounded by `‖A^N‖`. Both are computed again by
/// [`Self::verify`].
///
/// # Not claimed
///
/// Errors between samples; ratios between those tried. With the observer and a measured velocity, a `φ` that
/// keeps varying within the sample intervals shifts the sampled velocity by `T²φ̇/(12M)` and so leaves an error
/// of `K_d/K_p` times that, whose integral grows: hence the restriction on `∫e`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SampledPeaks {
    /// Inertia ratios tried.
    pub mu: Vec<f64>,
    /// Gains from `φ/M̄` \[rad/s²\] to `∫e` \[rad·s\], `e` \[rad\], `ė` \[rad/s\].
    pub jump: [f64; 3],
    /// Gains from `φ̇/M̄` \[rad/s³\]; `None`: a lasting ramp makes `∫e` grow without bound.
    pub ramp: [Option<f64>; 3],
    /// Gains from `φ̈/M̄` \[rad/s⁴\]; `None`: a lasting parabola makes the error grow without bound.
    pub bend: [Option<f64>; 3],
}
