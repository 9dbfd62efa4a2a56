//! Inverse optimality: the law is the optimal one of a game, whose weights are the evidence.

use core::fmt;

use serde::{Deserialize, Serialize};

use crate::check::agree::agrees;
use crate::check::definite::definite_within;
use crate::check::polynomial::product;
use crate::extremes::Extremes as _;
use crate::weights::weights;
use crate::{Matrix, Refutation, UnitLaw};

const CLAIM: &str = "optimality";

/// Inverse optimality of a law at one value of `K̃`: certified, or refuted.
///
/// # Claim
///
/// ```text
/// AᵀS + SA − K̃ S B Bᵀ S + Q = 0,   Q = diag(q_1 … q_{m+2}) ≻ 0,   S ≻ 0                      (13)
/// a_{m−1} BᵀS = K,   a_{m−1} = R⁻¹ = K̃ + 1/γ²                                              (14), (20)
/// q_i = coefficient of ω^{2(i−1)} in (1/K̃) |D(jω)|² (|(jω)^m + K̃ g(jω)|² − ω^{2m})           as (W1)
/// ```
///
/// Then the L2-gain from `d = −φ` to the cost `xᵀQx + uᵀRu` is at most `γ²` (11), and the worst
/// disturbance is `d = BᵀSx/γ²`.
///
/// # Not claimed
///
/// A refusal says that no *diagonal* `Q` exists at this `K̃`, not that the loop is unstable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, tag = "outcome", rename_all = "snake_case")]
pub enum Optimality {
    /// The weights exist; here they are.
    Certified(Certified),
    /// The weights do not exist; this is the condition in the way.
    Refuted(LevelRefused),
}

/// The evidence of inverse optimality.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Certified {
    /// `K̃` \[1/s\].
    pub k_tilde: f64,
    /// Attenuation level `γ`.
    pub gamma: f64,
    /// Diagonal of `Q`.
    pub q: Vec<f64>,
    /// `S`, row by row.
    pub s: Matrix,
    /// Worst-case disturbance feedback: `d = worstᵀx`, `worst = SB/γ²`.
    pub worst: Vec<f64>,
}

/// Why there is no certificate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LevelRefused {
    /// `K̃` at which it was asked for \[1/s\].
    pub k_tilde: f64,
    /// The paper's name of the condition (A1 … A3, B1, B2), or `Q33` and so on for higher orders.
    pub condition: String,
    /// The quantity that decides, such as `Q44`.
    pub quantity: String,
    /// Value of the quantity; it should be positive.
    pub value: f64,
}

impl fmt::Display for LevelRefused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "refused on {} with {} = {:.4}", self.condition, self.quantity, self.value)
    }
}

impl Optimality {
    /// The certificate, if there is one.
    pub fn certified(&self) -> Option<&Certified> {
        match self {
            Self::Certified(certified) => Some(certified),
            Self::Refuted(_) => None,
        }
    }
}

/// Largest residual of the game Riccati equation, relative to the sum of the sizes of its terms.
const RESIDUAL: f64 = 1e-10;

impl Optimality {
    /// Checks the evidence, or that there can be none.
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming the inequality that fails.
    pub fn verify(&self, law: &UnitLaw) -> Result<(), Refutation> {
        match self {
            Self::Certified(certified) => certified.verify(law),
            Self::Refuted(refused) => refused.verify(law),
        }
    }
}

impl Certified {
    fn verify(&self, law: &UnitLaw) -> Result<(), Refutation> {
        let yes = Refutation::unless;
        law.check(CLAIM)?;
        let n = law.order() + 2;
        let Self { k_tilde, gamma, q, s, worst } = self;
        yes(CLAIM, "K̃ > 0", *k_tilde, 0.0, *k_tilde > 0.0)?;
        yes(CLAIM, "γ > 0", *gamma, 0.0, *gamma > 0.0)?;
        let sides = (k_tilde + 1.0 / (gamma * gamma), law.a_top());
        agrees(CLAIM, "K̃ + 1/γ² = a_{m−1}", sides, 1e-12)?;
        let square = s.len() == n && s.iter().all(|row| row.len() == n);
        let finite = s.iter().flatten().all(|value| value.is_finite());
        let even = square && (0..n).all(|i| (0..i).all(|j| s[i][j].to_bits() == s[j][i].to_bits()));
        let what = "S = Sᵀ ∈ ℝ^{(m+2)×(m+2)}";
        yes(CLAIM, what, s.len() as f64, n as f64, even && finite)?;
        let sizes = q.len() == n && worst.len() == n;
        yes(CLAIM, "Q and d are of size m+2", q.len() as f64, n as f64, sizes)?;
        for (i, (q, of_t5)) in q.iter().zip(weights(law, *k_tilde)).enumerate() {
            yes(CLAIM, &format!("Q{0}{0} > 0", i + 1), *q, 0.0, *q > 0.0)?;
            agrees(CLAIM, &format!("Q{0}{0} of (W1)", i + 1), (*q, of_t5), RESIDUAL)?;
        }
        // K of (16): the coefficients of D(s)(a_{m−1}s^{m−1} + … + a_0).
        let feedback = product(&law.a, &[law.kp, law.kd, 1.0]);
        for i in 0..n {
            let sb = s[i][n - 1];
            agrees(CLAIM, "a_{m−1} BᵀS = K", (law.a_top() * sb, feedback[i]), 1e-12)?;
            agrees(CLAIM, "d = BᵀSx/γ²", (worst[i], sb / (gamma * gamma)), 1e-12)?;
        }
        self.riccati(law)?;
        definite_within(CLAIM, "S ≻ 0", s, 1e-14)?;
        gains_positive(law)
    }

    /// (13), entry by entry: `A` shifts the ladder and has `−K_p`, `−K_d` in its last row.
    fn riccati(&self, law: &UnitLaw) -> Result<(), Refutation> {
        let (s, n) = (&self.s, self.s.len());
        let last = |j: usize| match n - j {
            1 => -law.kd,
            2 => -law.kp,
            _ => 0.0,
        };
        for i in 0..n {
            for j in 0..n {
                let half = |i: usize, j: usize| {
                    let shifted = j.checked_sub(1).map_or(0.0, |j| s[i][j]);
                    [shifted, s[i][n - 1] * last(j)]
                };
                let pull = -self.k_tilde * s[i][n - 1] * s[j][n - 1];
                let weight = if i == j { self.q[i] } else { 0.0 };
                let terms = half(i, j).into_iter().chain(half(j, i)).chain([pull, weight]);
                let (sum, size) =
                    terms.fold((0.0, 0.0), |(sum, size), t: f64| (sum + t, size + t.abs()));
                let room = RESIDUAL * size;
                let what = "|AᵀS + SA − K̃SBBᵀS + Q| ≤ 1e-10 (sum of absolute terms)";
                Refutation::unless(CLAIM, what, f64::abs(sum), room, f64::abs(sum) <= room)?;
            }
        }
        Ok(())
    }
}

impl LevelRefused {
    /// The quantity that is named must be what it is said to be, not positive, and the condition one of the
    /// paper's that fails, or the quantity's own name.
    fn verify(&self, law: &UnitLaw) -> Result<(), Refutation> {
        const CLAIM: &str = "refusal of optimality";
        law.check(CLAIM)?;
        let room = law.a_top() - self.k_tilde;
        let q = weights(law, self.k_tilde);
        let deciding = q.iter().rposition(|q| *q <= 0.0);
        let least = law.a.iter().copied().least();
        let (quantity, value) = if self.k_tilde.is_nan() || self.k_tilde <= 0.0 {
            ("K̃".to_owned(), self.k_tilde)
        } else if room.is_nan() || room <= 0.0 {
            ("a_{m−1} − K̃".to_owned(), room)
        } else if let Some(i) = deciding {
            (format!("Q{0}{0}", i + 1), q[i])
        } else if law.kp.is_nan() || law.kp <= 0.0 {
            ("K_p".to_owned(), law.kp)
        } else if law.kd.is_nan() || law.kd <= 0.0 {
            ("K_d".to_owned(), law.kd)
        } else {
            ("a_i".to_owned(), least)
        };
        let what = format!("{} ≤ 0", self.quantity);
        Refutation::unless(CLAIM, &what, value, 0.0, value <= 0.0)?;
        let named = self.quantity == quantity;
        let what = format!("{} fails", self.condition);
        Refutation::unless(CLAIM, &what, self.value, value, named)?;
        let fails = self.conditions(law).as_ref() == Some(&self.condition) || !self.is_papers();
        Refutation::unless(CLAIM, &what, self.value, value, fails)?;
        agrees(CLAIM, &quantity, (self.value, value), RESIDUAL)
    }

    /// Returns true if the condition has one of the paper's names; else it is the quantity's own.
    fn is_papers(&self) -> bool {
        !(self.condition == self.quantity
            || self.condition == "K̃ > 0"
            || self.condition == "K̃ < a_{m−1}"
            || self.condition == format!("{} > 0", self.quantity))
    }

    /// The last of the paper's conditions of the order that fails here.
    fn conditions(&self, law: &UnitLaw) -> Option<String> {
        let least = law.a.iter().copied().chain([law.kp, law.kd]).least();
        let damping = law.kd * law.kd > 2.0 * law.kp;
        let list = match law.a[..] {
            [_] => vec![("B1", least > 0.0), ("B2", damping)],
            [a0, a1] => {
                vec![("A1", least > 0.0), ("A2", damping), ("A3", a1 * self.k_tilde > 2.0 * a0)]
            }
            _ => Vec::new(),
        };
        list.into_iter().rev().find(|(_, holds)| !holds).map(|(name, _)| name.to_owned())
    }
}

fn gains_positive(law: &UnitLaw) -> Result<(), Refutation> {
    Refutation::unless(CLAIM, "K_p > 0", law.kp, 0.0, law.kp > 0.0)?;
    Refutation::unless(CLAIM, "K_d > 0", law.kd, 0.0, law.kd > 0.0)?;
    let least = law.a.iter().copied().least();
    Refutation::unless(CLAIM, "a_i > 0", least, 0.0, least > 0.0)
}
