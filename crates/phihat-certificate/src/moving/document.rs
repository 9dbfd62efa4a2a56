//! Largest rate of change of the inertia, as data, and the inequality that fails where it is not proved.

use serde::{Deserialize, Serialize};

/// Largest rate at which the arm's inertia may change, anywhere in its range, with the loop still stable.
///
/// # Claim
///
/// For any number of joints, each with its own law in its own loop, sampled together, and
/// `W(t) = M̄^{-1/2} M M̄^{-1/2}` with eigenvalues in `[low, high]` and `‖dW/dt‖ ≤ rate_per_s` at almost
/// every time, whatever its path: the loop `W(t) q̈ = u_k`, `u_k` constant over a sample, with each law's own
/// delay, velocity source and filter, is exponentially stable.
///
/// # Proof
///
/// `A_k` is the mean of `W^{-1}` over a sample, `W_k = A_k^{-1}`, `v_k = A_k u_k` the mean acceleration.
/// `W^{-1}` changes by at most `g = rate/low²` per second, so `‖W_{k+1} − W_k‖ ≤ δ = rate·T (1 + χ²/12)`,
/// `χ = high·g·T` (the mean of the squares of `W^{-1}` is at most `g²T²/12` above the square of the mean).
/// The position also depends on the mean with weights `2(T − s)/T²`: a kick of `(T²/2) E_k v_k`,
/// `‖E_k‖ ≤ η = χ/6`. With `L_i = N_i/Δ_i` from `v_i` to minus joint `i`'s torque, and `G_i = K_i/Δ_i` from
/// such a kick,
///
/// ```text
/// W_k v_k = −(diag(L) v)_k − (diag(G) E v)_k                                                      as (M1)
/// ```
///
/// `‖(W_k − c)v‖ ≤ r‖v‖` with `c`, `r` middle and half of the range. `H`, the convolution with taps `∓h_j`,
/// is the same for every joint and antisymmetric:
/// `2⟨Wv, Hv⟩ = ⟨v, [W, H]v⟩ ≤ 2 Σ|h_j| min(δj, high − low) ‖v‖²`, with no need that `W` commutes with the
/// laws. `‖Ev‖ ≤ η‖v‖`. All three hold of `s(W − cI)`, `sE` for `s` from 0 to 1, and at `s = 0` each joint is
/// a loop by itself, at `μ = c`, and stable. By the theorem on integral quadratic constraints (Megretski and
/// Rantzer, IEEE TAC 42(6), 1997) it suffices that at every `θ` one quadratic form in `(v, Ev)` is negative
/// on (M1). The multipliers are scalars and the laws diagonal: the form is a sum over joints. Its largest
/// value over `(Ev)_i` is negative exactly if, with `y = 2 Σ h_j sin jθ`, `κ = Σ|h_j| min(δj, high − low)`
/// and any `λ > 0`, for each joint
///
/// ```text
/// |N_i + cΔ_i|² + y Im(N_iΔ_i*) > (r² + κ + λη²)(|Δ_i|² + |K_i|²/λ) + |K_i|²y²/4λ                  as (M2)
/// ```
///
/// # Evidence
///
/// `h`, `λ`, the same for all joints. (M2) and the stability at `c` are proved joint by joint, in exact arithmetic
/// ([`phihat_kernel::moving`]).
///
/// # Not claimed
///
/// Coriolis and viscous torque and the gradient of gravity, which are part of the moving arm's loop too; a drive with a
/// bandwidth; limits in action.
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
    /// Largest `‖dW/dt‖` found with every joint at its speed limit \[1/s\]: a search, no bound; `None`: some
    /// joint states no limit.
    pub needed_limits_per_s: Option<f64>,
}

impl Moving {
    /// `δ` and `η` for its rate.
    pub fn step(&self, period: f64) -> (f64, f64) {
        let change = self.rate_per_s * period;
        let chi = self.high * change / (self.low * self.low);
        (change * (1.0 + chi * chi / 12.0), chi / 6.0)
    }

    /// `y(θ) = 2 Σ h_j sin jθ`.
    pub fn multiplier(&self, theta: f64) -> f64 {
        let taps = self.h.iter().enumerate();
        2.0 * taps.map(|(j, h)| h * libm::sin((j + 1) as f64 * theta)).sum::<f64>()
    }
}

/// Inequality that fails where stability is not proved.
#[derive(Debug, Clone, PartialEq)]
pub struct Unstable {
    /// The inequality that should hold, as a formula.
    pub inequality: String,
    /// Frequency \[rad/sample\]; 0 where there is none.
    pub theta: f64,
    /// Left side of the inequality.
    pub left: f64,
    /// Right side of the inequality.
    pub right: f64,
}

impl Unstable {
    pub(super) fn new(inequality: String, theta: f64, (left, right): (f64, f64)) -> Self {
        Self { inequality, theta, left, right }
    }
}
