//! How much attenuation a law can be certified for: the values of `K̃` that admit a certificate.

pub use phihat_certificate::{Attenuation, Interval};

use crate::claims::law::{Law, Refutation, agrees, holds};
use crate::claims::polynomial::{self, Sign};
use crate::claims::weights::{q_diagonal, return_difference, return_difference_parts};

const CLAIM: &str = "attenuation";

/// Relative distance to the edge at which an edge is probed.
const PROBE: f64 = 1e-6;

/// Finding an [`Attenuation`].
pub trait FindAttenuation: Sized {
    /// Finds the intervals: half-lines intersected for the first, bisection for the second.
    ///
    /// # Errors
    ///
    /// [`Refutation`], when the law makes no sense, or the result does not survive [`Self::verify`].
    fn of(law: &Law) -> Result<Self, Refutation>;

    /// Probes every edge from both sides.
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming the inequality that fails.
    fn verify(&self, law: &Law) -> Result<(), Refutation>;
}

impl FindAttenuation for Attenuation {
    fn of(law: &Law) -> Result<Self, Refutation> {
        law.check(CLAIM)?;
        let a_top = law.a_top();
        let gamma = |k_tilde: f64| 1.0 / (a_top - k_tilde).sqrt();
        let diagonal = diagonal_interval(law);
        let least = least_return_difference(law);
        let blocking_w = least.filter(|k| *k > 0.0).and_then(|k_tilde| {
            match polynomial::sign(&return_difference(law, k_tilde * (1.0 - PROBE))) {
                Sign::NegativeAt(w) if w.is_finite() => Some(w),
                _ => None,
            }
        });
        let found = Self {
            diagonal,
            return_difference: least,
            blocking_w,
            gamma_diagonal: diagonal.map(|interval| gamma(interval.low)),
            gamma_return_difference: least.map(gamma),
        };
        found.verify(law)?;
        Ok(found)
    }

    fn verify(&self, law: &Law) -> Result<(), Refutation> {
        law.check(CLAIM)?;
        verify_gammas(self, law)?;
        if let Some(interval) = self.diagonal {
            verify_diagonal(law, interval)?;
        } else {
            let none = diagonal_interval(law).is_none();
            holds(CLAIM, "no K̃ has q_i > 0 for all i", 0.0, 0.0, none)?;
        }
        let a_top = law.a_top();
        let Some(least) = self.return_difference else {
            let below =
                !polynomial::is_non_negative(&return_difference(law, a_top * (1.0 - PROBE)));
            return holds(CLAIM, "return difference fails below a_{m−1}", a_top, 0.0, below);
        };
        holds(CLAIM, "0 ≤ K̃_min < a_{m−1}", least, a_top, least >= 0.0 && least < a_top)?;
        let above = (least * (1.0 + PROBE)).max(a_top * 1e-12);
        let proven = polynomial::is_non_negative(&return_difference(law, above));
        holds(CLAIM, "|(jω)^m + K̃g|² ≥ ω^{2m} just above K̃_min", above, least, proven)?;
        if least > 0.0 {
            let h = return_difference(law, least * (1.0 - PROBE));
            let last = h.last().copied().unwrap_or(0.0);
            let value = self.blocking_w.map_or(last, |w| polynomial::value(&h, w));
            holds(CLAIM, "return difference < 0 just below K̃_min", value, 0.0, value < 0.0)?;
        }
        Ok(())
    }
}

fn verify_gammas(claim: &Attenuation, law: &Law) -> Result<(), Refutation> {
    let pairs = [
        (claim.diagonal.map(|i| i.low), claim.gamma_diagonal),
        (claim.return_difference, claim.gamma_return_difference),
    ];
    for (k_tilde, gamma) in pairs {
        let both = k_tilde.is_some() == gamma.is_some();
        holds(CLAIM, "γ is stated where K̃ is", 0.0, 0.0, both)?;
        if let (Some(k_tilde), Some(gamma)) = (k_tilde, gamma) {
            let r_inverse = k_tilde + 1.0 / (gamma * gamma);
            agrees(CLAIM, "K̃ + 1/γ² = a_{m−1}", r_inverse, law.a_top(), 1e-12)?;
            holds(CLAIM, "γ > 0", gamma, 0.0, gamma > 0.0)?;
        }
    }
    Ok(())
}

/// `q_i` is affine in `K̃`: positive just inside both ends means positive between them.
fn verify_diagonal(law: &Law, interval: Interval) -> Result<(), Refutation> {
    let (Interval { low, high }, a_top) = (interval, law.a_top());
    holds(CLAIM, "0 ≤ low", low, 0.0, low >= 0.0)?;
    holds(CLAIM, "low < high", low, high, low < high)?;
    holds(CLAIM, "high ≤ a_{m−1}", high, a_top, high <= a_top)?;
    let width = high - low;
    for k_tilde in [low + PROBE * width, high - PROBE * width] {
        for (i, q_i) in q_diagonal(law, k_tilde).iter().enumerate() {
            holds(CLAIM, &format!("Q{0}{0} > 0 inside", i + 1), *q_i, 0.0, *q_i > 0.0)?;
        }
    }
    for (edge, outside, free) in
        [("low", low - PROBE * width, low <= 0.0), ("high", high + PROBE * width, high >= a_top)]
    {
        let least = q_diagonal(law, outside).into_iter().fold(f64::INFINITY, f64::min);
        holds(CLAIM, &format!("some q_i ≤ 0 beyond {edge}"), least, 0.0, free || least <= 0.0)?;
    }
    Ok(())
}

/// Where all `q_i = β_i + K̃ α_i` are positive within `(0, a_{m−1})`.
fn diagonal_interval(law: &Law) -> Option<Interval> {
    let (constant, slope) = return_difference_parts(law);
    let d = polynomial::magnitude_squared(&law.d());
    let (beta, alpha) = (polynomial::product(&d, &constant), polynomial::product(&d, &slope));
    let (mut low, mut high) = (0.0_f64, law.a_top());
    for (b, a) in beta.iter().zip(&alpha) {
        if *a > 0.0 {
            low = low.max(-b / a);
        } else if *a < 0.0 {
            high = high.min(-b / a);
        } else if *b <= 0.0 {
            return None;
        }
    }
    (low < high && law.kp > 0.0 && law.kd > 0.0).then_some(Interval { low, high })
}

/// Smallest `K̃ < a_{m−1}` whose return difference is proven, to the last few bits.
fn least_return_difference(law: &Law) -> Option<f64> {
    let good = |k_tilde: f64| polynomial::is_non_negative(&return_difference(law, k_tilde));
    let (mut low, mut high) = (0.0, law.a_top());
    if good(0.0) {
        return Some(0.0);
    }
    if !good(high * (1.0 - PROBE)) {
        return None;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if good(middle) { high = middle } else { low = middle }
    }
    // At m = 2 the edge is K̃ = 2 b_0; bisection stops on its upper side.
    Some(high)
}
