//! The page's data: every signal and what the charts make of them, as JSON that cannot leave its script element.

use crate::arm::DrawnArm;
use crate::chart::{Chart, JointChart, charts};
use crate::kind::{KindCurve, PlotPlane};
use crate::kit::number::{number, rounded};
use crate::kit::unit_of;
use crate::record::Record;
use crate::signal::{CodedSignal, sources};
use crate::verdict::worst_joint;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Input of `assets/page.js`.
#[derive(Serialize)]
struct PageData<'a> {
    settle_s: f64,
    end_s: f64,
    worst: usize,
    joints: Vec<&'a str>,
    samples: u64,
    /// Samples that share a value of a signal.
    each: u64,
    /// From sample `k` at `t` ns on, one each `step` ns.
    times: &'a [(u64, u64, u64)],
    /// Of each joint, by the label of the curve: coded values, or the least and the largest of each few.
    signals: Vec<BTreeMap<&'static str, Vec<String>>>,
    charts: Vec<ChartData>,
    #[serde(skip_serializing_if = "Option::is_none")]
    arm: Option<&'a DrawnArm>,
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
    /// True if it is constant from one sample to the next.
    held: bool,
}

#[derive(Serialize)]
struct PanelData {
    x_label: String,
    y_label: String,
    /// One per curve.
    units: Vec<String>,
    bound: Option<f64>,
    /// Steps of the envelope: times (one more), least, largest.
    #[serde(skip_serializing_if = "Option::is_none")]
    band: Option<[Vec<f64>; 3]>,
    /// Name of the envelope, with its level where that is constant.
    #[serde(skip_serializing_if = "String::is_empty")]
    band_label: String,
}

/// The JSON text, fit to stand inside `<script type="application/json">`.
pub(crate) fn payload(record: &Record<'_>) -> String {
    let run = record.measured();
    let charts = charts(&run);
    let data = PageData {
        settle_s: record.metrics.settle_s,
        end_s: run.drawing.end_s,
        worst: worst_joint(record.metrics),
        joints: charts.first().map_or(vec![], |c| c.panels.iter().map(|p| &*p.joint).collect()),
        samples: run.drawing.samples,
        each: run.drawing.each,
        times: run.drawing.times.runs(),
        signals: run.drawing.signals.iter().map(|own| signals(own, &charts)).collect(),
        charts: charts.iter().map(chart_data).collect(),
        arm: run.drawing.arm.as_ref(),
    };
    // Numbers, strings and lists always have a JSON form.
    escaped(&serde_json::to_string(&data).unwrap_or_else(|_| "null".to_owned()))
}

/// The signals of a joint that some chart shows.
fn signals(own: &[CodedSignal], charts: &[Chart]) -> BTreeMap<&'static str, Vec<String>> {
    let curves = charts.iter().flat_map(|chart| chart.kind.curves);
    let sources = sources();
    let shown = sources.iter().zip(own).map(|((curve, _), signal)| (curve.label, signal));
    let shown = shown.filter(|(label, _)| curves.clone().any(|curve| curve.label == *label));
    shown.map(|(label, signal)| (label, signal.texts())).collect()
}

fn chart_data(chart: &Chart) -> ChartData {
    let kind = chart.kind;
    let panel = |panel: &JointChart| {
        let own = |unit: &str| unit_of(unit, panel.slides);
        PanelData {
            x_label: own(kind.x_label),
            y_label: own(kind.y_label),
            units: kind.curves.iter().map(|curve| own(curve.unit)).collect(),
            bound: panel.bound.map(rounded),
            band_label: band_label(chart, panel),
            band: panel.band.clone().map(|band| [band.t, band.low, band.high]),
        }
    };
    let curve = |c: &KindCurve| CurveData { label: c.label, dashed: c.dashed, held: c.held };
    ChartData {
        stem: kind.stem,
        title: chart.title(),
        phase: kind.plane == PlotPlane::Phase,
        bound_label: kind.bound.label,
        bound_after_settle: kind.bound.after_settle,
        curves: kind.curves.iter().map(curve).collect(),
        panels: chart.panels.iter().map(panel).collect(),
    }
}

fn band_label(chart: &Chart, panel: &JointChart) -> String {
    match panel.band.as_ref().map(|band| &band.high[..]) {
        None => String::new(),
        Some([level]) => {
            let unit = chart.kind.curves.first().map_or("", |curve| curve.unit);
            format!("{} ±{} {}", chart.envelope, number(*level), unit_of(unit, panel.slides))
        }
        Some(_) => chart.envelope.to_owned(),
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
