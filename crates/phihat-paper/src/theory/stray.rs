//! Errata of single symbols: a stray C, a missing transpose, a scalar that stands for a matrix.

use phihat_design::claims::matrix::{apply, dot};
use phihat_design::claims::{ErrorLimits, MinimalGains, Optimality, UnitLaw};
use phihat_design::prelude::*;

use super::printed::{Q33, Scalars, residual_13};
use crate::compose::{number, three};
use crate::draw::Draw;
use crate::gains::{K_TILDE_H3, PHI_MAX, second_h3};
use crate::joint::largest;
use crate::part::PartError;
use crate::published::Published;
use crate::record::{Statement, Verdict};

/// Largest relative deviation that counts as rounding.
const ROUNDING: f64 = 1e-9;

/// All of them.
pub(super) fn stray() -> Result<Vec<Statement>, PartError> {
    Ok(vec![stray_c(), chain(), transpose(), scalar()?])
}

fn scalars() -> Scalars {
    Scalars::of(&second_h3(), K_TILDE_H3)
}

/// (12) with a factor C in front of B and D.
fn stray_c() -> Statement {
    let law = second_h3();
    let gamma = (law.a_top() - K_TILDE_H3).sqrt().recip();
    let (q, s) = (scalars().q(Q33::Corrected), scalars().s());
    let with = |c: f64| {
        let a = law.a.iter().map(|a| a * c * c).collect();
        residual_13(&UnitLaw { a, ..law.clone() }, gamma / c, &q, &s)
    };
    let (none, twice) = (with(1.0), with(2.0));
    Published {
        id: "erratum-stray-c",
        place: "(12)",
        claim: "ẋ = Ax + CBu + CDd leads to (13)",
        paper: "C in front of B and D",
    }
    .found(
        format!("residual of (13) with C = I: {none:.0e}; with C = 2I: {twice:.2}"),
        Verdict::of(twice < ROUNDING, none < ROUNDING),
        "ẋ = Ax + Bu + Dd, as in (15). C is defined nowhere, and (13) is the equation of the system without it.",
        vec![number("residual of (13) with C = 2I", "", twice, 1e-6)],
    )
    .assuming(&["gains"])
}

/// The second line of the chain of Theorem 4, where C stands in place of a sign.
fn chain() -> Statement {
    let (law, s, mut draw) = (second_h3(), scalars().s(), Draw::new(4));
    let (mut plus, mut product): (f64, f64) = (0.0, 0.0);
    for _ in 0..200 {
        let (x, u) = (draw.spread(4, 1.0), draw.between(-1.0, 1.0));
        let sx = apply(&s, &x);
        let (delta, drift) = (sx[3], 2.0 * dot(&sx, &apply(&law.a_matrix(), &x)));
        let (cost, square) = (u * u / law.a_top(), K_TILDE_H3 * delta * delta);
        let first = -drift + square + cost;
        let start = -drift - 2.0 * delta * u + cost;
        let size = drift.abs() + square + cost + (delta * u).abs();
        plus = plus.max((start + 2.0 * delta * u + square - first).abs() / size);
        product = product.max((start + 2.0 * delta * u * square - first).abs() / size);
    }
    Published {
        id: "erratum-chain",
        place: "Theorem 4, proof, second line",
        claim: "The second line of J is equal to the first",
        paper: "2xᵀSBu C xᵀSBK̃BᵀSx",
    }
    .found(
        format!("with a plus in place of C the lines differ by {plus:.0e}, as a product by {product:.2} (relative, 200 \
            random x and u)"),
        Verdict::of(product < ROUNDING, plus < ROUNDING),
        "2xᵀSBu + xᵀSBK̃BᵀSx.",
        vec![number("difference as a product", "", product, 1e-3)],
    )
    .assuming(&["gains"])
}

/// "SBK̃BS" after (41).
fn transpose() -> Statement {
    type Shape = (usize, usize);
    let (n, m) = (3, 2);
    let states = (m + 2) * n;
    let defined = |factors: &[Shape]| factors.windows(2).all(|two| two[0].1 == two[1].0);
    let (s, b, k, bt) = ((states, states), (states, n), (n, n), (n, states));
    let (printed, corrected) = (defined(&[s, b, k, b, s]), defined(&[s, b, k, bt, s]));
    let say = |defined: bool| if defined { "defined" } else { "not defined" };
    Published {
        id: "erratum-41",
        place: "After (41)",
        claim: "SBK̃BS is a product of matrices",
        paper: "SBK̃BS",
    }
    .found(
        format!("n = 3, m = 2: SBK̃BS is {}, SBK̃BᵀS {}", say(printed), say(corrected)),
        Verdict::of(printed, corrected),
        "SBK̃BᵀS, as in the line after.",
        Vec::new(),
    )
}

/// (20) with one K̃ per joint, as Sec. V-A finds them.
fn scalar() -> Result<Statement, PartError> {
    let limits = [0.1, 0.2].map(|rate| vec![1e-3, 1e-2, rate]);
    let mut found = Vec::new();
    for x_max in limits {
        found.push(MinimalGains::first_order(&ErrorLimits { phi_max: PHI_MAX, x_max })?);
    }
    let each: Vec<f64> = found.iter().map(|gains| gains.k_tilde).collect();
    let spread = largest(each.iter().map(|k| k / each[0] - 1.0));
    let certified = found.iter().filter(|gains| {
        let law = UnitLaw { kp: gains.kp, kd: 1.01 * gains.kd, a: vec![gains.k_tilde + 1.0] };
        Optimality::at(&law, gains.k_tilde).is_ok_and(|claim| claim.certified().is_some())
    });
    let certified = certified.count();
    Ok(Published {
        id: "erratum-20-scalar",
        place: "(20), Sec. V-A",
        claim: "αK̃ + I/γ² is a_{m−1}I, and K̃ has an entry per joint",
        paper: "a_{m−1}I; K̃(i, i)",
    }
    .found(
        format!(
            "two joints with ė limits of 0.1 and 0.2 rad/s: K̃ = {}, {} by (44); with an a_0 each, {certified} of 2 \
                have a certificate",
            three(each.first().copied()),
            three(each.get(1).copied())
        ),
        Verdict::of(spread == 0.0, certified == found.len()),
        "One a_{m−1} per joint, as K_p and K_d have: the joints are independent in (7), so that the theorems hold \
            joint by joint.",
        vec![number("relative difference of K̃ between the joints", "", spread, 1e-9)],
    )
    .assuming(&["phi-max"]))
}
