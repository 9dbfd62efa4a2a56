//! The values of `K̃` that admit a certificate of optimality.

use serde::{Deserialize, Serialize};

use crate::check::agree::agrees;
use crate::check::polynomial::{not_negative, value};
use crate::extremes::Extremes as _;
use crate::weights::{difference, weights};
use crate::{Refutation, UnitLaw};

const CLAIM: &str = "attenuation";

/// Relative distance to an edge at which it is probed.
const PROBE: f64 = 1e-6;

/// An open interval of `K̃` \[1/s\].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// The values of `K̃` in `(0, a_{m−1})` for which a law is inverse optimal.
///
/// # Claim
///
/// ```text
/// diagonal:            q_i(K̃) > 0 for all i, exactly for low < K̃ < high                        as (W1)
/// return difference:   |(jω)^m + K̃g(jω)|² ≥ ω^{2m} for all ω, exactly for K̃ ≥ K̃_min
/// γ = 1/√(a_{m−1} − K̃)
/// ```
///
/// The second is necessary and sufficient for optimality with *some* `Q ⪰ 0`; it does not involve
/// `K_p`, `K_d`. Both sides are affine in `K̃`, and the second grows with it (`|g|² ≥ 0`): so each
/// set is an interval, and its edges are what has to be checked.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Attenuation {
    /// `K̃` with a diagonal `Q ≻ 0`; `None`: there is none in `(0, a_{m−1})`.
    pub diagonal: Option<Interval>,
    /// Smallest `K̃` whose return difference holds; `None`: it is not below `a_{m−1}`.
    pub return_difference: Option<f64>,
    /// `ω²` at which the return difference fails just below that value \[rad²/s²\]; `None`: as ω → ∞, or
    /// never.
    pub blocking_w: Option<f64>,
    /// Infimum of `γ` with a diagonal `Q`.
    pub gamma_diagonal: Option<f64>,
    /// Infimum of `γ` by the return difference.
    pub gamma_return_difference: Option<f64>,
}

impl Attenuation {
    /// A `K̃` well inside the diagonal interval: the geometric mean of its ends, or a third of the
    /// upper one where the lower is 0.
    pub fn k_tilde(&self) -> Option<f64> {
        let Interval { low, high } = self.diagonal?;
        Some(if low > 0.0 { (low * high).sqrt() } else { high / 3.0 })
    }
}

impl Attenuation {
    /// Probes every edge from both sides.
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming the inequality that fails.
    pub fn verify(&self, law: &UnitLaw) -> Result<(), Refutation> {
        law.check(CLAIM)?;
        self.verify_levels(law)?;
        match self.diagonal {
            Some(interval) => verify_diagonal(law, interval)?,
            None => Refutation::unless(
                CLAIM,
                "no K̃ has q_i > 0 for all i",
                0.0,
                0.0,
                nowhere_positive(law),
            )?,
        }
        let a_top = law.a_top();
        let Some(least) = self.return_difference else {
            let fails = !not_negative(&difference(law, a_top * (1.0 - PROBE)));
            let what = "return difference fails below a_{m−1}";
            Refutation::unless(CLAIM, what, a_top, 0.0, fails)?;
            let what = "nothing blocks where nothing holds";
            return Refutation::unless(CLAIM, what, 0.0, 0.0, self.blocking_w.is_none());
        };
        let inside = least >= 0.0 && least < a_top;
        Refutation::unless(CLAIM, "0 ≤ K̃_min < a_{m−1}", least, a_top, inside)?;
        let above = (least * (1.0 + PROBE)).max(a_top * 1e-12);
        let proven = not_negative(&difference(law, above));
        let what = "|(jω)^m + K̃g|² ≥ ω^{2m} just above K̃_min";
        Refutation::unless(CLAIM, what, above, least, proven)?;
        if least > 0.0 {
            let h = difference(law, least * (1.0 - PROBE));
            let lowest = h.last().copied().unwrap_or(0.0);
            let at = self.blocking_w.map_or(lowest, |w| value(&h, w));
            let sensible = self.blocking_w.is_none_or(|w| w >= 0.0 && w.is_finite());
            let what = "return difference < 0 just below K̃_min";
            return Refutation::unless(CLAIM, what, at, 0.0, sensible && at < 0.0);
        }
        let what = "nothing blocks where all holds";
        Refutation::unless(CLAIM, what, 0.0, 0.0, self.blocking_w.is_none())
    }

    /// `γ = 1/√(a_{m−1} − K̃)` of both.
    fn verify_levels(&self, law: &UnitLaw) -> Result<(), Refutation> {
        let pairs = [
            (self.diagonal.map(|i| i.low), self.gamma_diagonal),
            (self.return_difference, self.gamma_return_difference),
        ];
        for (k_tilde, gamma) in pairs {
            let both = k_tilde.is_some() == gamma.is_some();
            Refutation::unless(CLAIM, "γ is stated where K̃ is", 0.0, 0.0, both)?;
            if let (Some(k_tilde), Some(gamma)) = (k_tilde, gamma) {
                let sides = (k_tilde + 1.0 / (gamma * gamma), law.a_top());
                agrees(CLAIM, "K̃ + 1/γ² = a_{m−1}", sides, 1e-12)?;
                Refutation::unless(CLAIM, "γ > 0", gamma, 0.0, gamma > 0.0)?;
            }
        }
        Ok(())
    }
}

/// `q_i` is affine in `K̃`: positive just inside both ends means positive between them.
fn verify_diagonal(law: &UnitLaw, Interval { low, high }: Interval) -> Result<(), Refutation> {
    let a_top = law.a_top();
    Refutation::unless(CLAIM, "0 ≤ low", low, 0.0, low >= 0.0)?;
    Refutation::unless(CLAIM, "low < high", low, high, low < high)?;
    Refutation::unless(CLAIM, "high ≤ a_{m−1}", high, a_top, high <= a_top)?;
    let width = high - low;
    for k_tilde in [low + PROBE * width, high - PROBE * width] {
        for (i, q) in weights(law, k_tilde).into_iter().enumerate() {
            Refutation::unless(CLAIM, &format!("Q{0}{0} > 0 inside", i + 1), q, 0.0, q > 0.0)?;
        }
    }
    for (edge, outside, free) in
        [("low", low - PROBE * width, low <= 0.0), ("high", high + PROBE * width, high >= a_top)]
    {
        let least = weights(law, outside).into_iter().least();
        let what = format!("some q_i ≤ 0 beyond {edge}");
        Refutation::unless(CLAIM, &what, least, 0.0, free || least <= 0.0)?;
    }
    Ok(())
}

/// Returns true if the half-lines `q_i(K̃) > 0` have no common point in `(0, a_{m−1})`, or `K_p`, `K_d` are
/// not positive.
fn nowhere_positive(law: &UnitLaw) -> bool {
    let (mut from, mut to) = (0.0_f64, law.a_top());
    let whole = law.a_top();
    let (start, end) = (weights(law, 0.0), weights(law, whole));
    for (q0, q1) in start.into_iter().zip(end) {
        let slope = (q1 - q0) / whole;
        if slope > 0.0 {
            from = from.max(-q0 / slope);
        } else if slope < 0.0 {
            to = to.min(-q0 / slope);
        } else if q0 <= 0.0 {
            return true;
        }
    }
    let positive = law.kp > 0.0 && law.kd > 0.0;
    !positive || from >= to * (1.0 - 1e-9)
}
