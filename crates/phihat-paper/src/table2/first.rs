//! m = 1.

use phihat_design::claims::paper::Feedback;
use phihat_design::claims::{Attenuation, ErrorLimits, MinimalGains, UnitLaw};
use phihat_design::prelude::*;

use super::column::{COLUMNS, limits, refusal};
use crate::compose::{number, three};
use crate::gains::{PHI_MAX, first};
use crate::part::PartError;
use crate::published::Published;
use crate::record::{Statement, Verdict};

/// `c = φ_max/(K̃ e_max)` and `√(c² + 2K_p)`.
fn terms(k_tilde: f64, kp: f64, phi: f64) -> (f64, f64) {
    let c = phi / (k_tilde * 1e-2);
    (c, (c * c + 2.0 * kp).sqrt())
}

/// K̃ = 222, K_p = 200, K_d = 32.3.
pub(super) fn a1() -> Result<Statement, PartError> {
    let column = &COLUMNS[0];
    let limits = ErrorLimits { phi_max: PHI_MAX, x_max: limits(1) };
    let least = MinimalGains::first_order(&limits)?;
    let kp = 2.0 * PHI_MAX / (column.k_tilde * 1e-3);
    let (c, root) = terms(column.k_tilde, kp, PHI_MAX);
    let near = |value: f64, printed: f64, digit: f64| (value - printed).abs() <= digit;
    let all = near(least.k_tilde, column.k_tilde, 0.5)
        && near(least.kp, column.kp, 0.5)
        && near(least.kd, column.kd, 0.1);
    let half = near(least.k_tilde / 2.0, column.k_tilde, 0.5)
        && near(kp, column.kp, 0.5)
        && near(c + root, column.kd, 0.1);
    Ok(Published {
        id: "table2-a1",
        place: "Table 2 (A), m = 1",
        claim: "K̃, K_p and K_d are the least that (44) allows",
        paper: "222, 200, 32.3",
    }
    .found(
        format!(
            "φ_max = {PHI_MAX}: {}, {}, {}; with K̃ halved: 222, {}, {:.2}",
            three(least.k_tilde.into()),
            three(least.kp.into()),
            three(least.kd.into()),
            three(kp.into()),
            c + root
        ),
        Verdict::of(all, half),
        "K_p = 200 and K_d = 32.3 follow from K̃ = 222 with φ_max = 22.2, and from no other. Then K̃ > 2φ_max/ė_max is \
         444: 222 has lost a factor of 2. With K̃ = 444 the least gains are K_p = 100, K_d = 20.",
        vec![
            number("K̃ by (44)", "1/s", least.k_tilde, 1e-9),
            number("K_p from K̃ = 222", "1/s²", kp, 1e-9),
            number("K_d from K̃ = 222, + c", "1/s", c + root, 1e-9),
            number("K_p by (44)", "1/s²", least.kp, 1e-9),
            number("K_d by (44)", "1/s", least.kd, 1e-9),
        ],
    )
    .assuming(&["phi-max"]))
}

/// The sign of c.
pub(super) fn kd_sign() -> Statement {
    let column = &COLUMNS[0];
    let (c, root) = terms(column.k_tilde, column.kp, PHI_MAX);
    // Row 2 of (44): ½K̃(K_d² − 2K_p) e_max against K_d φ_max.
    let solves = |kd: f64| {
        let row = 0.5 * column.k_tilde * (kd * kd - 2.0 * column.kp) * 1e-2;
        (row - kd * PHI_MAX).abs() < 1e-9 * kd * PHI_MAX
    };
    Published {
        id: "erratum-kd",
        place: "After (44)",
        claim: "K_d > √(2K_p + c²) − c solves the second row of (44)",
        paper: "− c",
    }
    .found(
        format!("− c: {:.2}, row not met; + c: {:.2}, as in the table", root - c, root + c),
        Verdict::of(solves(root - c), solves(root + c)),
        "K_d² − 2cK_d − 2K_p > 0 has its positive root at c + √(c² + 2K_p). The table's own 32.3 has the plus; with \
         the minus, B2 is violated as well.",
        vec![number("K_d with − c", "1/s", root - c, 1e-9), number("K_d with + c", "1/s", root + c, 1e-9)],
    )
    .assuming(&["phi-max"])
}

/// K̃ = 3.3, K_p = 78, K_d = 0.
pub(super) fn b1() -> Result<Statement, PartError> {
    let column = &COLUMNS[1];
    let law = UnitLaw { a: vec![1.1 * column.k_tilde], ..column.law() };
    let refused = refusal(&law, column.k_tilde)?;
    let limits = ErrorLimits { phi_max: PHI_MAX, x_max: limits(1) };
    let ours = MinimalGains::newton(&limits, Feedback::Included)?;
    let shown = refused.as_ref().map_or_else(|| "certified".to_owned(), ToString::to_string);
    let rows = column.phi_of_rows(Feedback::Included).into_iter().flatten();
    let rows: Vec<_> = rows.map(|phi| three(phi.into())).collect();
    let printed = (ours.k_tilde - column.k_tilde).abs() < 0.1 && (ours.kp - column.kp).abs() < 1.0;
    Ok(Published {
        id: "table2-b1",
        place: "Table 2 (B), m = 1",
        claim: "K̃, K_p and K_d are the least with xᵀSBBᵀSx included",
        paper: "3.3, 78, 0.0",
    }
    .found(
        format!("{shown}; Newton at φ_max = {PHI_MAX}: {:.1}, {:.1}, {:.1}", ours.k_tilde, ours.kp, ours.kd),
        Verdict::of(printed && refused.is_none(), false),
        format!(
            "K_d = 0 violates B2, and the outer loop would not be damped at all. The rows without K_d ask for φ_max = \
             {}, the row with it has no solution.",
            rows.join(" and ")
        ),
        vec![
            number("Q_22", "", refused.map(|r| r.value), 1e-9),
            number("K̃ by Newton", "1/s", ours.k_tilde, 1e-6),
            number("K_p by Newton", "1/s²", ours.kp, 1e-6),
            number("K_d by Newton", "1/s", ours.kd, 1e-6),
        ],
    )
    .assuming(&["phi-max"]))
}

/// At m = 1 two of three gains do not depend on φ_max, γ, or whether the term counts.
pub(super) fn equal_rows() -> Result<Statement, PartError> {
    let mut spread: f64 = 0.0;
    for phi_max in [0.4, 11.1, 22.2, 200.0] {
        for feedback in [Feedback::Ignored, Feedback::Included] {
            let limits = ErrorLimits { phi_max, x_max: limits(1) };
            let found = MinimalGains::newton(&limits, feedback)?;
            spread =
                spread.max((found.kp - 100.0).abs() / 100.0).max((found.kd - 20.0).abs() / 20.0);
        }
    }
    let printed =
        COLUMNS[..2].iter().all(|c| (c.kp - 100.0).abs() < 1.0 && (c.kd - 20.0).abs() < 0.1);
    Ok(Published {
        id: "table2-equal-rows",
        place: "Table 2 (A), (B), m = 1",
        claim: "Both columns solve (44) at the limits (48), for some φ_max and γ",
        paper: "K_p 200 and 78, K_d 32.3 and 0",
    }
    .found(
        format!("K_p = 100 and K_d = 20 at every φ_max, with and without the term, to {spread:.0e}"),
        Verdict::of(printed && spread < 1e-6, false),
        "Divided by (SB)_i, the rows differ only in Q_ii x_i/(SB)_i: the term and φ_max are the same in all. Rows 1 \
         and 3 give K_p = ė_max/∫e_max, rows 2 and 3 K_d − 2K_p/K_d = ė_max/e_max. No choice of φ_max or γ \
         gives the columns; other limits than (48) would, but they differ between (A) and (B).",
        vec![number("largest relative deviation from 100 and 20", "", spread, 1e6)],
    )
    .again())
}

/// (C), m = 1.
pub(super) fn c1() -> Result<Statement, PartError> {
    let refused = refusal(&first(), COLUMNS[2].k_tilde)?;
    let least = Attenuation::of(&first())?.gamma_diagonal;
    let k_tilde = COLUMNS[2].k_tilde;
    let gamma = (first().a_top() - k_tilde).sqrt().recip();
    Ok(Published {
        id: "table2-c1",
        place: "Table 2 (C), m = 1",
        claim: "The gains that were used satisfy B1 and B2",
        paper: "68.9, 400, 40",
    }
    .found(
        format!(
            "{}; γ = {} at the printed K̃ = {k_tilde} and a_0 = {}; down to {} at a smaller K̃",
            if refused.is_none() { "certified" } else { "refused" },
            three(gamma.into()),
            first().a_top(),
            three(least)
        ),
        Verdict::of(refused.is_none(), false),
        "B2: 1600 > 800. The law has a_0 alone, which is assumed here; K̃ is part of the proof: any K̃ in (0, a_0) \
         gives a certificate, each for its own cost; the smallest γ belongs to K̃ → 0.",
        vec![
            number("γ at the printed K̃", "", gamma, 1e-9),
            number("infimum of γ over K̃", "", least, 1e-6),
        ],
    )
    .assuming(&["gains"]))
}
