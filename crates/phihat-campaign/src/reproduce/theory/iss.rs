//! Theorem 3: input-to-state stability, and the sign of (39).

use phihat_design::claims::iss::decrease;
use phihat_design::claims::matrix::{apply, dot, failing_pivot, sum};
use phihat_design::claims::{Iss, Law, Optimality, polynomial};

use super::super::compose::{number, three, words};
use super::super::draw::Draw;
use super::super::gains::{K_TILDE_H3, second_h3};
use super::super::joint::{Form, Phi, length, outer, run};
use super::super::record::{Section, Statement, Verdict};
use super::super::said::Said;
use super::printed::{Q33, Scalars};

/// Theorem 3 and what belongs to it.
pub(super) fn theorem_3(draws: usize) -> Result<Section, String> {
    let law = second_h3();
    let claim = Optimality::at(&law, K_TILDE_H3).map_err(|e| e.to_string())?;
    let certified = claim.certified().ok_or("H3 has a certificate at K̃ = 100")?;
    let iss = Iss::of(&law, certified).map_err(|e| e.to_string())?;
    Ok(Section {
        id: "theorem-3".to_owned(),
        title: "Theorem 3: input-to-state stability".to_owned(),
        text: words(&[
            "Gains H3, V = ½xᵀSx with S of (18). The constants are large because |x| of the paper adds \
                       rad·s², rad·s, rad and rad/s.",
        ]),
        statements: vec![
            dissipation(&law, &iss, draws),
            trajectories(&law, &iss),
            derivative(&law, draws),
            alpha(&law),
            sign_of_39(&law),
        ],
        tables: Vec::new(),
        figures: Vec::new(),
    })
}

/// (27) at random states, V̇ from the state equation.
fn dissipation(law: &Law, iss: &Iss, draws: usize) -> Statement {
    let (a, mut draw) = (law.closed_loop(), Draw(3));
    let n = a.len();
    let mut broken = 0_usize;
    for _ in 0..draws {
        let x = draw.spread(n, 6.0);
        let phi = draw.spread(1, 4.0)[0] * 100.0;
        let mut rate = apply(&a, &x);
        rate[n - 1] -= phi;
        let sx = apply(&iss.s, &x);
        let size: f64 = sx.iter().zip(&rate).map(|(s, r)| (s * r).abs()).sum();
        let limit = -iss.gamma1 * dot(&x, &x) + iss.gamma2 * phi * phi;
        broken += usize::from(dot(&sx, &rate) > limit + 1e-9 * size);
    }
    Said {
        id: "theorem3-dissipation",
        place: "Theorem 3, (27), (30)",
        claim: "V = ½xᵀSx is an ISS-Lyapunov function",
        paper: "V̇ ≤ −γ₁(|x|) + γ₂(|φ|)",
    }
    .found(
        format!("broken at {broken} of {draws} random (x, φ)"),
        Verdict::of(broken == 0, false),
        format!(
            "γ₁ = {:.3e} |x|², γ₂ = {:.3e} φ², found by Cholesky and tried on the state equation.",
            iss.gamma1, iss.gamma2
        ),
        vec![
            number("γ₁", "", iss.gamma1, 1e-4),
            number("γ₂", "", iss.gamma2, 1e-4),
            number("states that break (27)", "", broken as f64, 0.0),
        ],
    )
    .assuming(&["gains"])
}

/// (24) along runs.
fn trajectories(law: &Law, iss: &Iss) -> Statement {
    let mut draw = Draw(4);
    let mut share: f64 = 0.0;
    for _ in 0..20 {
        let start = draw.spread(4, 4.0);
        let switched = (0..4000).scan(1.0, |sign: &mut f64, _| {
            *sign = if draw.between(0.0, 1.0) < 0.02 { -*sign } else { *sign };
            Some(*sign)
        });
        let phi = Phi::Joined(switched.collect());
        for now in run(law, Form::Ladder, &start, &phi, (5e-4, 4000)) {
            let bound = iss.beta(now.t) * length(&start) + iss.gain.upper;
            share = share.max(length(&now.x) / bound);
        }
    }
    Said {
        id: "theorem3-trajectories",
        place: "(24), (25)",
        claim: "|x(t)| ≤ β(|x(0)|, t) + gain · |φ|_∞",
        paper: "bounded",
    }
    .found(
        format!("{:.0} % of the bound at most, 20 runs with a switching φ", 100.0 * share),
        Verdict::of(share <= 1.0, false),
        format!(
            "β = {} e^{{−{}t}}|x(0)|, gain {}.",
            three(iss.overshoot.into()),
            three(iss.rate.into()),
            three(iss.gain.upper.into())
        ),
        vec![number("largest |x| as a share of the bound", "", share, 1e-3)],
    )
    .assuming(&["gains"])
}

/// (32): with the corrected `Q_33` it is an identity.
fn derivative(law: &Law, draws: usize) -> Statement {
    let mut draw = Draw(5);
    let scalars = Scalars::of(law, K_TILDE_H3);
    let (s, a) = (scalars.s(), law.a_matrix());
    let q = scalars.q(Q33::Corrected);
    let mut worst: f64 = 0.0;
    for _ in 0..draws {
        let x = draw.spread(4, 6.0);
        let sx = apply(&s, &x);
        let left = dot(&sx, &apply(&a, &x));
        // (32) has no term with x[1]: q_1 x_1² is missing.
        let terms = [
            K_TILDE_H3 * sx[3] * sx[3],
            -q[1] * x[1] * x[1],
            -q[2] * x[2] * x[2],
            -q[3] * x[3] * x[3],
        ];
        let first = -q[0] * x[0] * x[0];
        let size = terms.iter().fold(first.abs(), |most, term| most.max(term.abs()));
        worst = worst.max((2.0 * left - terms.iter().sum::<f64>() - first).abs() / size);
    }
    let missing = q[0];
    Said {
        id: "erratum-32",
        place: "(32), (34)",
        claim: "xᵀ(AᵀS + SA)x is the sum that is printed",
        paper: "terms in x[2], x[3], x[4]",
    }
    .found(
        format!("off by K̃b_0²K_p² x[1]² = {missing:.2e} x[1]²; with that term {worst:.0e}"),
        Verdict::of(missing.abs() < 1e-12, worst < 1e-8),
        "(32) and (34) leave out the first entry of Q. It is positive, so the conclusion stands.",
        vec![number("coefficient of x[1]² left out", "", missing, 1e-9)],
    )
}

/// α > ½.
fn alpha(law: &Law) -> Statement {
    let s = Scalars::of(law, K_TILDE_H3).s();
    let b = law.g();
    let decreasing = |alpha: f64| {
        let scaled = Law { a: b.iter().map(|b| b * alpha * K_TILDE_H3).collect(), ..law.clone() };
        failing_pivot(&decrease(&scaled, &s)).is_none()
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if decreasing(middle) { high = middle } else { low = middle }
    }
    let above = (0..=50).all(|k| decreasing(0.5 + 1e-6 + f64::from(k) * 0.05));
    Said {
        id: "theorem3-alpha",
        place: "Theorem 3, (29)",
        claim: "α > ½ suffices, with any ρ",
        paper: "α > 1/2",
    }
    .found(
        format!("V̇ < 0 at φ = 0 for α from {} on, γ → ∞", three(high.into())),
        Verdict::of(above && high <= 0.5 + 1e-9, false),
        "−V̇ = ½xᵀ(Q + (2α − 1)K̃ SBBᵀS)x at φ = 0: above ½ both terms help. Q leaves a little room below it.",
        vec![number("least α with V̇ < 0", "", high, 1e-4)],
    )
}

/// (39) lacks a minus.
fn sign_of_39(law: &Law) -> Statement {
    let n = law.order() + 2;
    let unit: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i + 1 == n))).collect();
    let feedback = outer(&unit, &law.k());
    let stable = |sign: f64| {
        // The last row of A ± BK is the characteristic polynomial, with a minus.
        let a = sum(&law.a_matrix(), sign, &feedback);
        let polynomial: Vec<f64> = a[n - 1].iter().map(|v| -v).chain([1.0]).collect();
        polynomial::is_hurwitz(&polynomial)
    };
    let (printed, corrected) = (stable(1.0), stable(-1.0));
    let word = |stable: bool| if stable { "stable" } else { "unstable" };
    Said {
        id: "erratum-39",
        place: "(39)",
        claim: "φ̂ = (K̃ + I/γ²)x_Δ",
        paper: "φ̂ = +(K̃ + I/γ²)x_Δ",
    }
    .found(
        format!("with plus {}, with minus {}", word(printed), word(corrected)),
        Verdict::of(printed, corrected),
        "The minus of (29) and (36) is missing.",
        vec![number("stable as printed", "", f64::from(u8::from(printed)), 0.0)],
    )
}
