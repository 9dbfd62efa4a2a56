//! The page of a fault matrix: a heat map, and every run with the command that repeats it.

use crate::faults::{Bar, FaultRecord, FaultRunRecord, Miss, RequiredEnd, Summary};
use maud::{Markup, html};

use phihat_report::kit::MILLI;
use phihat_report::kit::Page;
use phihat_report::kit::number::{number, stated};
use phihat_report::kit::shade::{Shade, shades};
use phihat_report::kit::text::line;

/// The self-contained page of a fault matrix. `command` is the one that made it, without `--only`.
pub fn faults_page(summary: &Summary, command: &str) -> String {
    let arms: Vec<_> = summary.arms.iter().map(|arm| line(&arm.name)).collect();
    let title = format!("Fault matrix: {}", arms.join(", "));
    let main = html! {
        header {
            h1 { (title) }
            p.byline { "phihat " (line(&summary.phihat_version)) " · " (summary.totals.runs) " runs · simulated" }
            (verdict(summary))
        }
        (heat_map(summary))
        h2 id="runs" { "Every run" }
        p { "Each line's command, " code { (line(command)) " --only RUN --trace" } ", repeats that very run and keeps \
            its study, trace and report. "
            "What missed a bar is open." }
        @for fault in &summary.faults { (runs(summary, fault, command)) }
        (not_claimed())
    };
    Page { title: &title, kind: "faults", script: Some(include_str!("page.js")) }.document(&main)
}

fn verdict(summary: &Summary) -> Markup {
    let totals = &summary.totals;
    let class = if totals.good { "verdict within" } else { "verdict outside" };
    let lines = [
        ("panicked or could not be run", totals.panicked),
        ("were not finite or diverged", totals.not_finite),
        ("told a drive more than a torque or rate limit", totals.beyond_limits),
        (
            "stopped before anything was wrong, or more than 3 samples after the reason",
            totals.bad_stops,
        ),
        ("stopped where they should go on, the other way round, or late", totals.wrong_ends),
        ("went beyond their excursion's bar", totals.beyond_excursion),
    ];
    html! { div class=(class) {
        p { strong { (totals.kept) " of " (totals.runs) " runs kept every bar." } }
        ul { @for (what, count) in lines.iter().filter(|(_, count)| *count > 0) { li { (count) " " (what) } } }
        p.hint {
            "None "
            (lines.iter().filter(|(_, count)| *count == 0).map(|(what, _)| *what).collect::<Vec<_>>().join("; none "))
            "."
        }
    } }
}

/// Shades of the heat map: excursion over its bar.
const KEY: [(Shade, &str); 7] = [
    (Shade::Step(0), "to 25 %"),
    (Shade::Step(1), "to 50 %"),
    (Shade::Step(2), "to 75 %"),
    (Shade::Step(3), "to 100 %"),
    (Shade::Beyond, "▲ beyond"),
    (Shade::Broken, "✗ something else missed"),
    (Shade::None, "no bar: listed"),
];

/// Arm and order, in the order of the runs.
fn columns(summary: &Summary) -> Vec<(&str, usize)> {
    let mut columns: Vec<(&str, usize)> = Vec::new();
    for run in &summary.runs {
        if !columns.contains(&(run.arm.as_str(), run.order)) {
            columns.push((&run.arm, run.order));
        }
    }
    columns
}

fn heat_map(summary: &Summary) -> Markup {
    let columns = columns(summary);
    let severities = summary.faults.iter().map(|fault| fault.levels.len()).max().unwrap_or(0);
    html! {
        h2 id="map" { "Heat map" }
        p.key {
            "Worst excursion over the seeds, in mrad (mm where an arm's joints slide), against its bar: "
            (shades(&KEY))
        }
        div.scroll tabindex="0" role="region" aria-label="Table: heat map of faults" {
            table.map {
                thead { tr {
                    th scope="col" { "fault" }
                    @for (arm, order) in &columns { @for severity in 1..=severities {
                        th.first[severity == 1] scope="col" { (line(arm)) ", m \
                            = " (order) br; (severe(severity, severities)) }
                    } }
                } }
                tbody { @for fault in &summary.faults { tr {
                    th scope="row" title=(line(&fault.row)) { (people(&fault.name)) }
                    @for (arm, order) in &columns { @for severity in 1..=severities {
                        (cell(summary, fault, severity, (arm, *order)))
                    } }
                } } }
            }
        }
    }
}

/// A severity in words: the first is mild, the last severe.
fn severe(severity: usize, of: usize) -> &'static str {
    match severity {
        1 => "mild",
        last if last == of => "severe",
        _ => "medium",
    }
}

fn level(fault: &FaultRecord, severity: usize) -> String {
    let level = fault.levels.get(severity - 1).copied().unwrap_or(f64::NAN);
    let (scale, unit) = people_unit(&fault.unit, level);
    format!("{}{unit}", stated(scale * level))
}

/// Unit of a level for people, with what stands before it, and the factor from that of the data.
fn people_unit(unit: &str, level: f64) -> (f64, String) {
    let own = line(unit);
    let unit = match own.as_str() {
        "" => return (1.0, String::new()),
        "m_max" => return (1.0, " × the largest payload".to_owned()),
        "τ_max" => return (100.0, " % of the torque limit".to_owned()),
        "periods" => return (1.0, " sample periods".to_owned()),
        own @ ("rad" | "s") => own,
        own => return (1.0, format!(" {own}")),
    };
    match level.abs() {
        small if small > 0.0 && small < 1e-3 => (1e6, format!(" µ{unit}")),
        middle if middle > 0.0 && middle < 1.0 => (MILLI, format!(" m{unit}")),
        _ => (1.0, format!(" {unit}")),
    }
}

/// A fault's name in words.
fn people(name: &str) -> String {
    line(name).replace('_', " ")
}

fn cell(summary: &Summary, fault: &FaultRecord, severity: usize, at: (&str, usize)) -> Markup {
    let of = |run: &&FaultRunRecord| {
        run.fault == fault.name && run.severity == severity && (run.arm.as_str(), run.order) == at
    };
    let runs: Vec<_> = summary.runs.iter().filter(of).collect();
    let Some(first) = runs.first() else { return html! { td { "–" } } };
    let worst = runs.iter().filter_map(|run| run.cell()).map(|cell| cell.excursion_rad);
    let worst = worst.fold(0.0, f64::max);
    let bar = fault.bars.get(severity - 1);
    let missed = || runs.iter().flat_map(|run| &run.missed);
    let (shade, mark) = if missed().any(|miss| *miss != Miss::Excursion) {
        (Shade::Broken, "✗ ")
    } else if missed().next().is_some() {
        (Shade::Beyond, "▲ ")
    } else {
        (shade(worst, bar), "")
    };
    let stopped = runs.iter().filter_map(|run| run.cell()).filter(|c| c.stopped.is_some()).count();
    let (first_of_arm, level) = ((severity == 1).then_some("first"), level(fault, severity));
    html! { td class={ (shade.class()) @if let Some(first) = first_of_arm { " " (first) } } { a href=(format!("#{}",
        anchor(&first.name))) {
        (mark) (number(MILLI * worst))
        span.note { (level) " · " @if stopped == 0 { "goes \
            on" } @else if runs.len() == 1 { "stops" } @else { (stopped) " of " (runs.len()) " stop" } }
    } } }
}

fn shade(excursion: f64, bar: Option<&Bar>) -> Shade {
    let most = bar.and_then(|bar| bar.excursion_rad);
    most.map_or(Shade::None, |most| {
        Shade::of(excursion, [0.25, 0.5, 0.75].map(|share| share * most))
    })
}

/// A run's name as the target of a link.
fn anchor(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect()
}

fn runs(summary: &Summary, fault: &FaultRecord, command: &str) -> Markup {
    let of = || summary.runs.iter().filter(|run| run.fault == fault.name);
    let (all, kept) = (of().count(), of().filter(|run| run.missed.is_empty()).count());
    html! { details.fault open[kept < all] {
        summary {
            strong { (people(&fault.name)) } " "
            span class=(if kept < all { "outside" } else { "note" }) { (kept) " of " (all) " kept every bar" }
        }
        p { (line(&fault.what)) ": " (levels(fault)) ". " (bars(fault)) }
        div.scroll.runs tabindex="0" role="region" aria-label=(format!("Table: runs of {}", line(&fault.name))) {
            table {
                thead { tr {
                    th scope="col" { "run" }
                    th scope="col" { "onset " span.unit { "[s]" } }
                    th scope="col" { "joint" }
                    th scope="col" { "noticed " span.unit { "[ms]" } }
                    th scope="col" { "stopped " span.unit { "[ms]" } }
                    th scope="col" { "stop after reason " span.unit { "[samples]" } }
                    th scope="col" { "excursion " span.unit { "[mrad]" } }
                    th scope="col" { "error at the end " span.unit { "[mrad]" } }
                    th scope="col" { "bars" }
                    th scope="col" { "command" }
                } }
                tbody { @for run in of() { (row(run, command)) } }
            }
        }
    } }
}

fn row(run: &FaultRunRecord, command: &str) -> Markup {
    let missed: Vec<_> = run.missed.iter().map(|miss| miss.words()).collect();
    let show = |value: fn(&crate::faults::FaultCell) -> f64| {
        run.cell().map_or("–".to_owned(), |cell| number(value(cell)))
    };
    // Where it is not that of the heading.
    let own = run.cell().map(|cell| cell.way_unit.as_str()).filter(|unit| *unit != "mrad");
    let own = own.map_or_else(String::new, |unit| format!("\u{a0}{unit}"));
    html! { tr id=(anchor(&run.name)) {
        th scope="row" { (line(&run.name)) }
        td { (show(|cell| cell.onset_s)) }
        td { (run.cell().map_or(String::new(), |cell| line(&cell.joint))) }
        td { (event(run.cell().and_then(|cell| cell.noticed.as_ref()))) }
        td { (event(run.cell().and_then(|cell| cell.stopped.as_ref()))) }
        td { (run.cell().and_then(|cell| cell.stop_delay).map_or("–".to_owned(), |n| n.to_string())) }
        td { (show(|cell| MILLI * cell.excursion_rad)) (own) }
        td { (show(|cell| MILLI * cell.error_end_rad)) (own) }
        td.outside[!missed.is_empty()] {
            @if missed.is_empty() { "kept" } @else { (missed.join(", ")) }
            @if let Some(why) = run.cell().and_then(|cell| cell.refused.as_deref()) { " " (line(why)) }
            @if let crate::RunEnded::Panicked(why) = &run.ended { " " (line(why)) }
        }
        td { code { (line(command)) " --only " (line(&run.name)) " --trace" } }
    } }
}

/// When something happened after the onset, and what.
fn event(event: Option<&(String, f64)>) -> Markup {
    html! {
        @if let Some((what, ms)) = event { (number(*ms)) span.note { (line(what)) } } @else { "–" }
    }
}

fn levels(fault: &FaultRecord) -> String {
    let levels = 1..=fault.levels.len();
    levels.map(|severity| level(fault, severity)).collect::<Vec<_>>().join(", ")
}

fn bars(fault: &FaultRecord) -> String {
    let bar = |bar: &Bar| {
        let end = match bar.end {
            RequiredEnd::Following => "goes on",
            RequiredEnd::Stopped => "stops",
            RequiredEnd::Either => "goes on or stops",
        };
        let excursion =
            bar.excursion_rad.map(|most| format!(", within {} mrad (mm)", stated(MILLI * most)));
        let noticed = bar.noticed_ms.map(|most| format!(", after {} ms at most", stated(most)));
        format!("{end}{}{}", noticed.unwrap_or_default(), excursion.unwrap_or_default())
    };
    let bars: Vec<_> = fault.bars.iter().map(bar).collect();
    format!("Bars, mild to severe: {}.", bars.join("; "))
}

fn not_claimed() -> Markup {
    html! {
        h2 { "Not claimed" }
        p {
            "Every run is simulated, with one fault at a time. The bars are this project's. This is research "
            "software, not a safety function: it replaces no emergency stop, protective stop, limits and risk "
            "assessment."
        }
    }
}

#[cfg(test)]
mod tests {
    use super::people_unit;
    use phihat_report::kit::number::stated;

    #[test]
    fn a_level_is_said_in_the_unit_that_a_person_uses() {
        let said = |unit: &str, level: f64| {
            let (scale, unit) = people_unit(unit, level);
            format!("{}{unit}", stated(scale * level))
        };
        assert_eq!(said("rad", 1e-5), "10 µrad");
        assert_eq!(said("rad", 0.1), "100 mrad");
        assert_eq!(said("s", 0.005), "5 ms");
        assert_eq!(said("s", 0.0), "0 s");
        assert_eq!(said("τ_max", 0.2), "20 % of the torque limit");
        assert_eq!(said("m_max", 1.2), "1.2 × the largest payload");
        assert_eq!(said("N·m/s", 800.0), "800 N·m/s");
    }
}
