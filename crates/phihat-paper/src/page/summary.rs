//! The page's first lines: what came of the paper, in a few sentences made from the counts.

use maud::{Markup, html};

use phihat_report::kit::anchor;
use phihat_report::kit::text::prose;

use super::words::statements;
use crate::coverage::coverage;
use crate::record::{Origin, Reproduction, Section, Verdict};

/// "1 statement", "2 statements".
fn count(number: usize, one: &str, many: &str) -> String {
    format!("{number} {}", if number == 1 { one } else { many })
}

/// Number of the paper's statements in some sections that hold, as printed or with a correction, and of all of them.
fn held(reproduction: &Reproduction, within: &[&str]) -> (usize, usize) {
    let chosen = |section: &&Section| within.iter().any(|id| section.id.starts_with(id));
    let statements = reproduction.sections.iter().filter(chosen).flat_map(|s| &s.statements);
    let own: Vec<_> = statements.filter(|s| s.origin == Origin::Paper).collect();
    let holds = [Verdict::AsPrinted, Verdict::WithCorrection];
    (own.iter().filter(|s| holds.contains(&s.verdict)).count(), own.len())
}

/// Sections by what they are about; ids by their beginnings.
const GROUPS: [(&str, &[&str]); 5] = [
    (
        "the law and its theory (Secs. II to IV)",
        &[
            "section-2",
            "lemma-1",
            "theorem-1",
            "theorem-2",
            "theorem-3",
            "theorem-4",
            "remark-9",
            "l2-gain",
        ],
    ),
    ("performance and the choice of gains (Sec. V, Table 2)", &["theorem-5", "recipe", "table-2"]),
    (
        "simulations (Figs. 4 to 8, 12, 13)",
        &["figure-4", "figures-5", "figure-7", "figure-8", "figures-12", "order-switching"],
    ),
    ("experiments (Figs. 9 to 11, Table 3)", &["figures-9", "table-3"]),
    (
        "what is said in words, of other laws (Table 1) and in single symbols",
        &["in-words", "table-1", "errata"],
    ),
];

/// Corrections for an implementation of the paper: the statement behind each, what to do, and why.
const CORRECTIONS: [(&str, &str, &str); 5] = [
    (
        "remark5-parameters",
        "Give the law a nominal inertia for each joint.",
        "The factor M̄ of (5) and (6) is printed as 1. With the joint's own inertia the printed gains are stable at \
            any constant inertia; with 1, a joint that is heavy enough is not.",
    ),
    (
        "lemma1-start",
        "Start the estimate at zero, not the integrals.",
        "Integrals at zero make the φ̂ of (9) and (10) begin far from it where the arm is off its path. The observer \
            form of (8) begins at zero.",
    ),
    (
        "saturation-in-phi",
        "Feed the estimator with the torque that acted.",
        "(9) and (10) do not know of a torque limit, and go on summing against it. With τ_applied − M̄q̈ the limit is \
            a part of φ, as the paper says.",
    ),
    (
        "theorem5-componentwise",
        "Take no bound on an error from (40) or (44).",
        "Row by row they bound nothing: the worst φ goes beyond the limits that (44) was solved for. Peak-to-peak (L₁) \
            gains are the bound.",
    ),
    (
        "table2-c2",
        "Do not take the gains of order 2 in Table 2 for proved.",
        "They violate A3, so Theorems 2, 3 and 5 say nothing about them; with b₀ as printed no K̃ has a certificate.",
    ),
];

/// The corrections, where their statements were tested.
fn corrections(reproduction: &Reproduction) -> Markup {
    let tested = |id: &str| statements(reproduction).find(|statement| statement.id == id);
    let found: Vec<_> = CORRECTIONS
        .iter()
        .filter_map(|(id, to_do, why)| Some((tested(id)?, *to_do, *why)))
        .collect();
    html! { @if !found.is_empty() {
        h2 id="corrections" {
            @if found.len() == CORRECTIONS.len() { "Five corrections that you need if you implement this paper" }
            @else { "Corrections that you need if you implement this paper" }
        }
        ol.corrections { @for (statement, to_do, why) in found { li {
            strong { (to_do) } " " (why) " "
            a href=(format!("#{}", anchor("claim", &statement.id))) { (prose(&statement.place)) }
        } } }
    } }
}

/// Statements that are open, by their places.
fn untold(reproduction: &Reproduction) -> Markup {
    let open: Vec<_> = reproduction.of(Origin::Paper, Verdict::Open).collect();
    html! { @if !open.is_empty() { p {
        "Cannot be told from what is printed: "
        @for (k, statement) in open.iter().enumerate() {
            @if k > 0 { "; " }
            a href=(format!("#{}", anchor("claim", &statement.id))) { (prose(&statement.place)) }
        }
        "."
    } } }
}

pub(super) fn summary(reproduction: &Reproduction) -> Markup {
    let [holds, corrected, refuted, open] =
        Verdict::ALL.map(|verdict| reproduction.of(Origin::Paper, verdict).count());
    let all = holds + corrected + refuted + open;
    let groups = GROUPS.iter().map(|(name, within)| (name, held(reproduction, within)));
    let groups = groups
        .filter(|(_, (_, all))| *all > 0)
        .map(|(name, (held, all))| format!("{held} of {all} on {name}"));
    let groups = groups.collect::<Vec<_>>().join("; ");
    let covered = coverage(reproduction);
    let covered = covered
        .iter()
        .map(|part| format!("{} of {} {}", part.covered, part.all, part.kind.words()));
    let covered = covered.collect::<Vec<_>>().join(", ");
    html! {
        section.summary id="summary" aria-label="Summary" {
            p {
                "Of " (count(all, "statement", "statements")) " of the paper that were \
                    tested, " (holds + corrected) " hold: "
                (holds) " as printed, " (corrected) " with a correction, which is named. "
                (count(refuted, "is", "are")) " refuted as worded. " (open) " cannot be told from what is printed, and \
                 that says nothing against the paper."
            }
            (corrections(reproduction))
            h2 id="holds" { "What holds" }
            @if !groups.is_empty() { p { "As printed or with a correction: " (groups) "." } }
            (untold(reproduction))
            p {
                "Every statement says how it was read, what was varied, and where its verdict would turn. Nothing was \
                 measured on the authors' arms: they are not published, and what is simulated in their place is \
                 assumed. Covered: " (covered) "."
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{CORRECTIONS, GROUPS};

    fn kept() -> serde_json::Value {
        let kept = include_str!("../../../../docs/reproduction/reproduction.json");
        serde_json::from_str(kept).unwrap()
    }

    /// A correction stands where the statement was found wanting.
    #[test]
    fn every_correction_corrects_something() {
        let kept = kept();
        let sections = kept["sections"].as_array().unwrap().iter();
        let all: Vec<_> =
            sections.flat_map(|section| section["statements"].as_array().unwrap()).collect();
        for (id, ..) in CORRECTIONS {
            let statement = all.iter().find(|statement| statement["id"] == id).unwrap();
            let verdict = statement["verdict"].as_str().unwrap();
            assert!(["with_correction", "refuted"].contains(&verdict), "{id}: {verdict}");
        }
    }

    #[test]
    fn every_statement_of_the_paper_is_in_one_group() {
        let kept = kept();
        for section in kept["sections"].as_array().unwrap() {
            let id = section["id"].as_str().unwrap();
            let mut statements = section["statements"].as_array().unwrap().iter();
            let own = statements.any(|statement| statement["origin"] == "paper");
            let within = GROUPS.iter().flat_map(|(_, within)| *within);
            let groups = within.filter(|group| id.starts_with(**group)).count();
            assert_eq!(groups, usize::from(own), "{id}");
        }
    }
}
