//! Behind every figure: each cell with its outcome, its figures, its trace, and the command that makes it again.

use crate::{Comparison, Figures, GainsKind, LawCell, LawRow, Sketch};
use maud::{Markup, html};

use super::names::title;
use super::outcome::outcome_in_full;
use super::words::{gains, is_designed};
use phihat_report::kit::MILLI;
use phihat_report::kit::anchor;
use phihat_report::kit::draw::sparkline;
use phihat_report::kit::number::number;
use phihat_report::kit::text::line;

pub(super) fn traces(comparison: &Comparison, command: &str) -> Markup {
    html! {
        h2 id="traces" { "Every cell and its trace" }
        p {
            "Of the joint with the largest error, on the study's own motion: error e and commanded torque τ over the \
                whole run, smallest and "
            "largest in equal slices of time. The command makes that very run again, with its study, every signal of \
                every joint, and a report."
        }
        @for arm in &comparison.arms {
            h3 { (line(&arm.name)) }
            @for row in comparison.rows_of(&arm.name) { (row_part(comparison, row, command)) }
        }
    }
}

fn row_part(comparison: &Comparison, row: &LawRow, command: &str) -> Markup {
    let id = anchor("row", &format!("{}-{}", row.arm, row.rival));
    let label = format!("Table: cells of {} on {}", title(comparison, &row.rival), line(&row.arm));
    let designed = is_designed(comparison.rival(&row.rival));
    // The same gains twice.
    let again = |cell: &&LawCell| designed && cell.gains == GainsKind::Default;
    let cells = || row.cells.iter().filter(|cell| !again(cell));
    html! { details.cells id=(id) {
        summary {
            (title(comparison, &row.rival))
            @if row.refused.is_some() { span.note { " does not apply" } }
        }
        @if let Some(why) = &row.refused {
            p { "Does not apply: " (line(why)) }
        } @else {
            div.scroll.runs tabindex="0" role="region" aria-label=(label) { table {
                thead { tr {
                    th scope="col" { "world, gains" }
                    th scope="col" { "what became of it" }
                    th scope="col" { "rms error" br; "largest " span.unit { "[mrad]" } }
                    th scope="col" { "effort " span.unit { "[% of limit]" } br; "chatter " span.unit { "[N·m]" } }
                    th scope="col" { "× exact" }
                    th scope="col" { "limit met " span.unit { "[% of samples]" } }
                    th scope="col" { "recovery " span.unit { "[s]" } }
                    th scope="col" { "bound " span.unit { "[mrad]" } }
                    th scope="col" { "e(t)" }
                    th scope="col" { "τ(t)" }
                    th scope="col" { "command" }
                } }
                tbody { @for cell in cells() { (cell_line(cell, designed, command)) } }
            } }
        }
    } }
}

fn cell_line(cell: &LawCell, designed: bool, command: &str) -> Markup {
    let kind = if designed { "designed" } else { gains(cell.gains) };
    let figure = |of: fn(&Figures) -> Option<f64>| {
        let value = cell.worst.as_ref().and_then(of);
        value.map_or_else(|| "–".to_owned(), number)
    };
    let followed = cell.outcome.followed();
    html! { tr {
        th scope="row" { (line(&cell.world)) " " span.note { (kind) } }
        td.outside[!followed] { (outcome_in_full(&cell.outcome)) @if cell.runs.len() > 1 { span.note { (kept(cell)) } }
            }
        td { (figure(|f| Some(MILLI * f.error_rms_rad))) br; (figure(|f| Some(MILLI * f.error_peak_rad))) }
        td { (figure(|f| Some(100.0 * f.effort))) br; (figure(|f| Some(f.chatter_nm))) }
        td { (figure(|f| f.chatter_over_exact)) }
        td { (figure(|f| Some(100.0 * f.saturated))) }
        td { (figure(|f| f.recovery_s)) }
        td { (figure(|f| f.error_bound_rad.map(|bound| MILLI * bound))) }
        @match &cell.sketch {
            None => { td { "–" } td { "–" } }
            Some(sketch) => {
                td.sketch { (curve(sketch, &sketch.e_rad, MILLI, "mrad", "e")) }
                td.sketch { (curve(sketch, &sketch.tau_nm, 1.0, "N·m", "τ")) }
            }
        }
        td { @if let Some(run) = cell.runs.first() { code { (line(command)) " --trace " (line(&run.name)) } } }
    } }
}

/// Number of runs that followed, in words.
fn kept(cell: &LawCell) -> String {
    let followed = cell.runs.iter().filter(|run| run.outcome.followed()).count();
    format!("{followed} of {} motions followed", cell.runs.len())
}

/// The band between the smallest and the largest of every slice, and its ends in words.
fn curve(sketch: &Sketch, slices: &[[f32; 2]], scale: f64, unit: &str, symbol: &str) -> Markup {
    let band: Vec<[f64; 2]> = slices.iter().map(|slice| slice.map(f64::from)).collect();
    let finite = band.iter().flatten().copied().filter(|value| value.is_finite());
    let (low, high) = finite.fold((0.0_f64, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
    let (joint, end) = (line(&sketch.joint), number(sketch.end_s));
    let (bottom, top) = (number(scale * low), number(scale * high));
    let label = format!("{symbol} of {joint} from 0 to {end} s, {bottom} to {top} {unit}");
    html! {
        (sparkline(&label, &band))
        span.note { (bottom) " … " (top) " " (unit) " · " (joint) " · " (end) " s" }
    }
}
