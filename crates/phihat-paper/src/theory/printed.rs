//! The matrices that the paper prints, letter by letter, and the residual of its equation (13).
//!
//! None of it shares code with the certificates of `phihat-design`.

use phihat_design::claims::UnitLaw;
use phihat_design::claims::matrix::{RationalMatrix, product, transpose};

use crate::joint::{outer, zeros};

/// Form of `Q_33` in (18).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Q33 {
    /// `K̃ b_0 + …`
    Printed,
    /// `K̃ b_0² + …`, as in (32).
    Corrected,
}

/// The scalars of (18): `K̃`, `b_0`, `K_p`, `K_d`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scalars {
    pub(super) k: f64,
    pub(super) b: f64,
    pub(super) kp: f64,
    pub(super) kd: f64,
}

impl Scalars {
    /// Those of a second-order law.
    pub(super) fn of(law: &UnitLaw, k_tilde: f64) -> Self {
        Self { k: k_tilde, b: law.a[0] / law.a_top(), kp: law.kp, kd: law.kd }
    }

    /// `Q` of (18).
    pub(super) fn q(self, q33: Q33) -> Vec<f64> {
        let Self { k, b, kp, kd } = self;
        let (rest, damping) = (k - 2.0 * b, kd * kd - 2.0 * kp);
        let head = match q33 {
            Q33::Printed => k * b,
            Q33::Corrected => k * b * b,
        };
        vec![k * b * b * kp * kp, k * b * b * damping + kp * kp * rest, head + rest * damping, rest]
    }

    /// `S` of (18).
    pub(super) fn s(self) -> RationalMatrix {
        let Self { k, b, kp, kd } = self;
        let s12 = b * kp * kp + b * b * k * kp + b * k * kp * kd;
        let s13 = b * k * kp + b * kp * kd;
        let s23 = b * kd * kd + k * kp + b * k * kd + kp * kd - b * kp;
        vec![
            vec![b * k * kp * kp + b * b * k * kp * kd, s12, s13, b * kp],
            vec![s12, b * b * k * kd + b * k * kd * kd + k * kp * kd + kp * kp, s23, kp + b * kd],
            vec![s13, s23, kd * kd + b * k + k * kd, kd + b],
            vec![b * kp, kp + b * kd, kd + b, 1.0],
        ]
    }
}

/// `Q` of (22), m = 1.
pub(super) fn q22(k: f64, kp: f64, kd: f64) -> Vec<f64> {
    vec![k * kp * kp, k * (kd * kd - 2.0 * kp), k]
}

/// `AᵀS + SA − SB R⁻¹BᵀS + γ⁻²SBBᵀS + Q` of (13) with `R⁻¹ = a_{m−1}`, the largest entry relative to the largest
/// term of its own sum.
pub(super) fn residual_13(law: &UnitLaw, gamma: f64, q: &[f64], s: &RationalMatrix) -> f64 {
    let n = s.len();
    let sa = product(s, &law.a_matrix());
    let at_s = transpose(&sa);
    let sb: Vec<f64> = s.iter().map(|row| row[n - 1]).collect();
    let square = outer(&sb, &sb);
    let mut weight = zeros(n, n);
    for (i, q_i) in q.iter().enumerate() {
        weight[i][i] = *q_i;
    }
    let mut worst: f64 = 0.0;
    for i in 0..n {
        for j in 0..n {
            let terms = [
                sa[i][j],
                at_s[i][j],
                -law.a_top() * square[i][j],
                square[i][j] / (gamma * gamma),
                weight[i][j],
            ];
            let size = terms.iter().fold(0.0_f64, |most, term| most.max(term.abs()));
            if size > 0.0 {
                worst = worst.max(terms.iter().sum::<f64>().abs() / size);
            }
        }
    }
    worst
}
