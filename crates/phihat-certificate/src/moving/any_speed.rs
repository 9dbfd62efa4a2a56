//! Stability while inertia moves at any speed, for joints with laws of their own.

use phihat_kernel::{Range, any_speed};
use serde::{Deserialize, Serialize};

use super::check::{joint, one_clock, refused, same_loop, unproved};
use crate::refutation::refuse;
use crate::{JointRecord, LoopModel, Refutation};

const CLAIM: &str = "stability at any speed";

/// A range of inertia through which the coupled arm may move at any speed.
///
/// # Claim
///
/// For any number of joints, each with its own law in its own loop, sampled together, and any measurable
/// `W(t) = M̄^{-1/2} M M̄^{-1/2}` with eigenvalues in `[a, b] = [low, high]`, jumps and changes within a
/// sample included: the loop `W(t) q̈ = u_k`, `u_k` constant over a sample, is exponentially stable.
///
/// # Proof
///
/// With `α = W^{-1}u_k` in a sample, `v` its mean, and `e = (1/T)∫(1 − 2s/T)α ds`, position moves by
/// `Tq̇ + (T²/2)(v + e)` and velocity by `Tv`; so, as in [`Moving`](super::Moving), `u = −diag(L) v − diag(K/Δ) e`. `1`
/// and
/// `√3(1 − 2s/T)` are orthonormal on a sample: `‖v‖² + 3‖e‖² ≤ (1/T)∫‖α‖² ds`. `(α − u/b)·(α − u/a) ≤ 0` at
/// every time, and its mean gives
///
/// ```text
/// ab (‖v‖² + 3‖e‖²) − (a + b) v·u + ‖u‖² ≤ 0                                                      as (M3)
/// ```
///
/// (M3) holds of `(1 − s)/c + sW^{-1}` for `s` from 0 to 1, the set being convex; at `s = 0` each joint is a
/// loop by itself, at `μ = c = (a + b)/2`, and stable. By the theorem on integral quadratic constraints it
/// suffices that the form in (M3) is positive at every frequency on the graph of the laws: a sum over joints,
/// whose least value over `e_i` is positive exactly if
///
/// ```text
/// |N_i + cΔ_i|² > r² (|Δ_i|² + |K_i|²/3ab),   r = (b − a)/2                                        as (P4)
/// ```
///
/// That is (M2) of [`Moving`](super::Moving) at rest, without taps and with `λ = 3ab`, and so it is checked, exactly.
///
/// # Not claimed
///
/// As for [`Moving`](super::Moving).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AnySpeed {
    /// Smallest eigenvalue.
    pub low: f64,
    /// Largest eigenvalue.
    pub high: f64,
}

impl AnySpeed {
    /// Proves the claim for joints with their laws in their loops, from nothing else.
    ///
    /// # Errors
    ///
    /// [`Refutation`], with the joint and the frequency at which the proof fails.
    pub fn verify(&self, loops: &[(&JointRecord, &LoopModel)]) -> Result<(), Refutation> {
        let Self { low, high } = *self;
        let sensible = 0.0 < low && low <= high && high.is_finite();
        Refutation::unless(CLAIM, "0 < low ≤ high < ∞", low, high, sensible)?;
        let range =
            Range::new(low, high).map_err(|why| refuse(CLAIM, &why.to_string(), low, high))?;
        one_clock(CLAIM, loops)?;
        for (i, (gains, model)) in loops.iter().enumerate() {
            if loops[..i].iter().any(|before| same_loop(before, (gains, model))) {
                continue;
            }
            let proved = joint(CLAIM, gains, model).and_then(|joint| {
                any_speed(core::slice::from_ref(&joint), &range).map_err(|why| {
                    unproved(&joint, (low, high), "|N + cΔ|² > r² (|Δ|² + |K|²/3ab)", why)
                })
            });
            proved.map_err(|why| refused(CLAIM, why).on(&gains.name))?;
        }
        Ok(())
    }
}
