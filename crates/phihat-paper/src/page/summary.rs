//! The page's first lines: what came of the paper, in a few sentences made from the counts.

use maud::{Markup, html};

use crate::coverage::coverage;
use crate::record::{Origin, Reproduction, Section, Verdict};

/// "1 statement", "2 statements".
fn count(number: usize, one: &str, many: &str) -> String {
    format!("{number} {}", if number == 1 { one } else { many })
}

/// How many of the paper's statements in some sections hold, as printed or with a correction, and how many there are.
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
                "Of " (count(all, "statement", "statements")) " of the paper that were tested, " (holds + corrected) " hold: "
                (holds) " as printed, " (corrected) " with a correction, which is named. "
                (count(refuted, "is", "are")) " refuted as worded. " (open) " cannot be told from what is printed, and that says \
                 nothing against the paper."
            }
            @if !groups.is_empty() { p { "Holds, as printed or with a correction: " (groups) "." } }
            p {
                "Every statement says how it was read, what was varied, and where its verdict would turn. Nothing was measured on the \
                 authors' arms: they are not published, and what is simulated in their place is assumed. Covered: " (covered) "."
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::GROUPS;

    #[test]
    fn every_statement_of_the_paper_is_in_one_group() {
        let kept = include_str!("../../../../docs/reproduction/reproduction.json");
        let kept: serde_json::Value = serde_json::from_str(kept).unwrap();
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
