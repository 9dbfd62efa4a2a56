//! Theorem 5: what bounds the state, a bound that is sharp, and the worst case measured.

use super::ball::{not_invariant, outside, vacuous};
use super::bounds::TheoryBounds;
use super::entrywise::entrywise;
use super::limits::limits;
use super::rows::componentwise;
use phihat_design::claims::UnitLaw;

use crate::compose::{number, three, words};
use crate::gains::{K_TILDE, K_TILDE_H3, PHI_MAX, all as laws};
use crate::part::PartError;
use crate::published::Published;
use crate::record::{Section, Statement, Table, Verdict};

/// Theorem 5 and (44).
pub(super) fn theorem_5() -> Result<Section, PartError> {
    let bounds = |(name, law): (&'static str, UnitLaw)| {
        TheoryBounds::of(name, law, if name == "H3" { K_TILDE_H3 } else { K_TILDE })
    };
    let all = laws().into_iter().map(bounds).collect::<Result<Vec<_>, _>>()?;
    let paper = all[0]
        .paper
        .as_ref()
        .ok_or(PartError::Missing("m = 1 of Table 2 (C) has a certificate"))?;
    let mut statements = vec![
        vacuous(&all[0], paper)?,
        entrywise()?,
        outside(&all[0].law, paper),
        not_invariant(&all[0].law, &paper.iss),
    ];
    statements.extend(limits(&all));
    statements.extend([attained(&all), componentwise()?]);
    Ok(Section {
        id: "theorem-5".to_owned(),
        title: "Theorem 5: how large the errors get".to_owned(),
        text: words(&[
            "|x| of (40) adds rad·s, rad and rad/s. φ comes from outside here, at M̄ = 1 and bounded by \
                       φ_max; the worst φ switches between ±φ_max and is computed, not guessed. (40) needs a \
                       certificate, which H1 and H2 do not have; the gains between peaks need none.",
        ]),
        statements,
        tables: vec![table(&all)],
        figures: Vec::new(),
    })
}

fn table(all: &[TheoryBounds]) -> Table {
    let row = |b: &TheoryBounds| {
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

/// L1 gains against the worst φ that is met.
fn attained(all: &[TheoryBounds]) -> Statement {
    let shares = all.iter().flat_map(|b| [b.measured[0] / b.error(), b.measured[1] / b.velocity()]);
    let shares: Vec<f64> = shares.collect();
    let (low, high) =
        shares.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), s| (l.min(*s), h.max(*s)));
    Published {
        id: "theorem5-attained",
        place: "Theorem 5, Remark 11",
        claim: "Peak-to-peak gains (L1 norms) bound e and ė, and a φ of that size attains them",
        paper: "not stated",
    }
    .found(
        format!("the worst φ attains {:.2} to {:.2} % of the bounds", 100.0 * low, 100.0 * high),
        Verdict::of(low > 0.99 && high <= 1.0 + 1e-6, false),
        format!(
            "So the limits of (48) and (49) hold up to a φ_max that can be computed, and no further. A φ that is \
             smooth does less: |e| ≤ {} |φ̇|_∞ at m = 1. All this is from rest: an initial error comes on top.",
            three(all.first().and_then(|b| b.peaks.error(1)).map(|gain| gain.upper))
        ),
        vec![number("least share of the bound that is met", "", low, 1e-3)],
    )
    .assuming(&["gains"])
    .ours()
}
