//! Weights of a law's inverse optimality, as polynomials of `w = ω²`.

use crate::UnitLaw;
use crate::check::polynomial::{product, squared};

/// `h(w) = (|(jω)^m + K̃g(jω)|² − ω^{2m})/K̃`, of degree `m − 1`: `|g|²K̃` and what both have in common,
/// `|s^m + g|² − |s^m|² − |g|²`.
pub(crate) fn difference(law: &UnitLaw, k_tilde: f64) -> Vec<f64> {
    let (m, g) = (law.order(), law.g());
    let alone = squared(&g);
    let mut both = g;
    both.push(1.0);
    let together = squared(&both);
    (0..m).map(|k| together[k] - alone[k] + k_tilde * alone[k]).collect()
}

/// `q_1 … q_{m+2}`: coefficients of `|D(jω)|² h`.
pub(crate) fn weights(law: &UnitLaw, k_tilde: f64) -> Vec<f64> {
    product(&squared(&[law.kp, law.kd, 1.0]), &difference(law, k_tilde))
}
