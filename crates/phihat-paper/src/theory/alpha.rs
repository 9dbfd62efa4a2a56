//! Theorem 3: what α > ½ is enough for, with φ and with ρ.

use phihat_design::claims::UnitLaw;
use phihat_design::claims::iss::decrease;
use phihat_design::claims::matrix::{RationalMatrix, apply, dot, failing_pivot};

use super::printed::Scalars;
use crate::compose::{number, three};
use crate::draw::Draw;
use crate::gains::K_TILDE_H3;
use crate::joint::length;
use crate::published::Published;
use crate::record::{Statement, Verdict};

/// `ρ⁻¹` of three kinds, `f r^p`: name, f, p.
const RHO: [(&str, f64, f64); 3] = [("r", 1.0, 1.0), ("√r", 1.0, 0.5), ("1000 r³", 1e3, 3.0)];

/// Of random (x, ρ), at how many `V̇ > 0` under (29) with `|φ|` a multiple of `ρ⁻¹(|x|)`, of the worse sign. One times
/// is `|x| = ρ(|φ|)`, the edge of (28).
fn rises(law: &UnitLaw, s: &RationalMatrix, gain: f64, (draws, times): (usize, f64)) -> usize {
    let (a, mut draw) = (law.a_matrix(), Draw::new(12));
    let n = a.len();
    let mut rises = 0;
    for k in 0..draws {
        let x = draw.spread(n, 5.0);
        let sx = apply(s, &x);
        let (_, factor, power) = RHO[k % RHO.len()];
        let (x_delta, push) = (sx[n - 1], factor * length(&x).powf(power));
        let phi_hat = -(gain + push / x_delta.abs()) * x_delta;
        let phi = -times * push * x_delta.signum();
        let mut rate = apply(&a, &x);
        rate[n - 1] += phi_hat - phi;
        let size: f64 = sx.iter().zip(&rate).map(|(s, r)| (s * r).abs()).sum();
        rises += usize::from(dot(&sx, &rate) > 1e-9 * size);
    }
    rises
}

/// α > ½.
pub(super) fn alpha(law: &UnitLaw, draws: usize) -> Statement {
    let s = Scalars::of(law, K_TILDE_H3).s();
    let b = law.g();
    let decreasing = |alpha: f64| {
        let scaled =
            UnitLaw { a: b.iter().map(|b| b * alpha * K_TILDE_H3).collect(), ..law.clone() };
        failing_pivot(&decrease(&scaled, &s)).is_none()
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if decreasing(middle) { high = middle } else { low = middle }
    }
    let above = (0..=50).all(|k| decreasing(0.5 + 1e-6 + f64::from(k) * 0.05));
    let both = |times| -> usize {
        [0.501, 1.0].iter().map(|alpha| rises(law, &s, alpha * K_TILDE_H3, (draws, times))).sum()
    };
    let (broken, beyond) = (both(1.0), both(100.0));
    let names = RHO.map(|(name, ..)| name).join(", ");
    Published {
        id: "theorem3-alpha",
        place: "Theorem 3, (29)",
        claim: "Under A1 to A3, α > ½ suffices, with any ρ",
        paper: "α > 1/2, ρ ∈ K∞",
    }
    .found(
        format!(
            "H3: V̇ < 0 at φ = 0 for α from {} on; at |φ| = ρ⁻¹(|x|) of the worse sign, V̇ > 0 at {broken} of {} \
             random x for α = 0.501 and 1 and ρ⁻¹(r) = {names} (at 100 times that |φ|: {beyond})",
            three(high.into()),
            2 * draws
        ),
        Verdict::of(above && high <= 0.5 + 1e-9 && broken == 0 && beyond > 0, false),
        "−V̇ = ½xᵀ(Q + (2α − 1)K̃ SBBᵀS)x + |x_Δ|ρ⁻¹(|x|) + x_Δφ, and the last two terms are not negative together as \
         long as |φ| ≤ ρ⁻¹(|x|), whatever ρ is: above ½ everything helps. Q leaves a little room below it. The \
         feedback (29) itself jumps where x_Δ changes sign, unless ρ⁻¹(|x|)/|x_Δ| is replaced by a constant.",
        vec![
            number("least α with V̇ < 0 at φ = 0", "", high, 1e-4),
            number("states with V̇ > 0 under the worse φ", "", broken as f64, 0.0),
        ],
    )
    .assuming(&["gains"])
}
