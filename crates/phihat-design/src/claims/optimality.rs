//! Inverse optimality: the law is the optimal one of a game, whose weights are the certificate.

pub use phihat_certificate::{Certified, LevelRefused, Optimality};

use phihat_certificate::extremes::Extremes as _;

use crate::claims::law::{Refutation, UnitLaw, holds};
use crate::claims::matrix::RationalMatrix;
use crate::claims::weights::{WeightCondition, conditions, q_diagonal};

/// Largest residual of the game Riccati equation, relative to the sum of the absolute values of its terms.
pub const RESIDUAL: f64 = 1e-10;

const CLAIM: &str = "optimality";

/// Judging [`Optimality`].
pub trait FindOptimality: Sized {
    /// Judges a law at a given `K̃`.
    ///
    /// # Errors
    ///
    /// [`Refutation`], when the law itself makes no sense (order, finite gains, `a_{m−1} > 0`), or when
    /// what was computed does not survive its check.
    fn at(law: &UnitLaw, k_tilde: f64) -> Result<Self, Refutation>;
}

impl FindOptimality for Optimality {
    fn at(law: &UnitLaw, k_tilde: f64) -> Result<Self, Refutation> {
        law.check(CLAIM)?;
        let claim = match refusal(law, k_tilde) {
            Some(refused) => Self::Refuted(refused),
            None => Self::Certified(certified(law, k_tilde)),
        };
        claim.verify(law)?;
        Ok(claim)
    }
}

/// The last row of (13) read upwards gives `S` in closed form.
fn certified(law: &UnitLaw, k_tilde: f64) -> Certified {
    let s = riccati_solution(law, k_tilde);
    let gamma = 1.0 / (law.a_top() - k_tilde).sqrt();
    let worst = last_column(&s).iter().map(|v| v / (gamma * gamma)).collect();
    Certified { k_tilde, gamma, q: q_diagonal(law, k_tilde), s, worst }
}

/// Off its diagonal, (13) reads `S_{i−1,j} = −S_{i,j−1} + K̃c_ic_j − c_il_j − l_ic_j`, with `c = SB` and `l`
/// the last row of `A`.
fn riccati_solution(law: &UnitLaw, k_tilde: f64) -> RationalMatrix {
    let n = law.order() + 2;
    let c: Vec<f64> = law.k().iter().map(|k_i| k_i / law.a_top()).collect();
    let l = law.a_matrix().pop().unwrap_or_default();
    let mut s = vec![vec![0.0; n]; n];
    for j in 0..n {
        s[n - 1][j] = c[j];
        s[j][n - 1] = c[j];
    }
    for i in (1..n).rev() {
        for j in 0..i {
            let before = if j == 0 { 0.0 } else { s[i][j - 1] };
            let entry = k_tilde * c[i] * c[j] - c[i] * l[j] - l[i] * c[j] - before;
            s[i - 1][j] = entry;
            s[j][i - 1] = entry;
        }
    }
    s
}

/// The first obstacle to a certificate at this `K̃`.
fn refusal(law: &UnitLaw, k_tilde: f64) -> Option<LevelRefused> {
    let refused = |condition: &str, quantity: String, value: f64| LevelRefused {
        k_tilde,
        condition: condition.to_owned(),
        quantity,
        value,
    };
    let room = law.a_top() - k_tilde;
    for (name, left, value) in [("K̃ > 0", "K̃", k_tilde), ("K̃ < a_{m−1}", "a_{m−1} − K̃", room)]
    {
        let positive = value > 0.0;
        if !positive {
            return Some(refused(name, left.to_owned(), value));
        }
    }
    let named = conditions(law, k_tilde);
    // The last failing condition is the one that shows in Q: B2 before B1, A3 before A2 before A1.
    let fails = |c: &&WeightCondition| c.left <= c.right;
    let q = q_diagonal(law, k_tilde);
    // The most telling diagonal entry: the last one, where no K_p or K_d hides the estimator.
    if let Some((i, q_i)) = q.iter().enumerate().rev().find(|(_, q_i)| **q_i <= 0.0) {
        let name =
            named.iter().rev().find(fails).map_or_else(|| quantity(i), |c| c.name.to_owned());
        return Some(refused(&name, quantity(i), *q_i));
    }
    gains_positive(law).err().map(|r| {
        let name = named.first().map_or_else(|| r.inequality.clone(), |c| c.name.to_owned());
        refused(&name, r.inequality.replace(" > 0", ""), r.left)
    })
}

fn gains_positive(law: &UnitLaw) -> Result<(), Refutation> {
    holds(CLAIM, "K_p > 0", law.kp, 0.0, law.kp > 0.0)?;
    holds(CLAIM, "K_d > 0", law.kd, 0.0, law.kd > 0.0)?;
    let least = law.a.iter().copied().least();
    holds(CLAIM, "a_i > 0", least, 0.0, least > 0.0)
}

/// `SB`.
pub(crate) fn last_column(s: &RationalMatrix) -> Vec<f64> {
    s.iter().filter_map(|row| row.last().copied()).collect()
}

fn quantity(i: usize) -> String {
    format!("Q{0}{0}", i + 1)
}
