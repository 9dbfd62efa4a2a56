//! The ball of (40), as printed and as its proof gives it.

use phihat_design::claims::matrix::{apply, dot};
use phihat_design::claims::{Iss, Optimality, PaperRadius, PeakGains, UnitLaw};
use phihat_design::prelude::*;

use super::bounds::{Paper, TheoryBounds};
use crate::compose::{number, three};
use crate::draw::Draw;
use crate::gains::PHI_MAX;
use crate::joint::{flow, length};
use crate::part::PartError;
use crate::published::Published;
use crate::record::{Statement, Verdict};

/// At how many random laws of order 1 with a certificate the worst φ drives an entry of x beyond (40), and of how many.
fn beyond_40() -> Result<(usize, usize), PartError> {
    let mut draw = Draw::new(40);
    let (mut beyond, mut seen) = (0, 0);
    for _ in 0..100 {
        let law = draw.law(1);
        let claim = Optimality::at(&law, 0.9 * law.a_top())?;
        let Some(certified) = claim.certified() else { continue };
        let radius = PaperRadius::of(&Iss::of(&law, certified)?).printed;
        let peaks = PeakGains::of(&law, 1.0)?;
        seen += 1;
        beyond += usize::from(peaks.states.iter().any(|gain| gain.lower > radius));
    }
    Ok((beyond, seen))
}

/// (40) at the printed gains.
pub(super) fn vacuous(b: &TheoryBounds, paper: &Paper) -> Result<Statement, PartError> {
    let (beyond, seen) = beyond_40()?;
    let proven = PHI_MAX * b.peak();
    let [printed, corrected, met] =
        [paper.radius.printed, paper.radius.corrected, b.measured[2]].map(|v| PHI_MAX * v);
    Ok(Published {
        id: "theorem5-radius",
        place: "Theorem 5, (40); Table 2 (C), m = 1",
        claim: "|x| in steady state is at most (40)",
        paper: "|x| ≤ 2|SB|φ_max/λ_min",
    }
    .found(
        format!(
            "(40): {}; what its proof gives, with √cond(S): {}; by L1 gains: {}; worst case met: {}; an entry of x \
             beyond (40) at {beyond} of {seen} random laws of order 1",
            three(printed.into()),
            three(corrected.into()),
            three(proven.into()),
            three(met.into())
        ),
        // By its proof it would need a ball that is a level set of V.
        Verdict::of(corrected <= printed, met <= corrected && proven <= printed),
        format!(
            "V̇ < 0 outside the ball of (40); what is then kept is the smallest level set of V around it, √cond(S) = \
             {} times as large. At these gains (40) is true all the same, by the L1 gains and not by its proof: it is \
             {} times what the worst φ can do. As a performance criterion both are vacuous here. Whether this \
             can be false at other gains is open: no entry of x goes beyond it at the worst φ of the random laws. Read \
             per entry it is false: theorem5-entrywise.",
            three(paper.iss.overshoot.into()),
            three((printed / met).into())
        ),
        vec![
            number("(40)", "", printed, 1e-4),
            number("corrected", "", corrected, 1e-4),
            number("|x| by L1 gains", "", proven, 1e-4),
            number("largest |x| met", "", met, 1e-3),
            number("random laws at which an entry of x goes beyond (40)", "", beyond as f64, 0.0),
        ],
    )
    .assuming(&["gains", "phi-max"]))
}

/// Random states at which V̇ is looked at: as many in a quick run.
const DRAWS: usize = 2000;

/// "V̇ < 0 iff |x| ≤ (40)".
pub(super) fn outside(law: &UnitLaw, paper: &Paper) -> Statement {
    let (a, mut draw) = (law.closed_loop(), Draw::new(6));
    let (n, radius) = (a.len(), paper.radius.printed);
    let (mut inside_up, mut outside_up, mut outside_seen) = (0_usize, 0_usize, 0_usize);
    for k in 0..DRAWS {
        let x = draw.spread(n, 5.0);
        let reach = 10.0_f64.powf(draw.between(-6.0, 2.0)) * radius / length(&x);
        let x: Vec<f64> = x.iter().map(|v| v * reach).collect();
        let mut rate = apply(&a, &x);
        rate[n - 1] -= if k % 2 == 0 { 1.0 } else { -1.0 };
        let grows = dot(&apply(&paper.certified.s, &x), &rate) >= 0.0;
        let beyond = length(&x) > radius;
        outside_seen += usize::from(beyond);
        outside_up += usize::from(beyond && grows);
        inside_up += usize::from(!beyond && grows);
    }
    let inside_seen = DRAWS - outside_seen;
    Published {
        id: "erratum-40-sign",
        place: "End of the proof of Theorem 5",
        claim: "V̇ < 0 if and only if |x| is at most (40)",
        paper: "V̇ < 0 iff |x| ≤ …",
    }
    .found(
        format!("V̇ ≥ 0 at {inside_up} of {inside_seen} states inside the ball, at {outside_up} of {outside_seen} \
            outside"),
        Verdict::of(inside_up == 0 && outside_up == outside_seen, inside_up > 0 && outside_up == 0),
        "The other way around: V̇ < 0 if |x| is larger than (40). Inside, V may grow. And it is not \"only if\": V̇ < \
         0 at most states inside as well.",
        vec![
            number("states inside at which V̇ ≥ 0", "", inside_up as f64, 0.05),
            number("states inside", "", inside_seen as f64, 0.0),
            number("states outside at which V̇ ≥ 0", "", outside_up as f64, 0.0),
            number("states outside", "", outside_seen as f64, 0.0),
        ],
    )
    .assuming(&["gains"])
}

/// A state in the ball leaves it.
pub(super) fn not_invariant(law: &UnitLaw, iss: &Iss) -> Statement {
    let (a, n) = (law.closed_loop(), law.order() + 2);
    let mut most: f64 = 0.0;
    for index in 0..n {
        let start: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i == index))).collect();
        for k in 0..400 {
            most = most.max(length(&apply(&flow(&a, f64::from(k) * 1e-3), &start)));
        }
    }
    Published {
        id: "erratum-40-cond",
        place: "(40)",
        claim: "The ball of (40) is left by states that start in it, by √cond(S) at most",
        paper: "not stated; (40) is the maximum error in steady state",
    }
    .found(
        format!(
            "m = 1, φ = 0: |x| grows to {} times its start; √cond(S) = {}",
            three(most.into()),
            three(iss.overshoot.into())
        ),
        Verdict::of(most > 1.0 && most <= iss.overshoot, false),
        "The ball is no level set of V, so that V̇ < 0 outside it does not keep a state in it. The factor √cond(S) \
         covers what can happen.",
        vec![
            number("largest |x(t)|/|x(0)|", "", most, 1e-3),
            number("√cond(S)", "", iss.overshoot, 1e-4),
        ],
    )
    .assuming(&["gains"])
    .ours()
}
