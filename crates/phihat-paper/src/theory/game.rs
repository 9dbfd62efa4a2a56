//! Theorem 4: the value of the game, its saddle point, and the worst disturbance found without S.

use phihat_design::claims::matrix::{RationalMatrix, apply, dot, product, sum, transpose};
use phihat_design::claims::{Certified, Optimality, UnitLaw};
use phihat_design::prelude::*;

use super::printed::{Q33, Scalars, residual_13};
use crate::compose::{number, three, words};
use crate::gains::{K_TILDE_H3, all, second_h3};
use crate::joint::{flow, length, outer, zeros};
use crate::part::PartError;
use crate::published::Published;
use crate::record::{Section, Statement, Verdict};

/// A step that resolves the estimator \[s\].
const STEP: f64 = 1e-3;

/// The optimality of Theorem 4, at H3.
pub(super) fn theorem_4() -> Result<Section, PartError> {
    let law = second_h3();
    let claim = Optimality::at(&law, K_TILDE_H3)?;
    let c = claim.certified().ok_or(PartError::Missing("H3 has a certificate at K̃ = 100"))?;
    Ok(Section {
        id: "theorem-4".to_owned(),
        title: "Theorem 4: the law is one side of a game".to_owned(),
        text: words(&[
            "J = ∫(xᵀQx + φ̂ᵀRφ̂ − γ²dᵀd), d = −φ, at the gains H3: H1 and H2 have no Q ≻ 0, and so no such game. Both \
                       players use linear feedback, and J is found from the exact flow of the loop, without S: ∫₀^∞ \
                       e^{Aᵀt} W e^{At} dt by doubling.",
        ]),
        statements: vec![condition(), worst_case(&law, c), saddle(&law, c)],
        tables: Vec::new(),
        figures: Vec::new(),
    })
}

/// `ρ⁻¹(|x|)/|x_Δ| = 1/γ²` for all x, with a ρ of class K∞.
fn condition() -> Statement {
    let spread = |law: &UnitLaw| {
        let row: Vec<f64> = law.k().iter().map(|k| k / law.a_top()).collect();
        let n = row.len();
        let x_delta = |x: &[f64]| (dot(&row, x) / length(x)).abs();
        // Across the row in its last two entries, and along it.
        let mut across = vec![0.0; n];
        (across[n - 2], across[n - 1]) = (row[n - 1], -row[n - 2]);
        (x_delta(&across), x_delta(&row))
    };
    let all = all().map(|(name, law)| (name, spread(&law)));
    let possible = all.iter().all(|(_, (low, high))| low / high > 1.0 - 1e-9);
    // In (13) the factor is the constant, and nothing is left over.
    let h3 = second_h3();
    let scalars = Scalars::of(&h3, K_TILDE_H3);
    let gamma = (h3.a_top() - K_TILDE_H3).sqrt().recip();
    let rest = residual_13(&h3, gamma, &scalars.q(Q33::Corrected), &scalars.s());
    let listed = all.iter().map(|(name, (low, high))| {
        format!("{name}: {} … {}", three((*low).into()), three((*high).into()))
    });
    Published {
        id: "theorem4-condition",
        place: "Theorem 4",
        claim: "The law is optimal if ρ⁻¹(|x|)/|x_Δ| = 1/γ², ρ ∈ K∞",
        paper: "ρ⁻¹(|x|)/|x_Δ| = 1/γ²",
    }
    .found(
        format!("|x_Δ| at |x| = 1: {}", listed.collect::<Vec<_>>().join("; ")),
        Verdict::of(possible, rest < 1e-9),
        format!(
            "No ρ of class K∞ can meet the condition: ρ⁻¹(1) would have to be |x_Δ|/γ² for every x of length 1, and \
             that is anything from 0, where x_Δ = 0, to |SB|/γ². Only where x = 0 may ρ⁻¹(|x|) vanish. What is true: \
             with the constant 1/γ² in place of ρ⁻¹(|x|)/|x_Δ|, the law solves (13) (H3: to {rest:.0e}). It is then no \
             longer a law of Theorem 3, and its ISS comes from (27)."
        ),
        all.iter().map(|(name, (_, high))| number(&format!("largest |x_Δ| at |x| = 1, \
            {name}"), "", *high, 1e-9)).collect(),
    )
    .assuming(&["gains"])
}

/// The disturbance that costs most, from a Riccati differential equation that starts at zero.
fn worst_case(law: &UnitLaw, c: &Certified) -> Statement {
    let n = law.order() + 2;
    let p = stationary(law, c);
    let entry = |i: usize, j: usize| (p[i][j] - c.s[i][j]).abs() / (c.s[i][i] * c.s[j][j]).sqrt();
    let apart = (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).map(|(i, j)| entry(i, j));
    let apart = apart.fold(0.0, f64::max);
    let found: Vec<String> =
        (0..n).map(|i| three((p[i][n - 1] / (c.gamma * c.gamma)).into())).collect();
    Published {
        id: "theorem4-worst-case",
        place: "Theorem 4",
        claim: "d = γ⁻²BᵀSx is the worst disturbance",
        paper: "d = γ⁻²BᵀSx",
    }
    .found(
        format!("H3: d = ({}) x found; its matrix is S to {apart:.0e}", found.join(", ")),
        Verdict::of(apart < 1e-6, false),
        "With the law fixed, the largest J over all disturbances of length T is x₀ᵀP(T)x₀, \
         Ṗ = (A−BK)ᵀP + P(A−BK) + Q + KᵀRK + γ⁻²PBBᵀP, P(0) = 0, integrated until it stands still. S is not in it.",
        vec![number("largest difference between P and S, relative", "", apart, 1e3)],
    )
    .assuming(&["gains"])
}

/// `P(∞)` by classical Runge–Kutta, in coordinates in which all states weigh the same.
fn stationary(law: &UnitLaw, c: &Certified) -> RationalMatrix {
    let n = law.order() + 2;
    let sigma = law.denominator(1.0)[0].powf(1.0 / n as f64);
    let mut unit = vec![1.0; n];
    for i in 1..n {
        unit[i] = unit[i - 1] * sigma;
    }
    // x_i = unit_i z_i: the last entry of B becomes 1/unit_{n−1}.
    let closed = law.closed_loop();
    let a: RationalMatrix =
        (0..n).map(|i| (0..n).map(|j| closed[i][j] * unit[j] / unit[i]).collect()).collect();
    let k: Vec<f64> = law.k().iter().zip(&unit).map(|(k, u)| k * u).collect();
    let mut weight = outer(&k, &k);
    for (i, row) in weight.iter_mut().enumerate() {
        for v in row.iter_mut() {
            *v /= law.a_top();
        }
        row[i] += c.q[i] * unit[i] * unit[i];
    }
    let game = (c.gamma * unit[n - 1]).powi(-2);
    let rate = |p: &RationalMatrix| {
        let pa = product(p, &a);
        let last: Vec<f64> = p.iter().map(|row| row[n - 1]).collect();
        let linear = sum(&sum(&pa, 1.0, &transpose(&pa)), 1.0, &weight);
        sum(&linear, game, &outer(&last, &last))
    };
    let (mut p, h) = (zeros(n, n), 2e-4);
    for _ in 0..15_000 {
        let k1 = rate(&p);
        let k2 = rate(&sum(&p, 0.5 * h, &k1));
        let k3 = rate(&sum(&p, 0.5 * h, &k2));
        let k4 = rate(&sum(&p, h, &k3));
        for (k, f) in [(k1, 1.0), (k2, 2.0), (k3, 2.0), (k4, 1.0)] {
            p = sum(&p, f * h / 6.0, &k);
        }
    }
    (0..n).map(|i| (0..n).map(|j| p[i][j] / (unit[i] * unit[j])).collect()).collect()
}

/// `J` for `φ̂ = −kx`, `d = wx` from `x₀`, and whether the loop is stable.
fn cost(law: &UnitLaw, c: &Certified, k: &[f64], w: &[f64], start: &[f64]) -> f64 {
    let n = k.len();
    let mut a = law.a_matrix();
    for j in 0..n {
        a[n - 1][j] += w[j] - k[j];
    }
    let mut weight = sum(&zeros(n, n), 1.0 / law.a_top(), &outer(k, k));
    weight = sum(&weight, -c.gamma * c.gamma, &outer(w, w));
    for (i, row) in weight.iter_mut().enumerate() {
        row[i] += c.q[i];
    }
    // ∫₀^h by Gauss–Legendre with three points, then X(2h) = X(h) + e^{Aᵀh} X(h) e^{Ah}.
    let root = 0.6_f64.sqrt();
    let mut total = zeros(n, n);
    for (at, share) in [(0.5 * (1.0 - root), 5.0), (0.5, 8.0), (0.5 * (1.0 + root), 5.0)] {
        let e = flow(&a, at * STEP);
        let term = product(&transpose(&e), &product(&weight, &e));
        total = sum(&total, share / 18.0 * STEP, &term);
    }
    let mut e = flow(&a, STEP);
    for _ in 0..14 {
        total = sum(&total, 1.0, &product(&transpose(&e), &product(&total, &e)));
        e = product(&e, &e);
    }
    dot(start, &apply(&total, start))
}

/// `J(u*, d) ≤ J(u*, d*) = x₀ᵀSx₀ ≤ J(u, d*)`.
fn saddle(law: &UnitLaw, c: &Certified) -> Statement {
    let start = [0.0, 0.0, 0.1, 0.5];
    let value = dot(&start, &apply(&c.s, &start));
    let (k, w) = (law.k(), c.worst.clone());
    let at = |f: f64, g: f64| {
        let scaled = |v: &[f64], f: f64| v.iter().map(|v| f * v).collect::<Vec<_>>();
        cost(law, c, &scaled(&k, f), &scaled(&w, g), &start)
    };
    let played = at(1.0, 1.0);
    let off = (played / value - 1.0).abs();
    let less = [0.0, 0.5, 0.9, 1.1, 1.5].map(|g| at(1.0, g));
    let more = [0.8, 0.9, 1.1, 1.3].map(|f| at(f, 1.0));
    let saddle = less.iter().all(|j| *j < played) && more.iter().all(|j| *j > played);
    Published {
        id: "theorem4-value",
        place: "Theorem 4, last lines of its proof",
        claim: "φ̂ = −R⁻¹BᵀSx is optimal; the cost is set by V(x(0))",
        paper: "J = −2V(x(0)) − …",
    }
    .found(
        format!(
            "H3: J(u*, d*) = {} = +2V(x(0)) to {off:.0e}; every other d costs less, every other u more",
            three(played.into())
        ),
        Verdict::of((played + value).abs() < 1e-6 * value && saddle, off < 1e-6 && saddle),
        "A saddle point, where there is a certificate. The signs of the last lines are not right as our copy of the \
         paper has them: −∫ 2V̇ is +2V(x(0)), and (u + R⁻¹BᵀSx)ᵀR(u + R⁻¹BᵀSx) enters with a plus, as one line above.",
        vec![
            number("J(u*, d*)", "", played, 1e-6),
            number("2V(x(0))", "", value, 1e-9),
            number("J(u*, 0)", "", less[0], 1e-6),
        ],
    )
    .assuming(&["gains"])
}
