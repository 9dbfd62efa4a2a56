//! The names of rivals and worlds on the page.

use maud::{Markup, html};
use phihat_report::kit::anchor;
use phihat_report::kit::text::line;

use crate::record::Comparison;
use crate::row::LawRow;

/// A rival's name for people, else its id.
pub(super) fn title(comparison: &Comparison, id: &str) -> String {
    line(comparison.rival(id).map_or(id, |rival| &rival.title))
}

/// A rival's name with a link to its card, and its grade.
pub(super) fn named(comparison: &Comparison, row: &LawRow) -> Markup {
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
