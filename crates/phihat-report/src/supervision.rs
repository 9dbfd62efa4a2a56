//! What the supervisor did, moment by moment.

use crate::number::stated;
use maud::{Markup, html};
use phihat_sim::Trace;

/// Rows that are shown at most.
const ROWS_MAX: usize = 60;

/// An event that comes back within this time \[s\] is the same one going on.
const APART_S: f64 = 0.05;

/// One moment at which something changed.
struct Moment {
    t: f64,
    what: String,
    mode: &'static str,
}

/// The course of a supervised run; nothing where no supervisor ran.
pub(crate) fn supervision(trace: &Trace) -> Markup {
    let moments = moments(trace);
    let more = moments.len().saturating_sub(ROWS_MAX);
    html! { @if trace.supervision.is_some() {
        h2 id="supervisor" { "Supervisor" }
        p {
            "Modes, events and faults as they came. What comes back within " (stated(APART_S * 1e3)) " ms counts as going on; "
            "every sample is in trace.csv."
        }
        div.scroll tabindex="0" role="region" aria-label="Table: what the supervisor did" {
            table {
                caption { span { "What the supervisor did" } }
                thead { tr {
                    th scope="col" { "time " span.unit { "[s]" } }
                    th scope="col" { "what" }
                    th scope="col" { "mode" }
                } }
                tbody { @for moment in moments.iter().take(ROWS_MAX) { tr {
                    th scope="row" { (format!("{:.3}", moment.t)) }
                    td { (moment.what) }
                    td { (moment.mode) }
                } } }
            }
        }
        @if more > 0 { p { (more) " more are not shown." } }
    } }
}

fn moments(trace: &Trace) -> Vec<Moment> {
    let Some(course) = &trace.supervision else { return Vec::new() };
    let mut moments = Vec::new();
    let mut seen: Vec<(&'static str, f64)> = Vec::new();
    let (mut last_mode, mut last_fault) = (None, None);
    let samples = course.mode.iter().zip(&course.events).zip(&course.fault).zip(&trace.t_ns);
    for (((mode, events), fault), t_ns) in samples {
        let t = *t_ns as f64 * 1e-9;
        let mut note = |what: String| moments.push(Moment { t, what, mode: mode.name() });
        for name in events.names() {
            let known = seen.iter_mut().find(|(event, _)| *event == name);
            let fresh = known.as_ref().is_none_or(|(_, last)| t - last > APART_S);
            match known {
                Some((_, last)) => *last = t,
                None => seen.push((name, t)),
            }
            if fresh {
                note(name.to_owned());
            }
        }
        if *fault != last_fault {
            note(fault.map_or("fault cleared".to_owned(), |f| format!("fault: {}", f.name())));
            last_fault = *fault;
        }
        if last_mode != Some(*mode) {
            note(format!("now {}", mode.name()));
            last_mode = Some(*mode);
        }
    }
    moments
}
