//! Theorem 2: the game Riccati equation, for every order, and what its conditions are worth.

use phihat_design::claims::matrix::failing_pivot;
use phihat_design::claims::weights::{conditions, q_diagonal};
use phihat_design::claims::{Attenuation, Optimality, UnitLaw, polynomial};
use phihat_design::prelude::*;

use super::printed::{Q33, Scalars, q22, residual_13};
use crate::compose::{number, three, words};
use crate::draw::Draw;
use crate::gains::{K_TILDE, K_TILDE_H3, equal_rate, second_h1, second_h2, second_h3, second_h4};
use crate::part::PartError;
use crate::published::Published;
use crate::record::{Section, Statement, Table, Verdict};

/// A residual that is rounding.
const ROUNDING: f64 = 1e-9;

/// Theorem 2 and the remarks beside it.
pub(super) fn theorem_2(draws: usize) -> Result<Section, PartError> {
    let (every, table) = every_order()?;
    Ok(Section {
        id: "theorem-2".to_owned(),
        title: "Theorem 2: the law solves a game".to_owned(),
        text: words(&[
            "Given the law, Q and S are looked for such that (13) holds; then the gain (11) from the disturbance \
             −φ to the cost is at most γ². (13) is evaluated here term by term with the matrices as they are \
             printed, γ written out; nothing of it is shared with the certificates.",
        ]),
        statements: vec![
            q33()?,
            conditions_suffice(draws),
            first_order(draws)?,
            every,
            damping_is_not_necessary()?,
        ],
        tables: vec![table],
        figures: Vec::new(),
    })
}

/// The two residuals of (13), with `Q_33` as printed and as (32) has it, and γ.
fn residuals(law: &UnitLaw, k_tilde: f64) -> [f64; 3] {
    let gamma = (law.a_top() - k_tilde).sqrt().recip();
    let scalars = Scalars::of(law, k_tilde);
    let s = scalars.s();
    let residual = |q33| residual_13(law, gamma, &scalars.q(q33), &s);
    [residual(Q33::Printed), residual(Q33::Corrected), gamma]
}

/// (18) with `Q_33` as printed and as (32) has it: (13) is an identity in the gains, definite or not.
fn q33() -> Result<Statement, PartError> {
    let law = second_h3();
    let [printed, corrected, gamma] = residuals(&law, K_TILDE_H3);
    let [h1, h2, h4] = [second_h1(), second_h2(), second_h4()].map(|law| residuals(&law, K_TILDE));
    let scalars = Scalars::of(&law, K_TILDE_H3);
    let (q, s) = (scalars.q(Q33::Corrected), scalars.s());
    let definite = q.iter().all(|q_i| *q_i > 0.0) && failing_pivot(&s).is_none();
    let certified = Optimality::at(&law, K_TILDE_H3)?;
    let same = certified.certified().is_some_and(|c| {
        c.q.iter().zip(&q).all(|(ours, theirs)| (ours / theirs - 1.0).abs() < 1e-12)
    });
    let every = |i: usize| [printed, corrected][i].max(h1[i]).max(h2[i]).max(h4[i]);
    Ok(Published {
        id: "erratum-q33",
        place: "Theorem 2, (18)",
        claim: "Q and S of (18) solve (13) at m = 2",
        paper: "Q_33 = K̃ b_0 + (K̃ − 2b_0)(K_d² − 2K_p)",
    }
    .found(
        format!(
            "residual of (13), relative: {printed:.2}, {:.2}, {:.2}, {:.2} as printed (H3, H1, H2, H4); at most {:.0e} \
                with K̃ b_0²",
            h1[0],
            h2[0],
            h4[0],
            every(1)
        ),
        Verdict::of(every(0) < ROUNDING && definite, every(1) < ROUNDING && definite && same),
        "Q_33 begins with K̃ b_0², as (32) has it. All other entries of Q and S in (18) are right. At the gains H3 and \
         K̃ = 100, Q ≻ 0 and S ≻ 0. At H1 and H2 with the printed K̃ = 68.9 the matrices solve (13) too, but Q_44 < 0, \
         so that they prove nothing there.",
        vec![
            number("relative residual of (13) as printed, H3", "", printed, 1e-6),
            number("relative residual of (13) with b_0²", "", every(1), 1e4),
            number("γ, H3", "", gamma, 1e-9),
            number("Q_44 of H1 and H2 at K̃ = 68.9", "", Scalars::of(&second_h1(), K_TILDE).q(Q33::Corrected)[3], 1e-9),
        ],
    )
    .assuming(&["gains"]))
}

/// A1 to A3 on random laws.
fn conditions_suffice(draws: usize) -> Statement {
    let mut draw = Draw::new(2);
    let (mut named, mut certified, mut beyond) = (0, 0, 0);
    for _ in 0..draws {
        let law = draw.law(2);
        let k_tilde = law.a_top() * draw.between(0.05, 0.99);
        let holds = conditions(&law, k_tilde).iter().all(|c| c.left > c.right);
        let scalars = Scalars::of(&law, k_tilde);
        let (q, s) = (scalars.q(Q33::Corrected), scalars.s());
        let gamma = (law.a_top() - k_tilde).sqrt().recip();
        let solved = residual_13(&law, gamma, &q, &s) < ROUNDING;
        let yes = solved && q.iter().all(|q_i| *q_i > 0.0) && failing_pivot(&s).is_none();
        named += usize::from(holds);
        certified += usize::from(holds && yes);
        beyond += usize::from(!holds && yes);
    }
    Published {
        id: "theorem2-conditions",
        place: "Theorem 2, A1–A3",
        claim: "Under A1 to A3 the law of order 2 is optimal: Q ≻ 0, S ≻ 0",
        paper: "optimal under A1–A3",
    }
    .found(
        format!("{certified} of {named} random laws that meet A1–A3; {beyond} more without them"),
        Verdict::of(named > 0 && certified == named, false),
        format!(
            "{draws} laws at random, with the corrected Q_33. The conditions suffice and are not necessary."
        ),
        vec![
            number(
                "share of the laws that meet A1–A3 and are certified",
                "",
                certified as f64 / f64::max(named as f64, 1.0),
                0.0,
            ),
            number("share of all laws that are certified without A1–A3", "", beyond as f64 / draws as f64, 0.9),
        ],
    )
}

/// (22), B1, B2.
fn first_order(draws: usize) -> Result<Statement, PartError> {
    let mut draw = Draw::new(1);
    let (mut worst, mut named, mut certified): (f64, usize, usize) = (0.0, 0, 0);
    for _ in 0..draws {
        let law = draw.law(1);
        let k_tilde = law.a_top() * draw.between(0.05, 0.99);
        if !conditions(&law, k_tilde).iter().all(|c| c.left > c.right) {
            continue;
        }
        named += 1;
        let claim = Optimality::at(&law, k_tilde)?;
        let Some(c) = claim.certified() else { continue };
        certified += 1;
        worst = worst.max(residual_13(&law, c.gamma, &q22(k_tilde, law.kp, law.kd), &c.s));
    }
    Ok(Published {
        id: "theorem2-first-order",
        place: "(22), B1, B2",
        claim: "Q of (22) solves (13) at m = 1, under B1 and B2",
        paper: "Q = diag(K̃K_p², K̃(K_d² − 2K_p), K̃)",
    }
    .found(
        format!("residual at most {worst:.0e} on {certified} of {named} laws"),
        Verdict::of(worst < ROUNDING && certified == named && named > 0, false),
        "As printed.",
        vec![number("largest relative residual", "", worst, 1e4)],
    ))
}

/// m = 3 and 4.
fn every_order() -> Result<(Statement, Table), PartError> {
    let (mut rows, mut worst, mut all): (Vec<_>, f64, bool) = (Vec::new(), 0.0, true);
    for order in 1..=4 {
        let law = equal_rate(order, 69.6);
        let attenuation = Attenuation::of(&law)?;
        let k_tilde = attenuation.k_tilde();
        let claim = k_tilde.map(|k| Optimality::at(&law, k)).transpose();
        let claim = claim?;
        let Some(c) = claim.as_ref().and_then(Optimality::certified) else {
            all = false;
            continue;
        };
        let residual = residual_13(&law, c.gamma, &c.q, &c.s);
        let definite = failing_pivot(&c.s).is_none() && c.q.iter().all(|q_i| *q_i > 0.0);
        worst = worst.max(residual);
        all &= definite && residual < ROUNDING;
        rows.push(words(&[
            format!("{order}"),
            three(k_tilde),
            three(attenuation.gamma_diagonal),
            three(attenuation.gamma_return_difference),
            format!("{residual:.0e}"),
        ]));
    }
    let table = Table {
        id: "theorem-2-orders".to_owned(),
        title: "Certificates with every estimator pole at 69.6 rad/s: infimum of γ with a diagonal Q, and with any"
            .to_owned(),
        columns: words(&["m", "K̃ [1/s]", "γ, diagonal Q", "γ, any Q", "residual of (13) at K̃"]),
        rows,
    };
    let statement = Published {
        id: "theorem2-orders",
        place: "Before Theorem 2",
        claim: "The proof can be extended to any m, but there is no general procedure",
        paper: "no generalized procedure",
    }
    .found(
        format!("one procedure certifies m = 1 … 4, residual at most {worst:.0e}"),
        Verdict::of(false, all),
        "It can be extended, and there is a procedure: q_i is the coefficient of ω^{2(i−1)} in \
         (1/K̃)|D(jω)|²(|(jω)^m + K̃g(jω)|² − ω^{2m}), and S follows from the last row of (13) upwards. At m = 2 these \
         poles are H3.",
        vec![number("largest relative residual, m = 1 … 4", "", worst, 1e4)],
    );
    Ok((statement, table))
}

/// H3 with another `K_d`.
fn with(kd: f64) -> UnitLaw {
    UnitLaw { kd, ..second_h3() }
}

/// Least `K_d` at which H3 has a diagonal `Q ≻ 0` at this `K̃` \[1/s\].
fn least_kd(k_tilde: f64) -> f64 {
    let (mut low, mut high) = (1e-6, 40.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let positive = q_diagonal(&with(middle), k_tilde).iter().all(|q_i| *q_i > 0.0);
        if positive { high = middle } else { low = middle }
    }
    high
}

/// A2 is an artefact of the diagonal Q, and even there it is not necessary.
fn damping_is_not_necessary() -> Result<Statement, PartError> {
    let high = least_kd(K_TILDE_H3);
    // A3 asks for K̃ > 2b_0, γ > 0 for K̃ < a_1.
    let (b_0, a_1) = (second_h3().a[0] / second_h3().a_top(), second_h3().a_top());
    let grid = (1..2000).map(|k| 2.0 * b_0 + (a_1 - 2.0 * b_0) * f64::from(k) / 2000.0);
    let (any, at) = grid
        .map(|k_tilde| (least_kd(k_tilde), k_tilde))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .unwrap_or((f64::NAN, f64::NAN));
    let a2 = (2.0 * second_h3().kp).sqrt();
    let light = with(0.5);
    let stable = [second_h1(), second_h2(), second_h3(), second_h4()]
        .iter()
        .all(|law| polynomial::is_hurwitz(&UnitLaw { kd: 0.5, ..law.clone() }.denominator(1.0)));
    let gamma = Attenuation::of(&light)?.gamma_return_difference;
    Ok(Published {
        id: "theorem2-a2",
        place: "After Theorem 2",
        claim: "A2 is sufficient, not necessary, for stability",
        paper: "K_d² > 2K_p not necessary",
    }
    .found(
        format!(
            "A2: K_d > {}; K_d = 0.5: {} at H1, H2, H3 and H4; H3: diagonal Q ≻ 0 from K_d = {} at K̃ = 100, from \
             {any:.2} at K̃ = {at:.0}, and, at K_d = 0.5, γ = {} with another Q",
            three(a2.into()),
            if stable { "stable" } else { "not stable everywhere" },
            three(high.into()),
            three(gamma)
        ),
        Verdict::of(high < a2 && stable && gamma.is_some(), false),
        "At M = 1 the loop's polynomial is D(s)A_o(s), stable for every K_d > 0. Optimality for some Q ⪰ 0 asks for \
         |(jω)^m + K̃g|² ≥ ω^{2m}, in which K_p and K_d do not occur: H3 keeps it, H1 and H2 do not (Table 2 (C)).",
        vec![
            number("K_d by A2", "1/s", a2, 1e-9),
            number("least K_d with a diagonal Q, H3 at K̃ = 100", "1/s", high, 1e-6),
            number("least K_d with a diagonal Q, H3 at any K̃", "1/s", any, 1e-4),
            number("γ at K_d = 0.5, H3", "", gamma, 1e-6),
        ],
    )
    .assuming(&["gains"]))
}
