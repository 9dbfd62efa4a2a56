//! Table 2: which of its numbers follow from the formulas, printed and corrected, and what the gains are worth.

mod column;
mod first;
mod second;

use phihat_design::claims::paper::Feedback;
use phihat_design::claims::{ErrorLimits, MinimalGains, UnitLaw, polynomial};

use super::compose::{number, three, words};
use super::gains::PHI_MAX;
use super::published::Published;
use super::record::{Section, Statement, Table, Verdict};
use crate::part::{Extent, PaperPart, PartError};
use column::{COLUMNS, Table2Column, limits};
use first::{a1, b1, c1, equal_rows, kd_sign};
use second::{a2, b2, c2};

/// Everything about Table 2.
pub(super) fn table2(_: Extent, progress: &dyn Fn(f64)) -> Result<PaperPart, PartError> {
    let mut statements = vec![a1()?, kd_sign()];
    progress(0.2);
    statements.extend([b1()?, equal_rows()?, a2()?, b2()?]);
    progress(0.7);
    statements.extend([c1()?, c2()?, higher(), results_show(), number_of_table()]);
    let tables = vec![rows_table(), newton_table()?];
    progress(1.0);
    let section = Section {
        id: "table-2".to_owned(),
        title: "Table 2: control parameters".to_owned(),
        text: words(&[
            "Columns (A) ignore xᵀSBBᵀSx, columns (B) include it, columns (C) were used. φ_max is not printed. Each \
             row of (44) is solved here for the φ_max at which it is an equality: a column that comes from (44) \
             has the same one in all rows.",
        ]),
        statements,
        tables,
        figures: Vec::new(),
    };
    Ok(PaperPart { assumptions: Vec::new(), sections: vec![section] })
}

/// "Higher than required".
fn higher() -> Statement {
    let below = |used: &Table2Column, least: &Table2Column| {
        let pairs = [(used.k_tilde, least.k_tilde), (used.kp, least.kp), (used.kd, least.kd)];
        pairs.iter().filter(|(used, least)| used < least).count()
    };
    let (one, two) = (below(&COLUMNS[2], &COLUMNS[0]), below(&COLUMNS[5], &COLUMNS[3]));
    let factors = [&COLUMNS[0], &COLUMNS[3]].map(|a| a.k_tilde / COLUMNS[2].k_tilde);
    let of_b = below(&COLUMNS[2], &COLUMNS[1]) + below(&COLUMNS[5], &COLUMNS[4]);
    Published {
        id: "table2-higher",
        place: "Sec. VII-A",
        claim: "The gains that were used are higher than required",
        paper: "higher than the required values",
    }
    .found(
        format!("below column (A): {one} gain at m = 1, {two} at m = 2 (K̃ = 68.9 < 222, 174.7); below (B): {of_b}"),
        Verdict::of(one + two + of_b == 0, of_b == 0),
        format!(
            "They are not lower than columns (B). The K̃ of columns (A) is {:.1} and {:.1} times what was used (m = 1, \
                2).",
            factors[0], factors[1]
        ),
        vec![
            number("gains below column (A)", "", (one + two) as f64, 0.0),
            number("gains below column (B)", "", of_b as f64, 0.0),
            number("K̃ of (A) over that of (C), m = 1", "", factors[0], 1e-9),
            number("K̃ of (A) over that of (C), m = 2", "", factors[1], 1e-9),
        ],
    )
}

/// "In the results section, it will be shown that A2 is … not necessary."
fn results_show() -> Statement {
    let without = || COLUMNS.iter().filter(|c| c.kd * c.kd <= 2.0 * c.kp);
    let stable_at = |kd: f64| {
        let stable = |law: UnitLaw| polynomial::is_hurwitz(&law.denominator(1.0));
        without().filter(|c| stable(UnitLaw { kd: c.kd + kd, ..c.law() })).count()
    };
    // 0 < K_d < 0.05 is printed as 0.0.
    let (stable, rounded) = (stable_at(0.0), stable_at(0.025));
    let listed: Vec<_> = without()
        .map(|c| {
            format!(
                "{}: K_d² = {}, 2K_p = {}",
                c.name,
                three(Some(c.kd * c.kd)),
                three(Some(2.0 * c.kp))
            )
        })
        .collect();
    let pole = without().map(|c| (c.kp - c.kd * c.kd / 4.0).sqrt()).next();
    Published {
        id: "results-show-a2",
        place: "After Theorem 2; Table 2",
        claim: "The results show that A2 is not necessary for stability",
        paper: "in the results section it will be shown",
    }
    .found(
        format!("columns without A2: {}; of these stable: {stable}, poles of (4) at ±{}j; with K_d = 0.025, printed as \
            0.0: {rounded}", listed.join("; "), three(pole)),
        if rounded > 0 { Verdict::assumed(stable > 0, false) } else { Verdict::of(stable > 0, false) },
        "That A2 is not necessary is true (theorem2-a2). Whether the results show it depends on the rounding of one \
         number: with K_d = 0 exactly the only gains that violate A2 leave (4) undamped; a K_d between 0 and 0.05 is \
         printed as 0.0, violates A2, and is stable. That column was not used.",
        vec![
            number("columns without A2", "", without().count() as f64, 0.0),
            number("of these stable", "", stable as f64, 0.0),
            number("of these stable with a K_d that is printed as 0.0", "", rounded as f64, 0.0),
        ],
    )
}

/// "Mentioned in table 1".
fn number_of_table() -> Statement {
    Published {
        id: "erratum-table-number",
        place: "Sec. VII-A",
        claim: "The control parameters stand in Table 1",
        paper: "table 1",
    }
    .found(
        "Table 2 has gains, Table 1 has ticks",
        Verdict::of(false, COLUMNS.iter().all(|column| column.kp > 0.0)),
        "Table 2.",
        Vec::new(),
    )
}

fn rows_table() -> Table {
    let row = |column: &Table2Column, feedback| {
        let cells = column.phi_of_rows(feedback).into_iter().map(three);
        let mut cells: Vec<String> = cells.collect();
        cells.resize(4, "—".to_owned());
        let term = if feedback == Feedback::Included { "with" } else { "without" };
        [column.name.to_owned(), term.to_owned()].into_iter().chain(cells).collect()
    };
    let both = [Feedback::Ignored, Feedback::Included];
    Table {
        id: "table-2-rows".to_owned(),
        title: "φ_max at which each row of (44) is an equality at the printed gains; a_{m−1} = K̃"
            .to_owned(),
        columns: words(&["column", "xᵀSBBᵀSx", "row 1", "row 2", "row 3", "row 4"]),
        rows: COLUMNS.iter().flat_map(|c| both.map(|feedback| row(c, feedback))).collect(),
    }
}

fn newton_table() -> Result<Table, PartError> {
    let mut rows = Vec::new();
    for order in 1..=3 {
        for (feedback, letter) in [(Feedback::Ignored, "A"), (Feedback::Included, "B")] {
            let x_max = match order {
                3 => vec![1e-5, 1e-4, 1e-3, 1e-2, 1e-1],
                _ => limits(order),
            };
            let limits = ErrorLimits { phi_max: PHI_MAX, x_max };
            rows.extend(MinimalGains::roots(&limits, feedback)?.iter().map(|root| {
                let b: Vec<_> = root.b.iter().map(|b| three((*b).into())).collect();
                words(&[
                    format!("m = {order} ({letter})"),
                    three(root.k_tilde.into()),
                    three(root.kp.into()),
                    three(root.kd.into()),
                    if b.is_empty() { "—".to_owned() } else { b.join(", ") },
                ])
            }));
        }
    }
    Ok(Table {
        id: "table-2-newton".to_owned(),
        title: format!(
            "All gains at which every row of (44) is an equality, as found by Newton's method from 401 points, φ_max = \
                {PHI_MAX}"
        ),
        columns: words(&["column", "K̃ [1/s]", "K_p [1/s²]", "K_d [1/s]", "b_0, b_1"]),
        rows,
    })
}
