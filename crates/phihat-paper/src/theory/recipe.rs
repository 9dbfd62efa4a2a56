//! Secs. V-A, V-B and VII: how gains are found, and what they are said to do.

use core::f64::consts::TAU;

use phihat_design::claims::iss::decrease;
use phihat_design::claims::matrix::failing_pivot;
use phihat_design::claims::paper::Feedback;
use phihat_design::claims::{ErrorLimits, MinimalGains, Optimality, UnitLaw};
use phihat_design::prelude::*;

use crate::compose::{number, three, words};
use crate::gains::{K_TILDE, K_TILDE_H3, PHI_MAX, all, equal_rate, first, second_h3};
use crate::joint::{PaperForm, PhiCourse, largest, run};
use crate::part::PartError;
use crate::published::Published;
use crate::record::{Section, Statement, Verdict};

/// One turn of Fig. 4 \[rad/s\].
const TURN: f64 = TAU / 6.17;

/// The recipe of Secs. V and VII.
pub(super) fn recipe() -> Result<Section, PartError> {
    Ok(Section {
        id: "recipe".to_owned(),
        title: "Secs. V-A, V-B, VII: the recipe".to_owned(),
        text: words(&[
            "What is said around Table 2; the table itself is looked at below. Newton's method solves every row of \
             (44) as an equality, at φ_max = 22.2 and the limits (48) and (49).",
        ]),
        statements: vec![
            term(),
            analytical()?,
            without_term()?,
            third_order(),
            taylor(),
            step_three(),
        ],
        tables: Vec::new(),
        figures: Vec::new(),
    })
}

/// The term that is left out.
fn term() -> Statement {
    let falls = |law: &UnitLaw, k_tilde: f64, share: f64| {
        let Ok(Optimality::Certified(c)) = Optimality::at(law, k_tilde) else { return false };
        let scaled =
            UnitLaw { a: law.g().iter().map(|b| b * share * k_tilde).collect(), ..law.clone() };
        failing_pivot(&decrease(&scaled, &c.s)).is_none()
    };
    let shares = [0.501, 0.75, 1.0, 2.0];
    let laws = [(first(), K_TILDE), (second_h3(), K_TILDE_H3)];
    let count = laws.iter().flat_map(|(law, k)| shares.map(|share| falls(law, *k, share)));
    let count = count.filter(|falls| *falls).count();
    let cases = laws.len() * shares.len();
    Published {
        id: "term-ignored",
        place: "Sec. V-A",
        claim: "V̇ < 0 if a_{m−1} > K̃/2, so that the term (2a_{m−1} − K̃)xᵀSBBᵀSx may be left out",
        paper: "a_{m−1} > K̃/2",
    }
    .found(
        format!("at φ = 0, V̇ < 0 in {count} of {cases} cases: a_{{m−1}}/K̃ = 0.501, 0.75, 1, 2 at m = 1 and H3"),
        Verdict::of(count == cases, false),
        "Read for φ = 0, and where there is a certificate: it is α > ½ of Theorem 3. With φ, V̇ can be positive near x \
         = 0; the term is then not negative, and leaving it out asks for larger gains, not smaller ones.",
        vec![number("cases with V̇ < 0", "", count as f64, 0.0)],
    )
    .assuming(&["gains"])
    .again()
}

/// (44) with the term, m = 1, in closed form.
fn closed_form(limits: &ErrorLimits) -> Option<[f64; 3]> {
    let [integral, e, de] = limits.x_max[..] else { return None };
    let (kp, slope) = (de / integral, de / e);
    let kd = 0.5 * (slope + (slope * slope + 8.0 * kp).sqrt());
    Some([2.0 * limits.phi_max / (2.0 * de + kp * integral + kd * e), kp, kd])
}

/// "However, there is no analytical solution in that case."
fn analytical() -> Result<Statement, PartError> {
    let mut off: f64 = 0.0;
    let mut paper = [f64::NAN; 3];
    for (phi_max, x_max) in
        [(PHI_MAX, [1e-3, 1e-2, 1e-1]), (5.0, [2e-3, 1e-2, 3e-1]), (80.0, [1e-4, 2e-3, 1e-1])]
    {
        let limits = ErrorLimits { phi_max, x_max: x_max.to_vec() };
        let newton = MinimalGains::newton(&limits, Feedback::Included)?;
        let closed = closed_form(&limits).ok_or(PartError::Missing("three limits"))?;
        let pairs = closed.iter().zip([newton.k_tilde, newton.kp, newton.kd]);
        off = off.max(largest(pairs.map(|(c, n)| c / n - 1.0)));
        if paper[0].is_nan() {
            paper = closed;
        }
    }
    let [k_tilde, kp, kd] = paper;
    Ok(Published {
        id: "analytical-first",
        place: "Sec. V-A, m = 1",
        claim: "With xᵀSBBᵀSx included there is no analytical solution",
        paper: "no analytical solution",
    }
    .found(
        format!(
            "K_p = ė/∫e, K_d − 2K_p/K_d = ė/e, K̃ = 2φ_max/(2ė + K_p∫e + K_de) at the limits: {}, {}, {} with (48); \
                Newton agrees to {off:.0e}",
            three(k_tilde.into()),
            three(kp.into()),
            three(kd.into())
        ),
        Verdict::of(off > 1e-3, false),
        "There is one. Divided by (SB)_i, all rows hold the same φ_max and the same term: two differences give K_p and \
         K_d, and a row is then linear in K̃ (here with γ → ∞). For m ≥ 2 the rows are polynomials of higher degree in \
         b_0 and K_d; whether they have an analytical solution is not decided here.",
        vec![
            number("K̃ in closed form, (48)", "1/s", k_tilde, 1e-9),
            number("largest relative difference to Newton's method", "", off, 1e6),
        ],
    )
    .assuming(&["phi-max"]))
}

/// "Will still provide us with the optimal values."
fn without_term() -> Result<Statement, PartError> {
    let (mut listed, mut numbers, mut holds) = (Vec::new(), Vec::new(), true);
    for x_max in [vec![1e-3, 1e-2, 1e-1], vec![1e-4, 1e-3, 1e-2, 1e-1]] {
        let limits = ErrorLimits { phi_max: PHI_MAX, x_max };
        let newton = |feedback| MinimalGains::newton(&limits, feedback);
        let (ignored, included) = (newton(Feedback::Ignored)?, newton(Feedback::Included)?);
        let raised = |found: &MinimalGains| {
            let law = found.law();
            UnitLaw { a: law.a.iter().map(|a| 1.05 * a).collect(), ..law }
        };
        let optimal = |found: &MinimalGains| {
            let claim = Optimality::at(&raised(found), found.k_tilde);
            claim.is_ok_and(|claim| claim.certified().is_some())
        };
        let order = limits.x_max.len() - 2;
        holds &= optimal(&ignored) && included.k_tilde < ignored.k_tilde;
        listed.push(format!(
            "m = {order}: K̃ = {} without the term, {}; {} with it",
            three(ignored.k_tilde.into()),
            if optimal(&ignored) { "certified" } else { "refused" },
            three(included.k_tilde.into())
        ));
        numbers.push(number(
            &format!("K̃ without the term, m = {order}"),
            "1/s",
            ignored.k_tilde,
            1e-6,
        ));
        numbers.push(number(
            &format!("K̃ with the term, m = {order}"),
            "1/s",
            included.k_tilde,
            1e-6,
        ));
    }
    Ok(Published {
        id: "optimal-without-term",
        place: "Sec. VII",
        claim: "Gains found without xᵀSBBᵀSx are still optimal; the least ones need it",
        paper: "still the optimal values",
    }
    .found(
        listed.join("; "),
        Verdict::of(holds, false),
        "A row of (44) without the term can only be met with Q_ii > 0, so that gains from it are H-infinity optimal \
         for that Q. That is true of gains from (44), and not of the printed column (A) of m = 2, which has b_0 = 0.",
        numbers,
    )
    .assuming(&["phi-max"]))
}

/// Time after which `|φ̃|` stays below a hundredth of a constant φ \[s\].
fn settles(law: &UnitLaw) -> f64 {
    let rows = run(law, PaperForm::Estimator, &[], &PhiCourse::polynomial(&[1.0]), (1e-4, 20_000));
    rows.iter().rev().find(|x| (x.phi_hat - x.phi).abs() > 1e-2).map_or(0.0, |x| x.t)
}

/// Largest mismatch that remains with a sine of one turn.
fn left_of_turn(law: &UnitLaw) -> f64 {
    let rows =
        run(law, PaperForm::Estimator, &[], &PhiCourse::sines(&[(1.0, TURN, 0.0)]), (1e-3, 12_000));
    largest(rows.iter().skip(5800).map(|x| x.phi_hat - x.phi))
}

/// "The convergence will be faster."
fn third_order() -> Statement {
    let laws = [1, 2, 3].map(|order| equal_rate(order, 20.0));
    let (time, left) = (laws.clone().map(|law| settles(&law)), laws.map(|law| left_of_turn(&law)));
    let say = |values: [f64; 3]| values.map(|v| three(v.into())).join(", ");
    Published {
        id: "third-order-faster",
        place: "Sec. V-B",
        claim: "A third order converges faster than a second",
        paper: "the convergence will be faster",
    }
    .found(
        format!(
            "m = 1, 2, 3, every pole at 20 rad/s: a constant φ is found to 1 % after {} s; of a sine of 6.17 s {} is \
                left",
            say(time),
            say(left)
        ),
        Verdict::of(time[2] < time[1], left[2] < left[1]),
        "At the same poles a higher order takes longer and then leaves less of a φ that moves: smaller, not faster.",
        (1..).zip(time).map(|(m, t)| number(&format!("time to 1 %, m = {m}"), "s", t, 1e-2))
            .chain((1..).zip(left).map(|(m, v)| number(&format!("left of the sine, m = {m}"), "", v, 1e-3)))
            .collect(),
    )
}

/// "(46) can be satisfied if the gains a_i are high enough to converge during the time h."
fn taylor() -> Statement {
    let rates = [20.0, 69.6, 200.0];
    let rest = rates.map(|rate| {
        let h = settles(&equal_rate(2, rate));
        let off = |t: f64| (TURN * (t + h)).sin() - (TURN * t).sin() - TURN * h * (TURN * t).cos();
        (h, largest((0..617).map(|k| off(f64::from(k) * 0.01))))
    });
    let falls = rest.windows(2).all(|w| w[1].1 < w[0].1);
    Published {
        id: "eq46-gains",
        place: "(46), Sec. V-B",
        claim: "(46) is met when the a_i are high enough to converge within h",
        paper: "high enough",
    }
    .found(
        format!(
            "m = 2, poles at 20, 69.6, 200 rad/s: converged to 1 % after h = {} s, in which a sine of 6.17 s leaves \
             its tangent by {} of its size",
            rest.map(|(h, _)| three(h.into())).join(", "),
            rest.map(|(_, off)| three(off.into())).join(", ")
        ),
        Verdict::of(falls && rest[2].1 < 1e-2, false),
        "The rest of (46) is h²|φ̈|/2 at most, and h falls as 1/a_1. What (47) leaves out is −φ̈ on its right-hand \
         side: small, and why φ̃ does not vanish (Theorem 1).",
        rates.iter().zip(rest).map(|(rate, (_, off))| number(&format!("rest of (46), poles at {rate} \
            rad/s"), "", off, 2e-2)).collect(),
    )
}

/// "Take a_i such that the gain of (47) is 3–5 times higher than (4)."
fn step_three() -> Statement {
    let ratio = |law: &UnitLaw| law.a[0].powf(1.0 / law.order() as f64) / law.kp.sqrt();
    let found = all().map(|(name, law)| (name, ratio(&law)));
    let listed = found.iter().map(|(name, ratio)| format!("{name}: {}", three((*ratio).into())));
    Published {
        id: "step3-gain",
        place: "Sec. VII, step 3",
        claim: "Read as natural frequencies, (47) is 3 to 5 times as fast as (4) with the gains that are used here",
        paper: "gain 3–5 times higher",
    }
    .found(
        listed.collect::<Vec<_>>().join("; "),
        Verdict::assumed(found.iter().all(|(_, ratio)| (3.0..=5.0).contains(ratio)), false),
        "The paper does not say what the gain of (47) is. As a_0^{1/m}/√K_p the recipe agrees with m = 1, H1, H2 and \
         H3, and not with H4; as a_0/K_p it agrees with none of them.",
        found.iter().map(|(name, ratio)| number(&format!("a_0^(1/m)/√K_p, {name}"), "", *ratio, 1e-9)).collect(),
    )
    .assuming(&["gains"])
    .ours()
}
