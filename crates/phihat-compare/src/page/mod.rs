//! The page of a comparison: every rival on every arm in every world, and where another row is better.

use crate::{ArmRecord, Cell, Comparison, Fate, LIMITED, Row, SATURATION};
use maud::{Markup, html};

use phihat_report::kit::text::line;
use phihat_report::kit::{Page, anchor};

mod axis;
mod cards;
mod figures;
mod heat;
mod labels;
mod losses;
mod quantity;
mod scatter;
mod summary;
mod terms;
mod ticks;
mod traces;
mod trial;
mod words;

pub use figures::comparison_table;
pub use losses::{Beaten, Loss, losses};
pub use trial::{Trial, trial_page};
pub use words::{DEFAULTS, NOT_TUNED, UNITS, model_free, model_free_in_full};

const STYLE: &str = include_str!("comparison.css");
/// What sorts the tables.
const SCRIPT: &str = include_str!("comparison.js");

/// The self-contained page of a comparison. `command` is the one that made it: every run's is made from it.
///
/// The page works without its script, which only sorts tables and opens what a link points at.
pub fn comparison_page(comparison: &Comparison, command: &str) -> String {
    let arms: Vec<_> = comparison.arms.iter().map(|arm| line(&arm.name)).collect();
    let title = format!("Rivals compared: {}", arms.join(", "));
    let main = html! {
        (summary::heading(comparison, &title))
        (summary::another_row(comparison))
        @for arm in &comparison.arms { (arm_part(comparison, arm)) }
        (traces::traces(comparison, command))
        (cards::cards(comparison))
        (terms::fairness(comparison, command))
        (terms::not_claimed())
    };
    Page { title: &title, style: STYLE, script: Some(SCRIPT) }.document(&main)
}

fn arm_part(comparison: &Comparison, arm: &ArmRecord) -> Markup {
    html! {
        h2 id=(anchor("arm", &arm.name)) { (line(&arm.name)) ": " (line(&arm.robot)) }
        (figures::tables(comparison, arm))
        (scatter::plots(comparison, arm))
        (heat::map(comparison, arm))
        (ticks::table(comparison, arm))
    }
}

/// A rival's name for people, else its id.
fn title(comparison: &Comparison, id: &str) -> String {
    line(comparison.rival(id).map_or(id, |rival| &rival.title))
}

/// A rival's name with a link to its card, and its grade.
fn named(comparison: &Comparison, row: &Row) -> Markup {
    let rival = comparison.rival(&row.rival);
    html! {
        a href=(format!("#{}", anchor("rival", &row.rival))) { (title(comparison, &row.rival)) }
        @if let Some(rival) = rival.filter(|rival| !rival.reference.is_empty()) {
            " " span.unit { (line(&rival.reference)) }
        }
    }
}

/// The world whose figures stand in the table of every arm: the first that gains are tuned in, else the first.
pub fn main_world(comparison: &Comparison) -> Option<&str> {
    let tuned = comparison.fairness.training_worlds.first();
    let worlds = || comparison.worlds.iter().map(|world| world.name.as_str());
    worlds().find(|name| tuned.is_some_and(|tuned| tuned == name)).or_else(|| worlds().next())
}

/// What became of a run: a symbol and a word, so that no colour is needed.
fn fate(fate: &Fate) -> (&'static str, &'static str) {
    match fate {
        Fate::Followed => ("✓", "followed"),
        Fate::Lost { .. } => ("▲", "did not follow"),
        Fate::Diverged { .. } => ("✗", "diverged"),
        Fate::NotFinite { .. } => ("⊘", "not a number"),
        Fate::Refused(_) => ("–", "does not apply"),
        Fate::Panicked(_) => ("‼", "program fault"),
    }
}

/// What is wrong with an arm that followed all the same: its torque is noisier than tuned gains may be in
/// training, or it lives on limits that leave room for the motion, as in a limit cycle. In short, and in full.
fn unrest(comparison: &Comparison, cell: &Cell) -> Option<(&'static str, String)> {
    let figures = cell.worst.as_ref().filter(|_| cell.fate.followed())?;
    // There the limits are drawn in on purpose.
    let limited = figures.saturated > LIMITED && cell.world != SATURATION;
    let (noise, cap) = (figures.noise, comparison.fairness.noise_cap);
    if limited {
        let share = two_digits(100.0 * figures.saturated);
        return Some(("≈ at limits", format!("≈ {share} % of samples at a torque limit")));
    }
    (noise > cap)
        .then(|| ("≈ noisy", format!("≈ {} times the cap on noise", two_digits(noise / cap))))
}

/// Two significant digits.
fn two_digits(value: f64) -> String {
    phihat_report::kit::number::stated(format!("{value:.1e}").parse().unwrap_or(value))
}

/// The same with time, joint or reason.
fn fate_in_full(of: &Fate) -> String {
    let word = fate(of).1;
    match of {
        Fate::Followed => word.to_owned(),
        Fate::Lost { joint } => format!("{word}: {}", line(joint)),
        Fate::Diverged { t, joint } | Fate::NotFinite { t, joint } => {
            format!("{word} at {} s: {}", phihat_report::kit::number::stated(*t), line(joint))
        }
        Fate::Refused(why) | Fate::Panicked(why) => format!("{word}: {}", line(why)),
    }
}
