//! What the paper states without a number, and what can be said of it.

use core::f64::consts::TAU;

use crate::compose::{three, words};
use crate::record::{Section, Table};

/// Root mean square of white noise of a position, differenced at 1 kHz, that is left behind a drive of one pole.
fn noise_behind(hertz: f64) -> f64 {
    let pole = (-TAU * hertz * 1e-3).exp();
    // The filter (1 − p)/(1 − p/z) on 1 − 1/z: Σh² = 2(1 − p)²/(1 + p), against 2.
    (1.0 - pole) / (1.0 + pole).sqrt()
}

/// The list.
pub(super) fn unmeasured() -> Section {
    let drives = [50.0, 200.0, 500.0];
    let noise = format!(
        "Depends on the drive: of the noise of a differenced position at 1 kHz, a drive of one pole at {} Hz leaves {} of the rms.",
        drives.map(|hertz| three(Some(hertz))).join(", "),
        drives.map(|hertz| three(Some(noise_behind(hertz)))).join(", ")
    );
    let rows: [[&str; 3]; 8] = [
        [
            "Abstract, Sec. VIII",
            "few parameters, intuitive to find",
            "`phihat compare` measures the share of gains near the default that work.",
        ],
        ["Remark 2", "drives and supplies suppress the noise", &noise],
        [
            "Remark 3",
            "q̈ stands in (5) only to save an estimate of q̈",
            "It does: (9) and (10) take e, ė and integrals. It also fixes M̄ (remark5-parameters).",
        ],
        [
            "Remark 4",
            "m = 2 is sufficient",
            "No criterion is given. Mismatch and overshoot of the orders: fig8-order, fig13-real, fig5-overshoot.",
        ],
        [
            "Remark 11",
            "the largest |φ| is relatively easy to estimate",
            "No procedure is given, and φ contains q̈: its size depends on the gains that are to be found from it.",
        ],
        [
            "Sec. V-A",
            "no analytical solution for m ≥ 2",
            "Not decided here. Newton's method solves the rows for m = 2 and 3 (Table 2); for m = 1 see analytical-first.",
        ],
        [
            "Sec. VI",
            "all limitations of the other controllers are addressed",
            "Measured column by column by `phihat compare studies/table1.toml`, as far as a column can be measured.",
        ],
        [
            "Table 1",
            "quantitative performance, easy tuning, optimal",
            "The same; the last column is in the section on Table 1.",
        ],
    ];
    Section {
        id: "without-a-number".to_owned(),
        title: "Stated without a number".to_owned(),
        text: words(&[
            "These sentences give no value, law or criterion that a computation could meet or miss. They have no verdict and are \
             not counted.",
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
