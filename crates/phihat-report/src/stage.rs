//! The arm on the page: a picture, and where scripts run a view that moves.

use maud::{Markup, PreEscaped, html};

use crate::arm::poster;
use crate::kit::text::line;
use crate::record::Record;

/// The view of the arm, or nothing where none is recorded.
pub(crate) fn stage(record: &Record<'_>) -> Markup {
    let Some(poster) = poster(record.drawing) else { return html! {} };
    let arm = record.drawing.arm.as_ref();
    let bounded = record.measured().envelope.is_some();
    let drawn = arm.map_or("", |arm| arm.looks.as_str());
    html! {
        h2 id="arm" { "The arm" }
        figure.poster { (PreEscaped(poster)) }
        section.stage hidden aria-labelledby="arm" {
            div.stage-view {
                canvas id="arm-view" tabindex="0" role="application"
                    aria-label="The arm, seen from the side. Space plays and pauses; left and right move in time, with \
                        Alt by one sample; up, down and Shift with arrows turn the view; plus and minus zoom; 0 brings \
                        the view back." {}
                div.stage-words aria-hidden="true" {}
                ul.legend {
                    li.is-arm id="drawn" { "the arm" }
                    li.is-ghost { "desired pose, q_d" }
                    li.is-path { "path of the tip" }
                    li.is-tube id="tube-words" hidden { "bound on the error, around the desired pose" }
                    li.is-force { "push" }
                    li.is-load { "payload" }
                }
            }
            div.stage-side {
                p.stage-now { output id="clock" { "0 s" } " · tip off by " output id="tip-error" { "–" } }
                ul.errors id="errors" aria-label="error of each joint at this time" {}
                p.hint { "A bar is the error e in its bound, where one is stated; else in the largest of the run." }
            }
            div.stage-controls {
                button type="button" id="play" { "▶ play" }
                input type="range" id="time" min="0" max="1" value="0" step="1" aria-label="time";
                label { "speed " select id="speed" {
                    @for (value, words) in [("0.1", "× 0.1"), ("0.25", "× 0.25"), ("1", "real time"), ("2", "× \
                        2"), ("4", "× 4")] {
                        option value=(value) selected[value == "1"] { (words) }
                    }
                } }
                label { "error " select id="magnify" {} }
                label { input type="checkbox" id="ghost" checked; " desired pose" }
                label { input type="checkbox" id="path" checked; " path" }
                @if bounded { label { input type="checkbox" id="tube" checked; " bound" } }
            }
            p.hint {
                "Drag to turn, pinch or Ctrl and wheel to zoom, double-click to come back. "
                @if drawn.is_empty() || arm.is_none_or(|arm| arm.shapes.is_empty()) { "Drawn from the arm's \
                    kinematics; a link is as thick as its mass asks. " }
                @if !drawn.is_empty() { (line(drawn)) " " }
                "The error is too small to be seen as it is: the factor is yours."
            }
        }
    }
}
