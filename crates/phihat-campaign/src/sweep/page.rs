//! The page of a sweep: what holds for how many runs, distributions, errors against what varied, the worst runs.

use maud::{Markup, html};
use phihat_report::kit::draw::{FigureSize, svg};
use phihat_report::kit::number::{number, stated};
use phihat_report::kit::text::{key_in_words, line};
use phihat_report::kit::{MILLI, Page};

use super::plot::{DrawnRun, distribution, scatter};
use super::row::SweepRow;
use super::summary::{FigureRecord, Quantile, SweepSummary};

/// Units for people: the factor from those of the data, and the word.
fn people(unit: &str) -> (f64, String) {
    let own = line(unit);
    let milli = ["rad", "m", "rad/s", "rad·s", "m/s"].contains(&own.as_str());
    if milli { (MILLI, format!("m{own}")) } else { (1.0, own) }
}

/// Quantiles of the table.
const SHOWN: [f64; 4] = [0.5, 0.95, 0.99, 0.999];

/// The self-contained page of a sweep; `drawn` are the runs of its pictures.
pub(super) fn sweep_page(summary: &SweepSummary, drawn: &[SweepRow]) -> String {
    let title = format!("Sweep: {}", line(&summary.study));
    let main = html! {
        header {
            h1 { (title) }
            p.byline { "phihat " (line(&summary.phihat_version)) " · " (summary.runs) " runs · \
                seed " (summary.seed) " · simulated" }
            (verdict(summary))
        }
        h2 { "What varied" }
        ul { @for vary in &summary.vary { li {
            b { (key_in_words(&vary.name)) } ": " (range_in_words(&vary.how)) @if !vary.unit.is_empty() {
            "\u{a0}" (line(&vary.unit)) } " " code { (line(&vary.how)) }
        } } }
        h2 { "Errors against what varied" }
        (scatters(summary, drawn))
        h2 { "Distributions" }
        p { "Bars: how many runs, the highest drawn to 0.9; curve: the share of runs at or below a value; dashed: the \
            bound." }
        div.plots { @for figure in summary.figures.iter().filter(|figure| differs(figure)) { figure {
            (drawn_distribution(figure))
        } } }
        @for figure in summary.figures.iter().filter(|figure| !differs(figure)) {
            @let (scale, unit) = people(&figure.unit);
            p { (line(&figure.what)) ": " (shown(scale * figure.least)) @if !unit.is_empty() { "\u{a0}" (unit) } " in \
                every run." }
        }
        h2 { "Figures" }
        p { "Quantiles over all runs that began, with intervals that hold for any distribution with a probability of "
            (stated(100.0 * summary.confidence)) " % each: the order of the values alone decides them. "
            "A run that did not come to its end counts as worse than any number (∞)." }
        (table(summary))
        h2 id="worst" { "The worst runs" }
        p { "Each command repeats its run to the last bit, from the folder of this page." }
        (worst(summary))
        h2 { "Not claimed" }
        p { "Runs are simulated and drawn at random from what was asked for. What lies between them, or outside of it, \
            was not tried; "
            "a share of runs is no certificate." }
    };
    Page { title: &title, kind: "sweep", script: None }.document(&main)
}

/// Distribution of a figure in the units for people.
fn drawn_distribution(figure: &FigureRecord) -> Markup {
    let (scale, unit) = people(&figure.unit);
    let curve: Vec<(f64, f64)> =
        figure.curve.iter().map(|(v, share)| (scale * v, *share)).collect();
    svg(&distribution((&line(&figure.what), &unit), &curve, bound(figure)), &FigureSize::SMALL)
}

/// Range of a number that varies, in words: `KEY=log:0.1..10` is "0.1 … 10, evenly on a logarithmic scale".
fn range_in_words(how: &str) -> String {
    let how = line(how.split_once('=').map_or(how, |(_, range)| range));
    let (times, how) =
        how.strip_prefix("times:").map_or(("", &*how), |own| ("what the study says times ", own));
    let words = if let Some(ends) = how.strip_prefix("log:") {
        format!("{}, evenly on a logarithmic scale", ends.replace("..", " … "))
    } else if let Some((mean, deviation)) =
        how.strip_prefix("normal:").and_then(|own| own.split_once(','))
    {
        format!("{mean} ± {deviation}, normal")
    } else {
        how.replace("..", " … ").replace(',', ", ")
    };
    format!("{times}{words}")
}

/// Returns true if the figure is not the same in all runs, so that there is a distribution to draw.
fn differs(figure: &FigureRecord) -> bool {
    figure.least.total_cmp(&figure.largest).is_ne()
}

fn bound(figure: &FigureRecord) -> Option<f64> {
    (figure.name == "error_over_spec" || figure.name == "tau_over_limit").then_some(1.0)
}

fn verdict(summary: &SweepSummary) -> Markup {
    let totals = &summary.totals;
    let began = totals.whole + totals.diverged + totals.stopped;
    let good = totals.within_spec == began && began == summary.runs;
    let class = if good { "verdict within" } else { "verdict outside" };
    let [low, high] = totals.within_spec_interval.map(|share| number(100.0 * share));
    let others = [
        (totals.diverged, "diverged"),
        (totals.stopped, "were stopped by the robot"),
        (totals.refused, "could not be run: what was drawn makes no study that runs"),
        (totals.panicked, "panicked, a fault of this program"),
    ];
    html! { div class=(class) {
        p { strong { (totals.within_spec) " of " (began) " runs kept every stated bound." } }
        p { "Probability that a run does, with " (stated(100.0 * summary.confidence)) " % confidence: " (low) " % \
            to " (high) " %." }
        ul { @for (count, what) in others { @if count > 0 { li { (count) " " (what) } } } }
    } }
}

/// A number of which infinity means a run that did not come to its end.
fn shown(value: f64) -> String {
    if value == f64::INFINITY { "∞".to_owned() } else { number(value) }
}

fn table(summary: &SweepSummary) -> Markup {
    html! { div.scroll tabindex="0" role="region" aria-label="Table: figures" { table {
        thead { tr {
            th scope="col" { "figure" }
            th scope="col" { "least" }
            @for share in SHOWN { th scope="col" { (stated(100.0 * share)) " %" } }
            th scope="col" { "largest" }
        } }
        tbody { @for figure in &summary.figures { tr {
            @let (scale, unit) = people(&figure.unit);
            th scope="row" { (line(&figure.what)) @if !unit.is_empty() { " " span.unit { "[" (unit) "]" } } }
            td { (shown(scale * figure.least)) }
            @for share in SHOWN { td { (quantile(figure, share, scale)) } }
            td { (shown(scale * figure.largest)) }
        } } }
    } } }
}

fn quantile(figure: &FigureRecord, share: f64, scale: f64) -> Markup {
    let found = figure.quantiles.iter().find(|q| (q.share - share).abs() < 1e-12);
    let ends = |q: &Quantile| {
        let end = |end: Option<f64>| end.map_or("–".to_owned(), |end| shown(scale * end));
        format!("{} … {}", end(q.low), end(q.high))
    };
    html! { @if let Some(q) = found { (shown(scale * q.value)) span.note { (ends(q)) } } @else { "–" } }
}

/// Figure by which runs are compared: its index in a row, its label, its bound.
fn compared(summary: &SweepSummary) -> (usize, &'static str, Option<f64>) {
    match usize::from(summary.figures.iter().any(|f| f.name == "error_over_spec")) {
        0 => (0, "largest |e| after settling [mrad]", None),
        by => (by, "largest |e| over its bound", Some(1.0)),
    }
}

fn scatters(summary: &SweepSummary, drawn: &[SweepRow]) -> Markup {
    let (by, beside, bound) = compared(summary);
    let scale = if bound.is_none() { MILLI } else { 1.0 };
    let runs = |i: usize| -> Vec<DrawnRun> {
        let run = |row: &SweepRow| DrawnRun {
            value: row.values[i],
            error: scale * row.figures[by],
            within: row.within_spec,
        };
        drawn.iter().map(run).collect()
    };
    let label = |i: usize| {
        let vary = &summary.vary[i];
        let name = key_in_words(&vary.name);
        if vary.unit.is_empty() { name } else { format!("{name} [{}]", vary.unit) }
    };
    html! {
        p { (drawn.len()) " of " (summary.runs) " runs, evenly taken." }
        div.plots { @for i in 0..summary.vary.len() { figure { (svg(&scatter(&runs(i), (&label(i), beside), bound),
            &FigureSize::SMALL)) } } }
    }
}

fn worst(summary: &SweepSummary) -> Markup {
    let scale = if compared(summary).2.is_none() { MILLI } else { 1.0 };
    html! { div.scroll.worst tabindex="0" role="region" aria-label="Table: the worst runs" { table {
        thead { tr {
            th scope="col" { "run" }
            th scope="col" { "ended" }
            th scope="col" { (compared(summary).1) }
            @for vary in &summary.vary { th scope="col" {
                (key_in_words(&vary.name)) @if !vary.unit.is_empty() { " " span.unit { "[" (line(&vary.unit)) "]" } }
            } }
            th scope="col" { "command" }
        } }
        tbody { @for run in &summary.worst { tr {
            th scope="row" { (run.run) }
            td { (run.ended) }
            td { (shown(scale * run.error)) }
            @for value in &run.values { td { (number(*value)) } }
            td { code { (line(&run.command)) } }
        } } }
    } } }
}
