//! The page of one run of a comparison: what the arm did under a law that is not this project's.

use maud::{Markup, PreEscaped, html};
use phihat_sim::Metrics;

use phihat_report::kit::Page;
use phihat_report::kit::number::stated;
use phihat_report::kit::text::{line, visible};
use phihat_report::{Drawing, RunMeasurements, run_figures, torque, tracking};

/// One run of a comparison.
#[derive(Debug, Clone, Copy)]
pub struct PageTrial<'a> {
    /// Its name, `ARM/RIVAL/WORLD/default|tuned/SEED`.
    pub name: &'a str,
    /// The law's name for people.
    pub law: &'a str,
    /// Its scalars: name, value, unit.
    pub gains: &'a [(String, f64, String)],
    /// Reason of an early end; `None` if the run reached its end.
    pub ended: Option<&'a str>,
    /// The study that was run, as text.
    pub study: &'a str,
    /// Signals that are drawn.
    pub drawing: &'a Drawing,
    /// The figures of the run.
    pub metrics: &'a Metrics,
    /// The command that makes it again.
    pub command: &'a str,
}

/// The self-contained page of a run. φ is the torque beside `U q̈`, in the law's own unit of inertia; a law without
/// an estimate of it has none.
pub fn trial_page(trial: &PageTrial<'_>) -> String {
    let title = line(trial.name);
    let main = html! {
                header {
                    h1 { (title) }
                    p.byline { (line(trial.law)) " · simulated" }
                    @if let Some(why) = trial.ended { p.verdict.outside { strong { "The run ended \
                        early." } " " (line(why)) } }
                }
                (tracking(trial.metrics))
                (torque(trial.metrics))
                h2 { "Figures" }
                div { @for figure in run_figures(&RunMeasurements { drawing: trial.drawing, metrics: trial.metrics,
                    envelope: None }) {
                    @if !["unknown-dynamics", "estimate-error"].contains(&figure.name.as_str()) { figure.claim {
                        (PreEscaped(&figure.svg)) } }
                } }
                (gains(trial))
                h2 { "Study" }
                pre tabindex="0" { (visible(trial.study)) }
                p { "Made again by " code { (line(trial.command)) } "." }
                h2 { "Not claimed" }
                p { "One simulated run of a law as it is written here: not its authors' program, and nothing about \
                    other runs." }
    };
    Page { title: &title, kind: "comparison", script: None }.document(&main)
}

fn gains(trial: &PageTrial<'_>) -> Markup {
    html! {
        h2 { "Gains" }
        @if trial.gains.is_empty() { p { "The law has no free scalar." } }
        dl { @for (name, value, unit) in trial.gains {
            dt { (line(name)) }
            dd { (stated(*value)) " " (line(unit)) }
        } }
    }
}
