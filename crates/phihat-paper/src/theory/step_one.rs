//! Step 1 of the recipe: gains from (40).

use phihat_design::claims::iss::decrease;
use phihat_design::claims::matrix::{apply, identity, largest_shift};
use phihat_design::claims::{Optimality, UnitLaw};
use phihat_design::prelude::*;

use crate::compose::{number, three};
use crate::gains::PHI_MAX;
use crate::joint::{flow, largest};
use crate::part::PartError;
use crate::published::Published;
use crate::record::{Statement, Verdict};

/// (48).
const X_MAX: [f64; 3] = [1e-3, 1e-2, 1e-1];

/// `K̃` as a share of `a_0`: γ large.
const SHARE: f64 = 0.999;

/// The least `K̃` at which every entry of (40) is within (48), for a `K_p` and `K_d`: (40) is inverse to it.
fn least(kp: f64, kd: f64) -> Option<f64> {
    let law = UnitLaw { kp, kd, a: vec![SHARE.recip()] };
    let claim = Optimality::at(&law, 1.0).ok()?;
    let s = &claim.certified()?.s;
    let w_min = largest_shift(&decrease(&law, s), &identity(3))?;
    let entries = (0..3).map(|i| 2.0 * s[i][2] * PHI_MAX / X_MAX[i]);
    Some(entries.fold(0.0, f64::max) / w_min)
}

/// L1 norms of `1/D`, `s/D` and `s²/D` by quadrature. At m = 1, `1/(s + a_0)` of L1 norm `1/a_0` is between φ
/// and each of them for `∫e`, `e` and `ė`, so that the errors are at most these over `a_0`, times φ_max.
fn outer(kp: f64, kd: f64) -> [f64; 3] {
    let steps = 40_000;
    let dt = 40.0 * kd / kp / f64::from(steps);
    let step = flow(&vec![vec![0.0, 1.0], vec![-kp, -kd]], dt);
    let mut state = vec![0.0, 1.0];
    // s²/D begins with an impulse of one.
    let mut norms = [0.0, 0.0, 1.0];
    for _ in 0..steps {
        let next = apply(&step, &state);
        let [h, dh] = [0, 1].map(|i| 0.5 * (state[i] + next[i]));
        for (norm, size) in norms.iter_mut().zip([h, dh, kd * dh + kp * h]) {
            *norm += size.abs() * dt;
        }
        state = next;
    }
    norms
}

/// "Find the minimum values for the control parameters using (40)."
pub(super) fn step_one() -> Result<Statement, PartError> {
    let grid = |low: f64, high: f64, k: i32| low * (high / low).powf(f64::from(k) / 40.0);
    let all = (0..=40).flat_map(|i| (0..=40).map(move |j| (i, j)));
    let all = all.filter_map(|(i, j)| {
        let (kp, kd) = (grid(0.1, 1e3, i), grid(0.3, 1e2, j));
        Some((kp, kd, least(kp, kd)?))
    });
    let found = all.min_by(|a, b| a.2.total_cmp(&b.2));
    let (kp, kd, k_tilde) = found.ok_or(PartError::Missing("gains with B1 and B2"))?;
    let a0 = k_tilde / SHARE;
    let worst = largest(outer(kp, kd).iter().zip(X_MAX).map(|(gain, x)| gain / a0 * PHI_MAX / x));
    Ok(Published {
        id: "step1-by-40",
        place: "Sec. VII, step 1",
        claim: "(40) gives minimum gains that keep the errors within the limits",
        paper: "minimum values using (40)",
    }
    .found(
        format!(
            "(48), φ_max = {PHI_MAX}: the least K̃ by (40) is {}, at K_p = {}, K_d = {}; any φ then keeps the errors \
             within {:.0} % of their limits. Used: K̃ = 68.9, a_0 = 69.6",
            three(Some(k_tilde)),
            three(Some(kp)),
            three(Some(kd)),
            100.0 * worst
        ),
        Verdict::of(worst <= 1.0, false),
        "There are such gains, and they keep the limits. The least a_0 is hundreds of times what was used, far above \
         the sample rate of 1 kHz. (44), from which Table 2 (A) comes, asks for far less.",
        vec![
            number("least K̃ by (40)", "1/s", k_tilde, 1e-3),
            number("worst error as a share of its limit", "", worst, 1e-3),
        ],
    )
    .read_as("(40) entry by entry against (48), γ large, the gains with the least K̃ on a grid of K_p and K_d")
    .varying("K_p of 0.1 to 1000, K_d of 0.3 to 100")
    .turning("a worst error at 100 % of its limit (then refuted)")
    .assuming(&["phi-max"]))
}
