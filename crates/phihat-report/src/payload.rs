//! The page's data: every chart, decimated, as JSON that cannot leave its script element.

use crate::chart::{Chart, Panel, charts};
use crate::kind::{Curve, Plane};
use crate::kit::number::rounded;
use crate::kit::unit_of;
use crate::record::Record;
use crate::verdict::worst_joint;
use serde::Serialize;
use std::fmt::Write;

/// What `assets/page.js` reads.
#[derive(Serialize)]
struct Payload<'a> {
    settle_s: f64,
    end_s: f64,
    worst: usize,
    joints: Vec<&'a str>,
    charts: Vec<ChartData>,
}

#[derive(Serialize)]
struct ChartData {
    stem: &'static str,
    title: &'static str,
    phase: bool,
    bound_label: &'static str,
    bound_after_settle: bool,
    curves: Vec<CurveData>,
    panels: Vec<PanelData>,
}

#[derive(Serialize)]
struct CurveData {
    label: &'static str,
    dashed: bool,
}

#[derive(Serialize)]
struct PanelData {
    x_label: String,
    y_label: String,
    /// One per curve.
    units: Vec<String>,
    bound: Option<f64>,
    /// Steps of the tube: times (one more), least, largest.
    #[serde(skip_serializing_if = "Option::is_none")]
    tube: Option<[Vec<f64>; 3]>,
    t: Vec<f64>,
    y: Vec<Vec<f64>>,
}

/// The JSON text, fit to stand inside `<script type="application/json">`.
pub(crate) fn payload(record: &Record<'_>) -> String {
    let seen = record.seen();
    let charts = charts(&seen);
    let data = Payload {
        settle_s: record.metrics.settle_s,
        end_s: seen.drawing.end_s,
        worst: worst_joint(record.metrics),
        joints: charts.first().map_or(vec![], |c| c.panels.iter().map(|p| &*p.joint).collect()),
        charts: charts.iter().map(chart_data).collect(),
    };
    // Numbers, strings and lists always have a JSON form.
    escaped(&serde_json::to_string(&data).unwrap_or_else(|_| "null".to_owned()))
}

fn chart_data(chart: &Chart) -> ChartData {
    let kind = chart.kind;
    let panel = |panel: &Panel| {
        let rows = &panel.drawn.page;
        let take = |c: usize| rows.iter().map(|row| rounded(row.y[c])).collect();
        let own = |unit: &str| unit_of(unit, panel.slides);
        PanelData {
            x_label: own(kind.x_label),
            y_label: own(kind.y_label),
            units: kind.curves.iter().map(|curve| own(curve.unit)).collect(),
            bound: panel.bound.map(rounded),
            tube: panel.tube.clone().map(|band| [band.t, band.low, band.high]),
            t: rows.iter().map(|row| (row.t * 1e9).round() / 1e9).collect(),
            y: (0..kind.curves.len()).map(take).collect(),
        }
    };
    let curve = |c: &Curve| CurveData { label: c.label, dashed: c.dashed };
    ChartData {
        stem: kind.stem,
        title: chart.title(),
        phase: kind.plane == Plane::Phase,
        bound_label: kind.bound.label,
        bound_after_settle: kind.bound.after_settle,
        curves: kind.curves.iter().map(curve).collect(),
        panels: chart.panels.iter().map(panel).collect(),
    }
}

/// A JSON text without any character that HTML or old JavaScript reads on its own.
fn escaped(json: &str) -> String {
    let mut text = String::with_capacity(json.len());
    for c in json.chars() {
        match c {
            '<' | '>' | '&' | '\u{2028}' | '\u{2029}' => {
                // Writing to a string cannot fail.
                let _ = write!(text, "\\u{:04x}", u32::from(c));
            }
            _ => text.push(c),
        }
    }
    text
}
