//! Input-to-state stability of the closed loop, with explicit constants.

use serde::{Deserialize, Serialize};

use crate::check::agree::agrees;
use crate::check::definite::definite_within;
use crate::check::free::Free;
use crate::check::polynomial::product;
use crate::peak_gain::encloses;
use crate::{Matrix, PeakGain, Refutation, UnitLaw};

const CLAIM: &str = "input-to-state stability";

/// Room for rounding in a factor of `S` or `W`, relative to their diagonal.
const ROOM: f64 = 1e-14;

/// `ẋ = (A − BK)x − Bφ` is input-to-state stable.
///
/// # Claim
///
/// With `V = ½xᵀSx` (30) and `W = −(A−BK)ᵀS − S(A−BK)`; for the certificate's `S` this is
/// `W = Q + (2a_{m−1} − K̃) SBBᵀS`:
///
/// ```text
/// s_min I ≼ S ≼ s_max I                                                        (26)
/// W ≽ w_min I:   V̇ ≤ −γ₁|x|² + γ₂φ²,   γ₁ = w_min/4,  γ₂ = |SB|²/w_min           (27)
///                |x| ≥ ρ|φ|  ⟹  V̇ ≤ −γ₁|x|²,   ρ = 4|SB|/w_min                  (28)
/// W ≽ 2λS:       |x(t)| ≤ √(s_max/s_min) e^{−λt} |x(0)|   at φ = 0               (24)
/// |x(t)| ≤ … + gain |φ|_∞,   gain = ‖B‖ ∫‖e^{(A−BK)τ}‖dτ,  ‖B‖ = 1                (25)
/// ```
///
/// The paper's α: `a_{m−1} = αK̃ + 1/γ²` needs `α > ½`, here `a_{m−1} > K̃/2`, so that `W ≽ Q`.
///
/// # Not claimed
///
/// `|x|` mixes rad·s, rad and rad/s as in the paper; the constants are large for that reason alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Iss {
    /// `K̃` whose `S` this is; `None`: some other Lyapunov matrix.
    pub k_tilde: Option<f64>,
    /// `S`.
    pub s: Matrix,
    /// Below the smallest eigenvalue of `S`.
    pub s_min: f64,
    /// Above the largest eigenvalue of `S`.
    pub s_max: f64,
    /// `√(s_max/s_min)`.
    pub overshoot: f64,
    /// Decay rate `λ` \[1/s\].
    pub rate: f64,
    /// Below the smallest eigenvalue of `W`.
    pub w_min: f64,
    /// `|SB|`.
    pub sb_norm: f64,
    /// `γ₁` of (27).
    pub gamma1: f64,
    /// `γ₂` of (27).
    pub gamma2: f64,
    /// Gain of (25); the upper side uses the Frobenius norm, the lower one is `1/√n` of it.
    pub gain: PeakGain,
}

impl Iss {
    /// `|x(t)|` at φ = 0 is at most this \[1\], per unit of `|x(0)|`.
    pub fn beta(&self, time_s: f64) -> f64 {
        self.overshoot * libm::exp(-self.rate * time_s)
    }
}

impl Iss {
    /// Checks every inequality from the gains and `S`.
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming the inequality that fails.
    pub fn verify(&self, law: &UnitLaw) -> Result<(), Refutation> {
        let yes = Refutation::unless;
        law.check(CLAIM)?;
        let (s, n) = (&self.s, law.order() + 2);
        let square = s.len() == n && s.iter().all(|row| row.len() == n);
        let even = square && (0..n).all(|i| (0..i).all(|j| s[i][j].to_bits() == s[j][i].to_bits()));
        let finite = s.iter().flatten().all(|value| value.is_finite());
        yes(CLAIM, "S = Sᵀ", s.len() as f64, n as f64, even && finite)?;
        if let Some(k_tilde) = self.k_tilde {
            let (left, right) = (law.a_top(), 0.5 * k_tilde);
            yes(CLAIM, "a_{m−1} > K̃/2 (α > ½)", left, right, k_tilde > 0.0 && left > right)?;
            self.is_of(law, k_tilde)?;
        }
        for (value, name) in
            [(self.s_min, "s_min > 0"), (self.w_min, "w_min > 0"), (self.rate, "λ > 0")]
        {
            yes(CLAIM, name, value, 0.0, value > 0.0)?;
        }
        let w = self.fall(law);
        let less = |x: &Matrix, factor: f64, y: &dyn Fn(usize, usize) -> f64| -> Matrix {
            let entry = |i: usize, j: usize| x[i][j] - factor * y(i, j);
            (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
        };
        let unit = |i: usize, j: usize| f64::from(u8::from(i == j));
        definite_within(CLAIM, "S ≽ s_min I", &less(s, self.s_min, &unit), ROOM)?;
        definite_within(CLAIM, "W ≽ w_min I", &less(&w, self.w_min, &unit), ROOM)?;
        let own = |i: usize, j: usize| s[i][j];
        definite_within(CLAIM, "W ≽ 2λS", &less(&w, 2.0 * self.rate, &own), ROOM)?;
        let size = s.iter().flatten().map(|value| value * value).sum::<f64>().sqrt();
        yes(CLAIM, "‖S‖_F ≤ s_max", size, self.s_max, size <= self.s_max * (1.0 + 1e-12))?;
        let ratio = (self.s_max / self.s_min).sqrt();
        agrees(CLAIM, "overshoot = √(s_max/s_min)", (self.overshoot, ratio), 1e-12)?;
        let column = s.iter().map(|row| row[n - 1] * row[n - 1]).sum::<f64>().sqrt();
        agrees(CLAIM, "|SB|", (self.sb_norm, column), 1e-12)?;
        agrees(CLAIM, "γ₁ = w_min/4", (self.gamma1, self.w_min / 4.0), 1e-12)?;
        let gamma2 = column * column / self.w_min;
        agrees(CLAIM, "γ₂ = |SB|²/w_min", (self.gamma2, gamma2), 1e-12)?;
        let frobenius = Free::new(CLAIM, law, 1.0)?.norm_in_ladder_units();
        let lower = frobenius.lower / (n as f64).sqrt();
        let gain = PeakGain { lower, upper: frobenius.upper };
        encloses("∫‖e^{(A−BK)τ}‖dτ", self.gain, gain)
    }

    /// `W = −(A−BK)ᵀS − S(A−BK)`: `A − BK` shifts, and has the characteristic coefficients in its last row.
    fn fall(&self, law: &UnitLaw) -> Matrix {
        let (s, n) = (&self.s, self.s.len());
        let mut a_o = law.a.clone();
        a_o.push(1.0);
        let p = product(&a_o, &[law.kp, law.kd, 1.0]);
        let half =
            |i: usize, j: usize| j.checked_sub(1).map_or(0.0, |j| s[i][j]) - s[i][n - 1] * p[j];
        (0..n).map(|i| (0..n).map(|j| -(half(i, j) + half(j, i))).collect()).collect()
    }

    /// That `S` belongs to a certificate of optimality at `K̃`: `a_{m−1}BᵀS = K`.
    fn is_of(&self, law: &UnitLaw, k_tilde: f64) -> Result<(), Refutation> {
        let n = self.s.len();
        let below = k_tilde < law.a_top();
        Refutation::unless(CLAIM, "K̃ < a_{m−1}", k_tilde, law.a_top(), below)?;
        for (i, k) in product(&law.a, &[law.kp, law.kd, 1.0]).into_iter().enumerate() {
            let sides = (law.a_top() * self.s[i][n - 1], k);
            agrees(CLAIM, "a_{m−1} BᵀS = K", sides, 1e-9)?;
        }
        Ok(())
    }
}
