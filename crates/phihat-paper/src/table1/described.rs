//! The columns "approach" and "description" of Table 1, as far as a law's type can tell; and one row against the text.

use phihat_rivals::Needs;

use super::row::Table1Row;
use crate::compose::number;
use crate::published::Published;
use crate::record::{Statement, Verdict};

/// Property in a description that the needs of a law show.
struct DescribedProperty {
    row: &'static str,
    words: &'static str,
    shown: fn(&Needs) -> bool,
}

/// Row by row, in our words. What is left out says nothing that a type could show.
const SAID: [DescribedProperty; 10] = [
    DescribedProperty { row: "[23]", words: "uses the regressor", shown: |n| n.regressor },
    DescribedProperty {
        row: "[2]",
        words: "basis functions, no regressor",
        shown: |n| !n.regressor && !n.model,
    },
    DescribedProperty { row: "[25]", words: "uses the regressor", shown: |n| n.regressor },
    DescribedProperty {
        row: "[29]",
        words: "regressor, uncertain kinematics",
        shown: |n| n.regressor && n.task,
    },
    DescribedProperty { row: "[28]", words: "observer, no joint velocity", shown: |n| !n.velocity },
    DescribedProperty { row: "[26]", words: "needs system parameters", shown: |n| n.model },
    DescribedProperty {
        row: "[27]",
        words: "a filtered term is added",
        shown: |n| n.regressor && n.torque,
    },
    DescribedProperty { row: "[30]", words: "disturbance observer", shown: |n| n.torque },
    DescribedProperty { row: "[22]", words: "disturbance observer", shown: |n| n.torque },
    DescribedProperty { row: "[20]", words: "stays in an orbit of the path", shown: |n| n.orbit },
];

/// Statement that compares the printed words with the inputs of each law here.
pub(super) fn described(rows: &[Table1Row]) -> Statement {
    let (mut agree, mut against, mut unsure) = (0, Vec::new(), Vec::new());
    for said in &SAID {
        let laws = rows.iter().filter(|row| row.name == said.row).flat_map(|row| &row.laws);
        let off: Vec<_> = laws.filter(|entry| !(said.shown)(&entry.needs)).collect();
        let listed = format!("{} ({})", said.row, said.words);
        if off.is_empty() {
            agree += 1;
        } else if off.iter().any(|entry| entry.card.grade != phihat_rivals::Grade::C) {
            against.push(listed);
        } else {
            unsure.push(listed);
        }
    }
    let list = |rows: &[String]| if rows.is_empty() { "none".to_owned() } else { rows.join("; ") };
    let verdict = match (against.is_empty(), unsure.is_empty()) {
        (true, true) => Verdict::AsPrinted,
        (true, false) => Verdict::Open,
        (false, _) => Verdict::of(false, agree > 0),
    };
    Published {
        id: "table1-description",
        place: "Table 1, approach and description",
        claim: "What each approach uses",
        paper: "a sentence per row",
    }
    .found(
        format!(
            "{agree} of {} rows as described; not: {}; not known, the published law not being found: {}",
            SAID.len(),
            list(&against),
            list(&unsure)
        ),
        verdict,
        "What a law is handed is in its type here, so that a regressor, a velocity, a model, a measured torque or a \
         path shows. \"Robust inverse dynamics\" stands for [25]: it has a nominal model in place of a regressor. Rows \
         that say nothing of the kind ([44]; [5], [12], see erratum-table1-pid) are left out.",
        vec![
            number("rows looked at", "", SAID.len() as f64, 0.0),
            number("rows as described", "", f64::from(agree), 0.0),
        ],
    )
    .read_as("what a law of the row is handed: regressor, model, velocity, torque, path, tip position")
    .varying("nothing")
    .turning("one row whose known law is handed something else (then with a correction)")
}

/// The row of [5] and [12] says ✓ "model free", and in words that its parameters need knowledge of the system.
pub(super) fn pid_model_free(rows: &[Table1Row]) -> Statement {
    let laws: Vec<_> =
        rows.iter().filter(|row| row.name == "[5], [12]").flat_map(|row| &row.laws).collect();
    let free = laws.iter().filter(|entry| entry.needs.model_free()).count();
    let named: Vec<_> = laws
        .iter()
        .map(|entry| format!("{} {}: {}", entry.card.reference, entry.card.id, entry.needs))
        .collect();
    Published {
        id: "erratum-table1-pid",
        place: "Table 1, [5], [12]; Sec. VI",
        claim: "[5] and [12] are model-free, and their parameters require knowledge about the system",
        paper: "✓; \"require knowledge\"",
    }
    .found(
        named.join("; "),
        Verdict::of(free == laws.len(), 0 < free && free < laws.len()),
        "Mark and text differ. [12] as a law needs no model, and as a design it needs bounds on the system: \"-\" in \
         the table's own words. [5] simulates a nominal arm: ✗.",
        vec![
            number("laws of the row", "", laws.len() as f64, 0.0),
            number("of these, laws that need no model", "", free as f64, 0.0),
        ],
    )
    .read_as("the law, not its design")
    .varying("nothing")
    .turning("both laws being handed no model (then as printed), or both being handed one (then refuted)")
}
