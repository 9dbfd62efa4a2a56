//! m = 2.

use phihat_design::claims::paper::Feedback;
use phihat_design::claims::{Attenuation, ErrorLimits, MinimalGains, UnitLaw, polynomial};
use phihat_design::prelude::*;

use super::column::{COLUMNS, limits, refusal};
use crate::compose::{number, three};
use crate::gains::{PHI_MAX, second_h1, second_h2, second_h3};
use crate::part::PartError;
use crate::published::Published;
use crate::record::{PaperNumber, Statement, Verdict};

/// b_0 = 0.
pub(super) fn a2() -> Result<Statement, PartError> {
    let column = &COLUMNS[3];
    let law = UnitLaw { a: vec![0.0, 1.05 * column.k_tilde], ..column.law() };
    let refused = refusal(&law, column.k_tilde)?;
    let shown = refused.as_ref().map_or_else(|| "certified".to_owned(), ToString::to_string);
    let phi: Vec<_> = column.phi_of_rows(Feedback::Ignored).into_iter().map(three).collect();
    let limits = ErrorLimits { phi_max: PHI_MAX, x_max: limits(2) };
    let roots = MinimalGains::roots(&limits, Feedback::Ignored)?;
    let same = |root: &MinimalGains| (root.k_tilde - column.k_tilde).abs() < 1.0;
    Ok(Published {
        id: "table2-a2",
        place: "Table 2 (A), m = 2",
        claim: "The least gains of order 2 by (44)",
        paper: "174.7, 57, 39.9, b_0 = 0",
    }
    .found(
        format!(
            "{shown}; rows need φ_max = {}; at {PHI_MAX} the roots are {}",
            phi.join(", "),
            listed(&roots)
        ),
        Verdict::of(refused.is_none() && roots.iter().any(same), false),
        "b_0 = 0 violates A1: Q and S are singular, (40) is infinite, and a_0 = 0 makes it an estimator of order 1 \
         with an idle state. No single φ_max gives the four numbers, and no root at 22.2 is near them.",
        [number("Q_11", "", refused.map(|r| r.value), 1e-9)]
            .into_iter()
            .chain(numbers_of(&roots))
            .collect(),
    )
    .assuming(&["phi-max"]))
}

/// K̃ = 63.4, 100, 20, 20: the one column with a certificate at m = 2.
pub(super) fn b2() -> Result<Statement, PartError> {
    let column = &COLUMNS[4];
    let law = column.law();
    let raised = UnitLaw { a: law.a.iter().map(|a| 1.05 * a).collect(), ..law };
    let refused = refusal(&raised, column.k_tilde)?;
    let rows: Vec<f64> = column.phi_of_rows(Feedback::Included).into_iter().flatten().collect();
    let [low, high] = [f64::min as fn(f64, f64) -> f64, f64::max]
        .map(|f| rows.iter().copied().reduce(f).unwrap_or(f64::NAN));
    let limits = ErrorLimits { phi_max: PHI_MAX, x_max: limits(2) };
    let roots = MinimalGains::roots(&limits, Feedback::Included)?;
    let same = high / low < 1.01 && (low / PHI_MAX - 1.0).abs() < 0.01;
    Ok(Published {
        id: "table2-b2",
        place: "Table 2 (B), m = 2",
        claim: "The least gains of order 2 with xᵀSBBᵀSx included",
        paper: "63.4, 100, 20, b_0 = 20",
    }
    .found(
        format!(
            "rows need φ_max = {} … {}; at {PHI_MAX} the roots are {}",
            three(low.into()),
            three(high.into()),
            listed(&roots)
        ),
        Verdict::of(same, false),
        format!(
            "{} The first row is an equality at φ_max = 44.4, twice 22.2, to the last printed digit; the other rows \
             then fall short by up to {:.0} %. All rows hold for φ_max up to {}. One root has exactly the printed K_p \
             and K_d, with another K̃ and b_0; it may be the one that the paper had. Its K̃ and b_0 are the least and \
             its K_p and K_d the largest of the roots: none is the least in every gain, and the paper does not say \
             which one it takes. `design --method paper` takes the least K̃.",
            if refused.is_none() { "The only column of m = 2 that satisfies A1 to A3." } else { "No certificate." },
            100.0 * (1.0 - low / high),
            three(low.into())
        ),
        vec![
            number("least φ_max of a row", "", low, 1e-9),
            number("largest φ_max of a row", "", high, 1e-9),
        ]
        .into_iter()
        .chain(numbers_of(&roots))
        .collect(),
    )
    .assuming(&["phi-max"]))
}

/// `(K̃, K_p, K_d, b_0)` of each root.
fn listed(roots: &[MinimalGains]) -> String {
    let one = |root: &MinimalGains| {
        let b_0 = root.b.first().copied().unwrap_or(f64::NAN);
        format!("({:.1}, {:.1}, {:.2}, {b_0:.2})", root.k_tilde, root.kp, root.kd)
    };
    roots.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// Their count, and the gains of the one of least K̃.
fn numbers_of(roots: &[MinimalGains]) -> impl Iterator<Item = PaperNumber> {
    let gain = |of: fn(&MinimalGains) -> f64| roots.first().map(of);
    [
        number("roots of (44)", "", roots.len() as f64, 0.0),
        number("least K̃ of a root", "1/s", gain(|root| root.k_tilde), 1e-6),
        number("K_p of that root", "1/s²", gain(|root| root.kp), 1e-6),
        number("K_d of that root", "1/s", gain(|root| root.kd), 1e-6),
    ]
    .into_iter()
}

/// (C), m = 2.
pub(super) fn c2() -> Result<Statement, PartError> {
    let column = &COLUMNS[5];
    let refused = refusal(&second_h1(), column.k_tilde)?;
    let at_any = |law: &UnitLaw| Attenuation::of(law);
    let (h1, h2, h3) = (
        at_any(&second_h1())?.return_difference,
        at_any(&second_h2())?.return_difference,
        at_any(&second_h3())?.return_difference,
    );
    let halved = refusal(&second_h3(), column.k_tilde)?;
    let halved_said = halved.as_ref().map_or_else(|| "certified".to_owned(), ToString::to_string);
    let stable = polynomial::is_hurwitz(&second_h1().denominator(1.0));
    let shown = refused.as_ref().map_or_else(|| "certified".to_owned(), ToString::to_string);
    Ok(Published {
        id: "table2-c2",
        place: "Table 2 (C), m = 2",
        claim: "The gains that were used satisfy A1 to A3",
        paper: "68.9, 400, 40, b_0 = 69.6",
    }
    .found(
        format!(
            "{shown}; K̃ that works: H1 {}, H2 {}, H3 above {}; H3 at the printed K̃: {halved_said}",
            three(h1),
            three(h2),
            three(h3)
        ),
        Verdict::of(refused.is_none(), false),
        format!(
            "A3 asks for K̃ > 2b_0 = 139.2. Theorems 2, 3 and 5 say nothing about the gains of the experiments, \
             whatever γ was: b_0 = 69.6 with K̃ < a_1 needs a_1² > 2a_0, estimator damping above 1/√2. The loop itself \
             is {} at M = 1. To halve b_0 (H3) is not enough either: A3 then asks for K̃ > 69.6, and 68.9 is printed. \
             Only with b_0 halved and K̃ raised is there a certificate; these are other gains, not a correction of \
             these.",
            if stable { "stable" } else { "unstable" }
        ),
        vec![
            number("Q_44", "", refused.map(|r| r.value), 1e-6),
            number("K̃ that works, H1", "1/s", h1, 1e-6),
            number("K̃ that works, H2", "1/s", h2, 1e-6),
            number("least K̃, H3", "1/s", h3, 1e-6),
            number("Q_44, H3 at the printed K̃", "", halved.map(|r| r.value), 1e-6),
        ],
    )
    .assuming(&["gains"]))
}
