//! The diagonal of `Q` that a law is optimal for, and the conditions the paper names for it.

use phihat_certificate::extremes::Extremes as _;

use crate::claims::law::UnitLaw;
use crate::claims::polynomial;

/// One of the paper's conditions with both its sides: it holds when `left > right`.
#[derive(Debug, Clone, PartialEq)]
pub struct WeightCondition {
    /// `A1` … `A3`, `B1`, `B2`.
    pub name: &'static str,
    /// Left side.
    pub left: f64,
    /// Right side.
    pub right: f64,
}

/// The paper's sufficient conditions of the order; none are published beyond m = 2.
///
/// A2 follows from nothing and is not necessary at m = 2: `Q` may be positive without it. What
/// decides is `q_i > 0`.
pub fn conditions(law: &UnitLaw, k_tilde: f64) -> Vec<WeightCondition> {
    let gains = law.a.iter().copied().chain([law.kp, law.kd]).least();
    let damping = |name| WeightCondition { name, left: law.kd * law.kd, right: 2.0 * law.kp };
    match law.a[..] {
        [_] => vec![WeightCondition { name: "B1", left: gains, right: 0.0 }, damping("B2")],
        [a0, a1] => vec![
            WeightCondition { name: "A1", left: gains, right: 0.0 },
            damping("A2"),
            WeightCondition { name: "A3", left: a1 * k_tilde, right: 2.0 * a0 },
        ],
        _ => Vec::new(),
    }
}

/// `q_1 … q_{m+2}` of (W1). `h = (|(jω)^m + K̃g|² − ω^{2m})/K̃ = K̃ |g|² + 2 Re(g(jω) (−jω)^m)`.
pub fn q_diagonal(law: &UnitLaw, k_tilde: f64) -> Vec<f64> {
    polynomial::product(&polynomial::magnitude_squared(&law.d()), &return_difference(law, k_tilde))
}

/// `h(w) = (|(jω)^m + K̃ g(jω)|² − ω^{2m})/K̃` as a polynomial in `w = ω²` of degree `m − 1`.
pub fn return_difference(law: &UnitLaw, k_tilde: f64) -> Vec<f64> {
    let (constant, slope) = return_difference_parts(law);
    constant.iter().zip(&slope).map(|(c, s)| c + k_tilde * s).collect()
}

/// `h = constant + K̃ slope`: `2 Re(g(jω) (−jω)^m)` and `|g(jω)|²`.
pub(crate) fn return_difference_parts(law: &UnitLaw) -> (Vec<f64>, Vec<f64>) {
    let (m, g) = (law.order(), law.g());
    let mut power = vec![0.0; m + 1];
    power[m] = 1.0;
    let constant = polynomial::real_part(&g, &power).iter().map(|c| 2.0 * c).take(m).collect();
    (constant, polynomial::magnitude_squared(&g))
}
