//! Attenuation levels that can be certified for a law: the values of `K̃` that admit a certificate.

pub use phihat_certificate::{Attenuation, Interval};

use crate::claims::law::{Refutation, UnitLaw};
use crate::claims::polynomial::{self, Sign};
use crate::claims::weights::{return_difference, return_difference_parts};

const CLAIM: &str = "attenuation";

/// Relative distance to the edge at which an edge is probed.
const PROBE: f64 = 1e-6;

/// Finding an [`Attenuation`].
pub trait FindAttenuation: Sized {
    /// Finds the intervals: half-lines intersected for the first, bisection for the second.
    ///
    /// # Errors
    ///
    /// [`Refutation`], when the law makes no sense, or the result does not survive its check.
    fn of(law: &UnitLaw) -> Result<Self, Refutation>;
}

impl FindAttenuation for Attenuation {
    fn of(law: &UnitLaw) -> Result<Self, Refutation> {
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
}

/// Values of `K̃` within `(0, a_{m−1})` at which all `q_i = β_i + K̃ α_i` are positive.
fn diagonal_interval(law: &UnitLaw) -> Option<Interval> {
    let (constant, slope) = return_difference_parts(law);
    let d = polynomial::magnitude_squared(&law.d());
    let (beta, alpha) = (polynomial::product(&d, &constant), polynomial::product(&d, &slope));
    let (mut low, mut high) = (0.0_f64, law.a_top());
    for (b, a) in beta.iter().zip(&alpha) {
        let edge = -b / a;
        if *a > 0.0 {
            // The larger of two zeros of different sign is another one on every machine.
            low = if edge > low { edge } else { low };
        } else if *a < 0.0 {
            high = high.min(edge);
        } else if *b <= 0.0 {
            return None;
        }
    }
    (low < high && law.kp > 0.0 && law.kd > 0.0).then_some(Interval { low, high })
}

/// Smallest `K̃ < a_{m−1}` whose return difference is proven, to the last few bits.
fn least_return_difference(law: &UnitLaw) -> Option<f64> {
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
