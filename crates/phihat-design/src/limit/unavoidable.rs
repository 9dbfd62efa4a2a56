//! The error that is there before any law can act.

use super::request::LimitRequest;

/// Error that no law prevents \[rad\], linear or not.
///
/// A jump of `φ` is measured a sample later and answered `d` samples after that. Until then, for a unit
/// impulse of `φ/M` over one sample,
///
/// ```text
/// e_k = −T²/2 (2k − 1),   T Σ_{i ≤ k} e_i = −T³/2 k²,   k = 1 … d + 1
/// ```
///
/// If `φ` has a ramp, the errors have to sum up to 0, or that sum never dies out: what comes later is as
/// large again.
pub(super) fn error(request: &LimitRequest) -> f64 {
    let (period, samples) = (request.period, request.delay + 1);
    let squares: usize = (1..=samples).map(|k| k * k).sum();
    let ramp = 0.5 * period.powi(3) * squares as f64;
    let jump = 0.5 * period.powi(2) * (samples * samples) as f64;
    let again = if request.phi_rate > 0.0 { 2.0 } else { 1.0 };
    // Rounded down: it is a bound from below.
    request.error([ramp, again * jump, 0.0]) * (1.0 - 1e-12)
}
