//! Inverse optimality: the law is the optimal one of a game, whose weights are the certificate.

pub use phihat_certificate::{Certified, Optimality, Refused};

use crate::claims::law::{Law, Refutation, agrees, holds};
use crate::claims::matrix::{Matrix, absolute, failing_pivot, is_symmetric, product, transpose};
use crate::claims::weights::{Condition, conditions, q_diagonal};

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
    /// what was computed does not survive [`Self::verify`].
    fn at(law: &Law, k_tilde: f64) -> Result<Self, Refutation>;

    /// Recomputes everything from the gains.
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming the inequality that fails.
    fn verify(&self, law: &Law) -> Result<(), Refutation>;
}

impl FindOptimality for Optimality {
    fn at(law: &Law, k_tilde: f64) -> Result<Self, Refutation> {
        law.check(CLAIM)?;
        let claim = match refusal(law, k_tilde) {
            Some(refused) => Self::Refuted(refused),
            None => Self::Certified(certified(law, k_tilde)),
        };
        claim.verify(law)?;
        Ok(claim)
    }

    fn verify(&self, law: &Law) -> Result<(), Refutation> {
        match self {
            Self::Certified(certified) => certified.verify(law),
            Self::Refuted(refused) => refused.verify(law),
        }
    }
}

/// The evidence, found and checked.
trait Evidence {
    fn verify(&self, law: &Law) -> Result<(), Refutation>;
}

impl Evidence for Certified {
    fn verify(&self, law: &Law) -> Result<(), Refutation> {
        law.check(CLAIM)?;
        let (n, k) = (law.order() + 2, law.k());
        let Self { k_tilde, gamma, q, s, worst } = self;
        holds(CLAIM, "K̃ > 0", *k_tilde, 0.0, *k_tilde > 0.0)?;
        holds(CLAIM, "γ > 0", *gamma, 0.0, *gamma > 0.0)?;
        let r_inverse = k_tilde + 1.0 / (gamma * gamma);
        agrees(CLAIM, "K̃ + 1/γ² = a_{m−1}", r_inverse, law.a_top(), 1e-12)?;
        let symmetric = is_symmetric(s, n);
        holds(CLAIM, "S = Sᵀ ∈ ℝ^{(m+2)×(m+2)}", s.len() as f64, n as f64, symmetric)?;
        let sizes = q.len() == n && worst.len() == n;
        holds(CLAIM, "Q and d are of size m+2", q.len() as f64, n as f64, sizes)?;
        let expected = q_diagonal(law, *k_tilde);
        for (i, (q_i, of_t5)) in q.iter().zip(&expected).enumerate() {
            let name = quantity(i);
            holds(CLAIM, &format!("{name} > 0"), *q_i, 0.0, *q_i > 0.0)?;
            agrees(CLAIM, &format!("{name} of (T5)"), *q_i, *of_t5, RESIDUAL)?;
        }
        let sb = last_column(s);
        for i in 0..n {
            agrees(CLAIM, "a_{m−1} BᵀS = K", law.a_top() * sb[i], k[i], 1e-12)?;
            agrees(CLAIM, "d = BᵀSx/γ²", worst[i], sb[i] / (gamma * gamma), 1e-12)?;
        }
        check_riccati(law, *k_tilde, q, s)?;
        match failing_pivot(s) {
            None => gains_positive(law),
            Some((_, pivot, least)) => holds(CLAIM, "S ≻ 0", pivot, least, false),
        }
    }
}

/// The last row of (13) read upwards gives `S` in closed form.
fn certified(law: &Law, k_tilde: f64) -> Certified {
    let s = riccati_solution(law, k_tilde);
    let gamma = 1.0 / (law.a_top() - k_tilde).sqrt();
    let worst = last_column(&s).iter().map(|v| v / (gamma * gamma)).collect();
    Certified { k_tilde, gamma, q: q_diagonal(law, k_tilde), s, worst }
}

impl Evidence for Refused {
    fn verify(&self, law: &Law) -> Result<(), Refutation> {
        law.check(CLAIM)?;
        let claim = "refusal of optimality";
        let Some(found) = refusal(law, self.k_tilde) else {
            return holds(claim, &format!("{} ≤ 0", self.quantity), self.value, 0.0, false);
        };
        let same = found.condition == self.condition && found.quantity == self.quantity;
        holds(claim, &format!("{} fails", self.condition), self.value, found.value, same)?;
        agrees(claim, &self.quantity, self.value, found.value, RESIDUAL)
    }
}

fn check_riccati(law: &Law, k_tilde: f64, q: &[f64], s: &Matrix) -> Result<(), Refutation> {
    let (a, sb) = (law.a_matrix(), last_column(s));
    let (sa, size) = (product(s, &a), product(&absolute(s), &absolute(&a)));
    let (at_s, at_size) = (transpose(&sa), transpose(&size));
    for i in 0..s.len() {
        for j in 0..s.len() {
            let weight = if i == j { q[i] } else { 0.0 };
            let pull = k_tilde * sb[i] * sb[j];
            let residual = (sa[i][j] + at_s[i][j] - pull + weight).abs();
            let scale = size[i][j] + at_size[i][j] + pull.abs() + weight.abs();
            let name = "|AᵀS + SA − K̃SBBᵀS + Q| ≤ 1e-10 (sum of absolute terms)";
            holds(CLAIM, name, residual, RESIDUAL * scale, residual <= RESIDUAL * scale)?;
        }
    }
    Ok(())
}

/// Off its diagonal, (13) reads `S_{i−1,j} = −S_{i,j−1} + K̃c_ic_j − c_il_j − l_ic_j`, with `c = SB` and `l`
/// the last row of `A`.
fn riccati_solution(law: &Law, k_tilde: f64) -> Matrix {
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
fn refusal(law: &Law, k_tilde: f64) -> Option<Refused> {
    let refused = |condition: &str, quantity: String, value: f64| Refused {
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
    let fails = |c: &&Condition| c.left <= c.right;
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

fn gains_positive(law: &Law) -> Result<(), Refutation> {
    holds(CLAIM, "K_p > 0", law.kp, 0.0, law.kp > 0.0)?;
    holds(CLAIM, "K_d > 0", law.kd, 0.0, law.kd > 0.0)?;
    let least = law.a.iter().copied().fold(f64::INFINITY, f64::min);
    holds(CLAIM, "a_i > 0", least, 0.0, least > 0.0)
}

/// `SB`.
pub(crate) fn last_column(s: &Matrix) -> Vec<f64> {
    s.iter().filter_map(|row| row.last().copied()).collect()
}

fn quantity(i: usize) -> String {
    format!("Q{0}{0}", i + 1)
}
