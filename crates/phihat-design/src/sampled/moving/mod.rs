//! Inertia that changes at a bounded rate: stability of the coupled arm while it moves.

mod check;
mod find;

use serde::{Deserialize, Serialize};

use super::model::LoopModel;
use super::open_loop::OpenLoop;
use super::refutation::{plausible, plausible_loop, refuse};
use crate::JointRecord;
use crate::claims::Refutation;
use check::{Claim, Failure, Loop};

const CLAIM: &str = "stability while moving";

/// How fast the arm's inertia may change, anywhere in its range, with the loop still stable.
///
/// # Claim
///
/// For any number of joints with one law in one loop, and `W(t) = M̄^{-1/2} M M̄^{-1/2}` with eigenvalues in
/// `[low, high]` and `‖dW/dt‖ ≤ rate_per_s` at almost every time, whatever its path: the loop `W(t) q̈ = u_k`, `u_k` held
/// over a sample, with the law's own delay, velocity source and filter, is exponentially stable.
///
/// # Proof
///
/// `A_k` is the mean of `W^{-1}` over a sample, `W_k = A_k^{-1}`, `v_k = A_k u_k` the mean acceleration. `W^{-1}` changes by at most
/// `g = rate/low²` per second, so `‖W_{k+1} − W_k‖ ≤ δ = rate·T (1 + χ²/12)`, `χ = high·g·T` (the mean of the squares of
/// `W^{-1}` is at most `g²T²/12` above the square of the mean). The position also sees the mean with weights
/// `2(T − s)/T²`: a kick of `(T²/2) E_k v_k`, `‖E_k‖ ≤ η = χ/6`. With `L = N/Δ` from `v` to minus the torque, and
/// `K/Δ` from such a kick,
///
/// ```text
/// W_k v_k = −(L v)_k − ((K/Δ) E v)_k                                                               (M1)
/// ```
///
/// `‖(W_k − c)v‖ ≤ r‖v‖` with `c`, `r` middle and half of the range; for the antisymmetric convolution `H` with taps `∓h_j`,
/// `2⟨Wv, Hv⟩ = ⟨v, [W, H]v⟩ ≤ 2 Σ|h_j| min(δj, high − low) ‖v‖²`; `‖Ev‖ ≤ η‖v‖`. By the theorem on integral quadratic
/// constraints (Megretski and Rantzer, IEEE TAC 42(6), 1997) along `cI + s(W − cI)`, `sE`, from the stable loop at `μ = c`, it
/// suffices that at every `θ`, with `y = 2 Σ h_j sin jθ`, `κ = Σ|h_j| min(δj, high − low)` and any `λ > 0`,
///
/// ```text
/// |N + cΔ|² + y Im(NΔ*) > (r² + κ + λη²)(|Δ|² + |K|²/λ) + |K|²y²/4λ                                 (M2)
/// ```
///
/// # Evidence
///
/// `h`, `λ`. (M2) is proved by cells of frequency, as is the stability at `c`.
///
/// # Not claimed
///
/// Coriolis and viscous torque and the gradient of gravity, which are part of the moving arm's loop too; a drive with a
/// bandwidth; limits in action; joints with different laws. Double precision with an allowance for rounding.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Moving {
    /// Smallest eigenvalue.
    pub low: f64,
    /// Largest eigenvalue.
    pub high: f64,
    /// Largest `‖dW/dt‖` \[1/s\].
    pub rate_per_s: f64,
    /// `δ`: the change per sample that this is.
    pub delta: f64,
    /// Taps `h_1, h_2, …` of the multiplier.
    pub h: Vec<f64>,
    /// `λ`, which weighs the drift inside a sample.
    pub drift: f64,
    /// Largest `‖dW/dt‖` along the study's reference \[1/s\]: at the postures looked at, with the lightest and the
    /// heaviest payloads; `None`: not looked at.
    pub needed_motion_per_s: Option<f64>,
    /// Largest `‖dW/dt‖` found with every joint at its speed limit \[1/s\]: a search, no bound; `None`: some joint states no
    /// limit.
    pub needed_limits_per_s: Option<f64>,
}

impl Moving {
    /// Finds the largest rate for a range of inertia.
    ///
    /// # Errors
    ///
    /// [`Refutation`] when no rate is proved.
    pub fn find(
        gains: &JointRecord,
        model: &LoopModel,
        (low, high): (f64, f64),
    ) -> Result<Self, Refutation> {
        let about = cut(gains, model)?;
        let range = (low * (1.0 - 1e-9), high * (1.0 + 1e-9));
        find::largest(&about, range, model.period_s).map_err(refused)
    }

    /// Checks the claim for one joint's gains and loop; they have to be the same for all joints.
    ///
    /// # Errors
    ///
    /// [`Refutation`], with the frequency at which the proof fails.
    pub fn verify(&self, gains: &JointRecord, model: &LoopModel) -> Result<(), Refutation> {
        let about = cut(gains, model)?;
        let claim = self.claim(model.period_s);
        let delta = claim.step().delta;
        if self.delta.is_nan() || (self.delta - delta).abs() > 1e-9 * delta {
            return Err(refuse(CLAIM, "δ = rate·T (1 + χ²/12)", self.delta, delta));
        }
        claim.check(&about).map_err(refused)
    }

    fn claim(&self, period: f64) -> Claim<'_> {
        let Self { low, high, rate_per_s: rate, ref h, drift, .. } = *self;
        Claim { low, high, period, rate, h, drift }
    }
}

/// The loop cut at the inertia.
fn cut(gains: &JointRecord, model: &LoopModel) -> Result<Loop, Refutation> {
    plausible(CLAIM, gains)?;
    plausible_loop(CLAIM, model)?;
    if let Some(hz) = model.drive_bandwidth_hz {
        let inequality = "the torque acts at once: a drive's lag is not in the proof";
        return Err(refuse(CLAIM, inequality, hz, f64::INFINITY));
    }
    let (open, kick) = OpenLoop::with_kick(gains, model);
    let coefficients = |p: &super::polynomial::Polynomial| p.coefficients().to_vec();
    Ok(Loop {
        numerator: coefficients(&open.numerator),
        denominator: coefficients(&open.denominator),
        kick: coefficients(&kick),
    })
}

fn refused(why: Failure) -> Refutation {
    refuse(CLAIM, why.inequality, why.left, why.right)
}
