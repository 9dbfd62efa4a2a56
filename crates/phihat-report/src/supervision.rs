//! Actions of the supervisor, moment by moment.

use crate::kit::number::stated;
use maud::{Markup, html};
use phihat_sim::Trace;

/// Rows that are shown at most.
const ROWS_MAX: usize = 60;

/// An event that comes back within this time \[s\] is the same one going on.
const APART_S: f64 = 0.05;

/// One moment at which something changed.
#[derive(Debug, Clone)]
struct ModeChange {
    t: f64,
    what: String,
    mode: &'static str,
}

/// Actions of a supervisor, collected as its record passes.
#[derive(Debug, Clone, Default)]
pub(crate) struct ModeHistory {
    /// The first ones.
    moments: Vec<ModeChange>,
    /// Those that are not kept.
    more: usize,
    /// When each event came last.
    seen: Vec<(&'static str, f64)>,
    /// Mode and fault of the sample before; `None`: no supervisor, or no sample yet.
    last: Option<(&'static str, Option<&'static str>)>,
}

/// The course of a supervised run; nothing where no supervisor ran.
pub(crate) fn supervision(course: &ModeHistory) -> Markup {
    let ModeHistory { moments, more, last, .. } = course;
    html! { @if last.is_some() {
        h2 id="supervisor" { "Supervisor" }
        p {
            "Modes, events and faults as they came. What comes back within " (stated(APART_S * 1e3)) " ms counts as \
                going on; "
            "every sample is in the trace."
        }
        div.scroll tabindex="0" role="region" aria-label="Table: what the supervisor did" {
            table {
                caption { span { "What the supervisor did" } }
                thead { tr {
                    th scope="col" { "time " span.unit { "[s]" } }
                    th scope="col" { "what" }
                    th scope="col" { "mode" }
                } }
                tbody { @for moment in moments { tr {
                    th scope="row" { (format!("{:.3}", moment.t)) }
                    td { (moment.what) }
                    td { (moment.mode) }
                } } }
            }
        }
        @if *more > 0 { p { (more) " more are not shown." } }
    } }
}

impl ModeHistory {
    /// The next samples.
    pub(crate) fn block(&mut self, trace: &Trace) {
        let Some(course) = &trace.supervision else { return };
        let samples = course.mode.iter().zip(&course.events).zip(&course.fault).zip(&trace.t_ns);
        for (((mode, events), fault), t_ns) in samples {
            let t = *t_ns as f64 * 1e-9;
            let (mode, fault) = (mode.name(), fault.as_ref().map(|fault| fault.name()));
            for name in events.names() {
                if self.is_fresh(name, t) {
                    self.note(t, mode, name.to_owned());
                }
            }
            if fault != self.last.and_then(|(_, fault)| fault) {
                let what = fault.map_or("fault cleared".to_owned(), |f| format!("fault: {f}"));
                self.note(t, mode, what);
            }
            if self.last.map(|(mode, _)| mode) != Some(mode) {
                self.note(t, mode, format!("now {mode}"));
            }
            self.last = Some((mode, fault));
        }
    }

    /// Returns true if an event is a new one, and not one going on.
    fn is_fresh(&mut self, name: &'static str, t: f64) -> bool {
        if let Some((_, last)) = self.seen.iter_mut().find(|(event, _)| *event == name) {
            return t - core::mem::replace(last, t) > APART_S;
        }
        self.seen.push((name, t));
        true
    }

    fn note(&mut self, t: f64, mode: &'static str, what: String) {
        if self.moments.len() < ROWS_MAX {
            self.moments.push(ModeChange { t, what, mode });
        } else {
            self.more += 1;
        }
    }
}
