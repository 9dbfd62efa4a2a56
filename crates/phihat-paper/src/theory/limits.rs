//! (48) and (49) against the worst φ, entry by entry: up to which φ_max the printed limits hold.

use super::bounds::TheoryBounds;
use crate::compose::{number, three};
use crate::gains::PHI_MAX;
use crate::record::{Statement, Verdict};

/// Values of φ_max that Table 2 (A) can have been computed with: K_p and K_d give the first one, K̃ alone half
/// of it.
const PHI: [f64; 2] = [PHI_MAX, 0.5 * PHI_MAX];

/// Errors that share a statement: its name, and how they count from the velocity error downwards.
struct Entries {
    name: &'static str,
    what: &'static str,
    does: &'static str,
    below: &'static [usize],
}

const ENTRIES: [Entries; 3] = [
    Entries { name: "velocity", what: "ė", does: "leaves its limit", below: &[0] },
    Entries { name: "error", what: "e", does: "leaves its limit", below: &[1] },
    Entries {
        name: "integrals",
        what: "the integrals of e",
        does: "leave their limits",
        below: &[2, 3],
    },
];

/// (48), (49).
fn x_max(order: usize) -> Vec<f64> {
    (0..order + 2).map(|i| 10.0_f64.powi(-1 - i32::try_from(order + 1 - i).unwrap_or(0))).collect()
}

/// The largest φ_max at which every entry keeps its limit, and the smallest at which one is left.
fn threshold(bounds: &TheoryBounds, below: &[usize]) -> (f64, f64) {
    let (limits, last) = (x_max(bounds.law.order()), bounds.law.order() + 1);
    let places = below.iter().filter_map(|b| last.checked_sub(*b));
    let gains = places.map(|i| (limits[i], bounds.peaks.states[i]));
    gains.fold((f64::INFINITY, f64::INFINITY), |(kept, left), (limit, gain)| {
        (kept.min(limit / gain.upper), left.min(limit / gain.lower))
    })
}

/// One statement per order and kind of error.
pub(super) fn limits(all: &[TheoryBounds]) -> Vec<Statement> {
    let orders = [(1, "first", "(48)"), (2, "second", "(49)")];
    let each = orders.iter().flat_map(|order| ENTRIES.iter().map(move |entries| (order, entries)));
    each.map(|((order, word, place), entries)| {
        let laws: Vec<&TheoryBounds> = all.iter().filter(|b| b.law.order() == *order).collect();
        within(&laws, entries, (word, place))
    })
    .collect()
}

fn within(laws: &[&TheoryBounds], entries: &Entries, (word, place): (&str, &str)) -> Statement {
    let found: Vec<_> = laws.iter().map(|b| (b.name, threshold(b, entries.below))).collect();
    let cases = || PHI.iter().flat_map(|phi| found.iter().map(move |(_, at)| (*phi, *at)));
    let kept = cases().all(|(phi, (kept, _))| phi <= kept);
    let left = cases().all(|(phi, (_, left))| phi > left);
    let verdict = match (kept, left) {
        (true, _) => Verdict::AsPrinted,
        (_, true) => Verdict::Refuted,
        _ => Verdict::Open,
    };
    let listed: Vec<_> =
        found.iter().map(|(name, (kept, _))| format!("{name}: {}", three(Some(*kept)))).collect();
    let listed = listed.join("; ");
    let [one, half] = PHI.map(|phi| three(Some(phi)));
    let why = match verdict {
        Verdict::AsPrinted => {
            "Peak-to-peak gains keep it at both values of φ_max that Table 2 (A) can mean."
        }
        Verdict::Refuted => {
            "A φ that switches between ±φ_max leaves the limit at either value of φ_max that Table 2 (A) can mean, and \
             is the worst that |φ| ≤ φ_max allows. φ of an arm is smoother; its limits in steady state are kept in the \
             simulation of Fig. 7."
        }
        _ => {
            "It depends on which value of φ_max Table 2 (A) means, or on which a_i were used: neither is printed."
        }
    };
    let numbers = found.iter().map(|(name, (kept, _))| {
        number(&format!("φ_max up to which it holds, {name}"), "N·m", *kept, 1e-4)
    });
    crate::compose::statement(
        [
            &format!("theorem5-{}-{word}", entries.name),
            &format!("Theorem 5, Remark 11, {place}"),
            &format!("With the gains that were used {} never {} in {place} while |φ| ≤ \
                φ_max", entries.what, entries.does),
            &format!("{place}; never exceed"),
        ],
        verdict,
        (format!("true up to φ_max = {listed} N·m; Table 2 (A) means {one} or {half}"), why.to_owned()),
        numbers.collect(),
    )
    .read_as("any φ with |φ| ≤ φ_max, from rest, M̄ = 1: \"to ensure that the joint errors never exceed a predefined \
        value\"")
    .varying(format!("φ_max {half} and {one} N·m; at m = 2 the hypotheses on the gains"))
    .turning(format!("φ_max = {listed} N·m"))
    .assuming(&["gains", "phi-max"])
}
