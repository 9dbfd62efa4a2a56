//! Statements of the paper without a number, and what can be said of them.

use crate::compose::words;
use crate::record::{Section, Table};

/// The list.
pub(super) fn unmeasured() -> Section {
    let rows: [[&str; 3]; 6] = [
        [
            "Abstract, Sec. VIII",
            "few parameters, intuitive to find",
            "`phihat compare` measures the share of gains near the default that work.",
        ],
        [
            "Remark 3",
            "q̈ stands in (5) only to save an estimate of q̈",
            "It does: (9) and (10) take e, ė and integrals. It also fixes M̄ (remark5-parameters).",
        ],
        [
            "Remark 11",
            "the largest |φ| is relatively easy to estimate",
            "No procedure is given, and φ contains q̈: its size depends on the gains that are to be found from it.",
        ],
        [
            "Sec. V-A",
            "no analytical solution for m ≥ 2",
            "Not decided here. Newton's method solves the rows for m = 2 and 3 (Table 2); for m = 1 see \
                analytical-first.",
        ],
        [
            "Sec. VI",
            "all limitations of the other controllers are addressed",
            "Column by column in the section on Table 1.",
        ],
        [
            "Sec. VIII",
            "a funnel improves the transient",
            "Future work of the paper. phihat has one for the start (`[supervisor]` of a study), and bounds on the \
                transient (tubes).",
        ],
    ];
    Section {
        id: "without-a-number".to_owned(),
        title: "Stated without a number".to_owned(),
        text: words(&[
            "These sentences give no value, law or criterion that a computation could meet or miss. They have no \
             verdict and are not counted.",
        ]),
        statements: Vec::new(),
        tables: vec![Table {
            id: "without-a-number-list".to_owned(),
            title: "What is said, and what can be said of it".to_owned(),
            columns: words(&["place", "said", "what can be said of it"]),
            rows: rows.iter().map(|row| words(row)).collect(),
        }],
        figures: Vec::new(),
    }
}
