//! Error budget, and changes that would help.

use phihat_design::budget::{Budget, BudgetBasis, Cause, JointBudget};

use super::{MILLI, align, plain_table};

/// Columns of causes; the rest is on the page.
const SHOWN: [Cause; 7] = [
    Cause::Motion,
    Cause::Friction,
    Cause::Payload,
    Cause::Encoder,
    Cause::Reference,
    Cause::Delay,
    Cause::Coupling,
];

/// One row per joint, and one line per change that was tried.
pub(crate) fn budget(budget: &Budget) -> String {
    let mut lines = Vec::new();
    if let Some(basis) = budget.basis {
        lines.push(joints(&budget.joints));
        lines.push(match basis {
            BudgetBasis::Tube => "(by tubes of these gains, one cause at a time; delay is within the \
                others)".to_owned(),
            BudgetBasis::OwnLoop => {
                "(of the nearest law, each joint by itself: worst cases added up; delay is within the \
                    others)".to_owned()
            }
        });
    }
    for change in &budget.changes {
        let then = match (change.helps, change.error_share) {
            (true, Some(share)) => {
                format!(
                    "then there are gains, which use {:.0} % of the allowed error",
                    100.0 * share
                )
            }
            (true, None) => "then there are gains".to_owned(),
            (false, _) => "still none".to_owned(),
        };
        lines.push(format!("{} ({} = {}): {then}", change.change, change.key, change.value));
    }
    lines.join("\n")
}

fn joints(joints: &[JointBudget]) -> String {
    let has = |cause: &Cause| joints.iter().any(|joint| joint.part(*cause).is_some());
    let causes: Vec<Cause> = SHOWN.into_iter().filter(has).collect();
    let headings = ["joint", "allowed |e|", "together"].map(str::to_owned).into_iter();
    let mut table = plain_table(headings.chain(causes.iter().map(|c| c.words().to_owned())));
    for joint in joints {
        let unit = if joint.prismatic { "mm" } else { "mrad" };
        let cell = |value: Option<f64>| {
            value.map_or_else(|| "–".to_owned(), |value| figure(value * MILLI))
        };
        let first = [
            format!("{} [{unit}]", joint.name),
            cell(joint.error_bound_rad),
            cell(joint.total_rad),
        ];
        let parts = causes.iter().map(|cause| cell(joint.part(*cause)));
        table.add_row(first.into_iter().chain(parts));
    }
    align(&mut table);
    table.to_string()
}

/// Three digits at least, whatever the size.
fn figure(value: f64) -> String {
    let size = value.abs();
    if size >= 100.0 {
        format!("{value:.0}")
    } else if size >= 0.1 || size <= 0.0 {
        format!("{value:.3}")
    } else {
        format!("{value:.2e}")
    }
}
