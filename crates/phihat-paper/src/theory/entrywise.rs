//! (40) read entry by entry, as (48) and (49) are: the law at which it is farthest from a bound.

use phihat_design::claims::iss::decrease;
use phihat_design::claims::matrix::{identity, largest_shift};
use phihat_design::claims::{Optimality, PeakGains, UnitLaw, WorstCase};
use phihat_design::prelude::*;

use crate::compose::{number, three};
use crate::draw::Draw;
use crate::gains::{K_TILDE, first};
use crate::joint::{PaperForm, PhiCourse, largest, length, run};
use crate::part::PartError;
use crate::published::Published;
use crate::record::{Statement, Verdict};

/// Laws that are drawn, and times that the steps from the best of them halve.
const DRAWS: usize = 40;
const STEPS: i32 = 5;

/// Entries of x at m = 1.
const ENTRIES: [&str; 3] = ["∫e", "e", "ė"];

/// (40) of one law of order 1 beside what the worst φ does, per unit of φ.
struct EntrywiseComparison {
    law: UnitLaw,
    k_tilde: f64,
    /// `2(SB)_i/λ_min`.
    printed: [f64; 3],
    /// Peak-to-peak gains, from below.
    gains: [f64; 3],
}

impl EntrywiseComparison {
    /// At `K_p`, `K_d`, `a_0`, `K̃/a_0`; none where there is no certificate (B1, B2).
    fn at(kp: f64, kd: f64, a0: f64, share: f64) -> Option<Self> {
        let (law, k_tilde) = (UnitLaw { kp, kd, a: vec![a0] }, share * a0);
        let claim = Optimality::at(&law, k_tilde).ok()?;
        let s = claim.certified()?.s.clone();
        // From below: (40) is not made smaller than it is.
        let least = largest_shift(&decrease(&law, &s), &identity(3))?;
        let gains = PeakGains::of(&law, 1.0).ok()?.states;
        let entry = |i: usize| 2.0 * s[i][2] / least;
        let printed = [entry(0), entry(1), entry(2)];
        let gains = [gains[0].lower, gains[1].lower, gains[2].lower];
        Some(Self { law, k_tilde, printed, gains })
    }

    /// The entry that goes farthest beyond its own (40), and how far.
    fn entry(&self) -> (usize, f64) {
        let ratio = |i: usize| self.gains[i] / self.printed[i];
        let worst = (0..3).max_by(|a, b| ratio(*a).total_cmp(&ratio(*b))).unwrap_or(2);
        (worst, ratio(worst))
    }

    /// Largest gain to an entry, over the length of (40).
    fn whole(&self) -> f64 {
        largest(self.gains) / length(&self.printed)
    }
}

/// Result of a search over laws of order 1: the law whose entry goes farthest beyond (40), and the largest
/// [`EntrywiseComparison::whole`] on its way. Draws first, then steps that halve.
fn search() -> Option<(EntrywiseComparison, f64)> {
    let mut draw = Draw::new(48);
    let (mut best, mut whole): (Option<([f64; 4], EntrywiseComparison)>, f64) = (None, 0.0);
    let mut look = |p: [f64; 4], best: &mut Option<([f64; 4], EntrywiseComparison)>| {
        let Some(new) = EntrywiseComparison::at(p[0].exp(), p[1].exp(), p[2].exp(), p[3]) else {
            return;
        };
        whole = whole.max(new.whole());
        if best.as_ref().is_none_or(|(_, old)| new.entry().1 > old.entry().1) {
            *best = Some((p, new));
        }
    };
    for _ in 0..DRAWS {
        let (kp, kd) = (draw.between(0.0, 6.0), draw.between(0.0, 4.0));
        look([kp, kd, draw.between(2.0, 7.0), draw.between(0.05, 0.99)], &mut best);
    }
    for halvings in 0..STEPS {
        for i in 0..4 {
            for side in [-1.0, 1.0] {
                let mut p = best.as_ref()?.0;
                p[i] += side * 0.5_f64.powi(halvings) * if i == 3 { 0.2 } else { 1.0 };
                p[3] = p[3].clamp(0.01, 0.999);
                look(p, &mut best);
            }
        }
    }
    best.map(|(_, found)| (found, whole))
}

/// The largest entry that the loop reaches from rest on its worst φ, |φ| = 1.
fn met(law: &UnitLaw, entry: usize) -> Result<f64, PartError> {
    let worst = WorstCase::of(law, 1.0, entry)?;
    // What was longer ago than this is forgotten: the slowest pole decays within a second.
    let (dt, from) = (2e-5, (worst.peak_s - 6.0).max(0.0));
    let instants = (0..400_000).map(|k| from + f64::from(k) * dt);
    let phi: Vec<f64> = instants.take_while(|t| *t <= worst.peak_s).map(|t| worst.phi(t)).collect();
    let steps = phi.len().saturating_sub(1);
    let rows = run(law, PaperForm::Ladder, &[], &PhiCourse::Joined(phi), (dt, steps));
    Ok(largest(rows.iter().map(|row| row.x[entry])))
}

/// "|x| is the maximum allowed error": each entry against its own entry of (40).
pub(super) fn entrywise() -> Result<Statement, PartError> {
    let lost = || PartError::Missing("a law of order 1 with a certificate");
    let (found, whole) = search().ok_or_else(lost)?;
    let (entry, ratio) = found.entry();
    let (printed, reached) = (found.printed[entry], met(&found.law, entry)?);
    let used = first();
    let used = EntrywiseComparison::at(used.kp, used.kd, used.a[0], K_TILDE / used.a[0])
        .ok_or_else(lost)?;
    let UnitLaw { kp, kd, a } = &found.law;
    let name = ENTRIES[entry];
    Ok(Published {
        id: "theorem5-entrywise",
        place: "Theorem 5, (40) with (48), (49)",
        claim: "Each error in steady state is at most its entry of (40)",
        paper: "|x| ≤ 2SB|φ_max|/λ_min, SB a vector",
    }
    .found(
        format!(
            "K_p = {}, K_d = {}, a_0 = {}, K̃ = {}: the entry of {name} is {} per unit of φ, and the worst φ takes \
             {name} to {}; at the gains of Table 2 (C) every entry is at least {} times what the worst φ does",
            three(Some(*kp)),
            three(Some(*kd)),
            three(a.first().copied()),
            three(Some(found.k_tilde)),
            three(Some(printed)),
            three(Some(reached)),
            three(Some(used.entry().1.recip()))
        ),
        Verdict::of(ratio <= 1.0 && reached <= printed, false),
        format!(
            "(40) is a vector, as (48) and (49) are, which it is meant to be held against. Read so, V̇ < 0 outside the \
             box of (40) is not shown, and a law with B1 and B2 leaves it: {name} goes {ratio:.2} times as far. Read \
             as lengths, the same search finds no entry beyond (40) (largest share {whole:.2}); see theorem5-radius."
        ),
        vec![
            number("largest gain over its entry of (40), by search", "", ratio, 1e-2),
            number("the entry met on the worst φ over (40)", "", reached / printed, 1e-2),
            number("(40) of that entry, per unit of φ", "", printed, 0.1),
            number("largest entry over the length of (40), by search", "", whole, 1e-2),
            number("largest gain over its entry of (40), Table 2 (C)", "", used.entry().1, 1e-4),
        ],
    )
    .read_as("a vector inequality, one row per integral, error and velocity error; φ from rest, M̄ = 1")
    .varying(
        "K_p, K_d, a_0 and K̃ over all laws of order 1 with B1 and B2, by a search; the gains of Table 2 (C) beside it",
    )
    .turning(format!(
        "a largest ratio of gain to entry of 1 over all laws with B1 and B2; found {ratio:.3}"
    ))
    .assuming(&["gains"]))
}
