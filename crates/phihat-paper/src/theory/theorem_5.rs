//! Theorem 5: what bounds the state, a bound that is sharp, and the worst case measured.

use super::ball::{not_invariant, outside, vacuous};
use super::bounds::Bounds;
use super::rows::componentwise;
use crate::compose::{number, three, words};
use crate::gains::{K_TILDE, K_TILDE_H3, PHI_MAX, all as laws};
use crate::part::PartError;
use crate::published::Published;
use crate::record::{Section, Statement, Table, Verdict};

/// Theorem 5 and (44).
pub(super) fn theorem_5() -> Result<Section, PartError> {
    let [one, h1, h2, h3] = laws();
    let all = [
        Bounds::of(one.0, one.1, K_TILDE)?,
        Bounds::of(h1.0, h1.1, K_TILDE)?,
        Bounds::of(h2.0, h2.1, K_TILDE)?,
        Bounds::of(h3.0, h3.1, K_TILDE_H3)?,
    ];
    let paper = all[0]
        .paper
        .as_ref()
        .ok_or(PartError::Missing("m = 1 of Table 2 (C) has a certificate"))?;
    let statements = vec![
        vacuous(&all[0], paper)?,
        outside(&all[0].law, paper),
        not_invariant(&all[0].law, &paper.iss),
        sharp(&all),
        componentwise()?,
    ];
    Ok(Section {
        id: "theorem-5".to_owned(),
        title: "Theorem 5: how large the errors get".to_owned(),
        text: words(&[
            "|x| of (40) adds rad·s, rad and rad/s. φ comes from outside here, at M̄ = 1 and bounded by \
                       φ_max; the worst φ switches between ±φ_max and is computed, not guessed. (40) needs a certificate, \
                       which H1 and H2 do not have; the gains between peaks need none.",
        ]),
        statements,
        tables: vec![table(&all)],
        figures: Vec::new(),
    })
}

fn table(all: &[Bounds]) -> Table {
    let row = |b: &Bounds| {
        let cells = [
            b.paper.as_ref().map(|paper| paper.radius.printed),
            b.paper.as_ref().map(|paper| paper.radius.corrected),
            Some(b.peak()),
            Some(b.measured[2]),
            Some(b.error()),
            Some(b.measured[0]),
            Some(b.velocity()),
            Some(b.measured[1]),
        ];
        let scaled = cells.map(|v| three(v.map(|v| PHI_MAX * v)));
        [b.name.to_owned()].into_iter().chain(scaled).collect()
    };
    Table {
        id: "theorem-5-bounds".to_owned(),
        title: format!("Bounds and the worst case met, φ_max = {PHI_MAX}"),
        columns: words(&[
            "law",
            "|x| by (40)",
            "|x|, corrected",
            "|x| by L1 gains",
            "|x| met",
            "|e| by L1 gain [rad]",
            "|e| met [rad]",
            "|ė| by L1 gain [rad/s]",
            "|ė| met [rad/s]",
        ]),
        rows: all.iter().map(row).collect(),
    }
}

/// L1 gains against the worst φ, and against the errors that the paper allows.
fn sharp(all: &[Bounds]) -> Statement {
    let shares = all.iter().flat_map(|b| [b.measured[0] / b.error(), b.measured[1] / b.velocity()]);
    let shares: Vec<f64> = shares.collect();
    let (low, high) =
        shares.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), s| (l.min(*s), h.max(*s)));
    let worst: Vec<_> =
        all.iter().map(|b| (b.name, PHI_MAX * b.error(), PHI_MAX * b.velocity())).collect();
    let within = worst.iter().all(|(_, e, de)| *e <= 1e-2 && *de <= 1e-1);
    let met = high <= 1.0 + 1e-6;
    let listed = worst.iter().map(|(name, e, de)| {
        format!("{name}: {} rad, {} rad/s", three((*e).into()), three((*de).into()))
    });
    let numbers = worst.iter().flat_map(|(name, e, de)| {
        [
            number(&format!("worst |e|, {name}"), "rad", *e, 1e-4),
            number(&format!("worst |ė|, {name}"), "rad/s", *de, 1e-4),
        ]
    });
    Published {
        id: "theorem5-sharp",
        place: "Theorem 5, Remark 11, (48), (49)",
        claim: "With the gains that were used the errors never exceed 0.01 rad and 0.1 rad/s, for |φ| ≤ φ_max",
        paper: "|e| ≤ 0.01 rad, |ė| ≤ 0.1 rad/s; never",
    }
    .found(
        format!("worst φ: {}", listed.collect::<Vec<_>>().join("; ")),
        Verdict::of(within && met, false),
        format!(
            "m = 1 and K_p, K_d are those of Table 2 (C), the a_i are assumed; H3 is not of Table 2 (C), whose b_0 is 69.6: those \
             are H1 and H2. Peak-to-peak (L1) gains bound e and ė, and the worst φ attains {:.1} to {:.1} % of them: they \
             are sharp. A φ that jumps between ±{PHI_MAX} breaks the limits; φ of an arm is smoother, and then the \
             gain from φ̇ applies: |e| ≤ {} |φ̇|_∞ at m = 1. All this is from rest: an initial error comes on top.",
            100.0 * low,
            100.0 * high,
            three(all[0].peaks.error(1).map(|gain| gain.upper))
        ),
        numbers.chain([number("least share of the bound that is met", "", low, 1e-3)]).collect(),
    )
    .assuming(&["gains", "phi-max"])
}
