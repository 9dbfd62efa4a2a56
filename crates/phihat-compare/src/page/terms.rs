//! The terms of the comparison, and what it does not show.

use crate::Comparison;
use maud::{Markup, html};

use super::words::{self, DEFAULTS, UNITS};
use phihat_report::kit::number::{number, stated};
use phihat_report::kit::text::line;

pub(super) fn fairness(comparison: &Comparison, command: &str) -> Markup {
    let terms = &comparison.fairness;
    let (motions, length) = terms.training;
    html! {
        h2 id="terms" { "Terms" }
        dl {
            dt { "optimiser" } dd { (line(&terms.optimiser)) }
            dt { "budget" } dd {
                (terms.tuning_runs) " evaluations for every law with a free scalar, on every arm"
                @if terms.widenings > 0 { ", and as many again up to " (terms.widenings) " times where the best gains \
                    are at an end of a range, which is then widened tenfold" }
            }
            dt { "tuned on" } dd { (motions) @if motions == 1 { " motion of " } @else { " motions \
                of " } (stated(length)) " s in the worlds “" (line(&terms.training_worlds.join("”, “"))) "”" }
            dt { "scored on" } dd { (terms.seeds) @if terms.seeds == 1 { " other motion of " } @else { " other motions \
                of " } (stated(terms.scored_s)) " s in every world" @if terms.seeds > 1 { "; the study's own is the \
                first" } @else { ": the study's own" } }
            dt { "nominal model" } dd { "links " (stated(terms.nominal_masses)) " times as heavy as the arm's, for \
                every law that is handed a model, in every world" }
            dt { "cap on torque noise" } dd { (stated(terms.noise_cap)) " of the joint's torque limit, for tuned \
                gains" }
            dt { "share of draws" } dd { (terms.draws) " draws of gains within a decade of the default ones" }
            dt { "scalars" } dd { (UNITS) }
            dt { "default gains" } dd { (DEFAULTS) }
            @for world in &comparison.worlds { dt { "world \
                “" (line(&world.name)) "”" } dd { (words::world(comparison, world)) } }
            @for arm in &comparison.arms {
                dt { "arm " (line(&arm.name)) }
                dd { (line(&arm.robot)) ", " (arm.joints.len()) " joints, " (line(&arm.study)) ", U \
                    = " (inertia(&arm.inertia)) " kg·m²" span.hash { " SHA-256 " (line(&arm.study_sha256)) } }
            }
        }
        @for note in &terms.notes { p { (line(note)) } }
        p { "Made again by " code { (line(command)) } "." }
    }
}

fn inertia(units: &[f64]) -> String {
    units.iter().map(|unit| number(*unit)).collect::<Vec<_>>().join(", ")
}

pub(super) fn not_claimed() -> Markup {
    html! {
        h2 id="not-claimed" { "Not claimed" }
        p {
            "Every run is simulated, on arms, motions and worlds that this project chose. That the gains are the best \
                a law can have: they are the best of "
            "a fixed number of runs. That these laws are their authors' programs: see each one's grade. That a law \
                which is ahead here is ahead "
            "on another arm. A share of draws depends on the range it is drawn from, and a default gain was often \
                chosen for another arm."
        }
    }
}
