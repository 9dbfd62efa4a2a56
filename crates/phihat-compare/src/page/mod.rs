//! The page of a comparison: every rival on every arm in every world, and where another row is better.

use crate::{ArmRecord, Comparison};
use maud::{Markup, html};

use phihat_report::kit::text::line;
use phihat_report::kit::{Page, anchor};

mod cards;
mod figures;
mod heat;
mod losses;
mod names;
mod outcome;
mod quantity;
mod scatter;
mod story;
mod summary;
mod terms;
mod ticks;
mod traces;
mod trial;
mod words;

pub use figures::comparison_table;
pub use losses::{Beaten, LossOfLaw, losses};
pub use names::main_world;
pub use trial::{PageTrial, trial_page};
pub use words::{DEFAULTS, NOT_TUNED, UNITS, model_free, model_free_in_full};

/// Script that sorts the tables.
const SCRIPT: &str = include_str!("comparison.js");

/// The self-contained page of a comparison. `command` is the one that made it: every run's is made from it.
///
/// The page works without its script, which only sorts tables and opens what a link points at.
pub fn comparison_page(comparison: &Comparison, command: &str) -> String {
    let arms: Vec<_> = comparison.arms.iter().map(|arm| line(&arm.name)).collect();
    let title = format!("Rivals compared: {}", arms.join(", "));
    let main = html! {
        (summary::heading(comparison, &title))
        @for arm in &comparison.arms {
            h2 id=(anchor("arm", &arm.name)) { (line(&arm.name)) ": " (line(&arm.robot)) }
            (story::story(comparison, arm))
        }
        h2 id="details" { "Behind it" }
        @for arm in &comparison.arms { (arm_part(comparison, arm)) }
        (folded("When to pick another row", &summary::another_row(comparison)))
        (folded("Every cell and its trace", &traces::traces(comparison, command)))
        (folded("The laws", &cards::cards(comparison)))
        (terms::fairness(comparison, command))
        (terms::not_claimed())
    };
    Page { title: &title, kind: "comparison", script: Some(SCRIPT) }.document(&main)
}

/// A part that is opened by a click, or by a link into it.
fn folded(title: &str, body: &Markup) -> Markup {
    html! { details.behind { summary { (title) } (body) } }
}

fn arm_part(comparison: &Comparison, arm: &ArmRecord) -> Markup {
    let body = html! {
        (figures::tables(comparison, arm))
        (scatter::plots(comparison, arm))
        (heat::map(comparison, arm))
        (ticks::table(comparison, arm))
    };
    folded(&format!("All figures of {}", line(&arm.name)), &body)
}
