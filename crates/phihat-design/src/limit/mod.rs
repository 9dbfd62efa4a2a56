//! The smallest error bound that any linear law can have at one inertia.
//!
//! See `docs/theory/limit.md`. The bound is that of a single joint,
//!
//! ```text
//! |e| ≤ (ramp·φ̇ + jump·φ_J)/M + read·Δ/2
//! ```
//!
//! with the peak-to-peak gains of the loop, and the encoder may change the torque by so much per sample. Let `ρ` be the
//! loop's impulse response from the encoder's error to `τ/M`. All other responses are affine in it (Youla), so the
//! smallest bound is a linear programme over `ρ`, whatever the order of the law.
//!
//! # Method
//!
//! Two programmes of finite length enclose it. Of the laws whose responses *end* within so many samples the
//! best one is sought (`law`, `tied`): its gains are summed up again, and it is a law. For all laws, of any
//! length, multipliers that are constant after so many samples give a bound from below (`multipliers`,
//! `backward`): any multipliers within their box do. The length grows until both agree. What the solver says
//! of its answers is not used, neither objective nor status: the law is played, and the backward sum is a
//! bound for wrong multipliers too.
//!
//! # Not claimed
//!
//! Laws that are not linear, or vary in time; a joint with a velocity sensor of its own; the motion of the reference. A
//! law that serves a range of inertias is not better than the limit at any inertia of that range, and may be far from
//! all of them.

mod backward;
mod beside;
mod error;
mod found;
mod law;
mod multipliers;
mod programme;
mod request;
mod responses;
mod rows;
mod tied;
mod unavoidable;

pub use beside::beside_limit;
pub use error::LimitError;
pub use found::Limit;
pub use request::LimitRequest;

use programme::Programme;

/// Ends of the interval that are so close, relative, are one figure.
const CLOSED: f64 = 1e-4;

/// Longest response \[samples\]: some seconds of the solver.
const LENGTH_MAX: usize = 400;

/// Encloses the smallest error bound of any linear sampled law at one inertia.
///
/// ```
/// use phihat_design::{LimitRequest, limit};
///
/// // A wrist: how fast φ changes and how far it jumps; an encoder of 18 bit; 1 N·m per sample for its errors.
/// let wrist = LimitRequest {
///     inertia: 0.67,
///     phi_rate: 2.58,
///     phi_jump: 0.3,
///     quantum: core::f64::consts::TAU / 262_144.0,
///     torque_change_max: 1.0,
///     delay: 1,
///     period: 1e-3,
/// };
/// let found = limit(&wrist)?;
/// assert!(0.090e-3 < found.low_rad && found.high_rad < 0.092e-3);
/// assert!(found.high_rad - found.low_rad < 1e-4 * found.high_rad);
/// # Ok::<(), phihat_design::LimitError>(())
/// ```
///
/// The ends are further apart than one part in 10⁴ where 400 samples are not enough (a loop that is slow against its
/// rate, as where `φ` is small against the encoder's step), where neither encoder nor torque holds a law back, and for
/// an exact position, whose bound from below is what happens before any law can act. An exact position has no torque
/// noise: `torque_change_max` then plays no part.
///
/// # Errors
///
/// [`LimitError`] for numbers that are none, and where no law was found.
pub fn limit(request: &LimitRequest) -> Result<Limit, LimitError> {
    request.check()?;
    let mut low_rad = unavoidable::error(request);
    let mut best: Option<Limit> = None;
    let lengths = programme::lengths(request, LENGTH_MAX);
    for length in &lengths {
        let programme = Programme::of(request, *length)?;
        let below = multipliers::find(&programme).and_then(|m| backward::bound(&programme, &m));
        low_rad = below.map_or(low_rad, |cost| low_rad.max(cost * programme.unit_rad));
        let closed = |best: &Option<Limit>| {
            best.as_ref().is_some_and(|best| best.high_rad - low_rad <= CLOSED * best.high_rad)
        };
        if closed(&best) {
            break;
        }
        let above = law::find(&programme).and_then(|r| tied::tied(&programme, r));
        if let Some(r) = above {
            let found = Limit::of(request, &programme, &r);
            if best.as_ref().is_none_or(|best| found.high_rad < best.high_rad) {
                best = Some(found);
            }
        }
        if closed(&best) {
            break;
        }
    }
    let length = lengths.last().copied().unwrap_or(0);
    let best = best.ok_or(LimitError::NoLaw { length, low_rad })?;
    // Where both agree to the last digits, rounding may turn them round.
    Ok(Limit { low_rad: low_rad.min(best.high_rad), ..best })
}
