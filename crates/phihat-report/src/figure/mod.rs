//! Static figures: every chart as small multiples, for paper.

use crate::arm::animation;
use crate::chart::{Chart, JointChart, charts};
use crate::kind::{KindBound, PlotPlane};
use crate::kit::draw::{FigureSize, Picture, draw, extent};
use crate::kit::figure::{Axis, Band, Bound, Figure, Ink, Marker, Panel, Series};
use crate::kit::text::short;
use crate::kit::{MILLI, unit_of};
use crate::record::{Record, RunMeasurements};
use crate::stretches::ChartSample;

mod claims;

pub(crate) use claims::{claim_figures, front};

/// The name of every figure that a record may have.
pub const FIGURES: [&str; 16] = [
    "arm",
    "tracking",
    "error",
    "error-steady",
    "error-integral",
    "velocity-error",
    "torque",
    "unknown-dynamics",
    "estimate-error",
    "phase",
    "torque-step",
    "inertia-window",
    "nyquist",
    "bode",
    "trade-off",
    "pace",
];

/// Every figure of a record: those of the run, and those of what was proved about its gains. The example of
/// [`page`](crate::page) has a record.
pub fn figures(record: &Record<'_>) -> Vec<Picture> {
    let run = run_figures(&record.measured()).into_iter();
    arm(record).into_iter().chain(run).chain(claim_figures(record)).collect()
}

/// The arm as it moves, where one is recorded.
fn arm(record: &Record<'_>) -> Option<Picture> {
    // One scale for all joints: a bound is drawn where all have the same.
    let mut bounds = record.metrics.joints.iter().map(|joint| joint.error_bound_rad);
    let first = bounds.next().flatten();
    let same = |bound: Option<f64>| bound.map(f64::to_bits) == first.map(f64::to_bits);
    let bound = first.filter(|_| bounds.all(same));
    let bound = bound.map(|bound| (MILLI * bound, record.metrics.settle_s));
    let svg = animation(record.drawing, bound)?;
    Some(Picture { name: "arm".to_owned(), title: "The arm as it moves".to_owned(), svg })
}

/// The figures of the run, in the order of the page.
pub fn run_figures(record: &RunMeasurements<'_>) -> Vec<Picture> {
    let settle_s = record.metrics.settle_s;
    let mut figures = vec![];
    for chart in charts(record) {
        let whole = ChartView { title: chart.title(), settle_s, rows: |drawn| &drawn.figure };
        figures.push(figure(&chart, chart.kind.stem, &whole));
        if let Some((stem, title)) = chart.steady() {
            figures.push(figure(
                &chart,
                stem,
                &ChartView { title, settle_s, rows: |drawn| &drawn.steady },
            ));
        }
    }
    figures
}

/// Part of a chart that a figure draws: the whole run or the steady part.
struct ChartView {
    title: &'static str,
    settle_s: f64,
    rows: fn(&crate::drawing::DrawnSamples) -> &Vec<ChartSample>,
}

fn figure(chart: &Chart, stem: &str, view: &ChartView) -> Picture {
    let panel = |own: &JointChart| {
        let rows = (view.rows)(&own.drawn);
        match chart.kind.plane {
            PlotPlane::Time => over_time(chart, own, rows, view.settle_s),
            PlotPlane::Phase => in_phase(chart, own, rows),
        }
    };
    let panels = chart.panels.iter().map(panel).collect();
    let (id, title) = (stem.to_owned(), view.title.to_owned());
    draw(&Figure { id, title, panels, ..Figure::default() }, &FigureSize::PAPER)
}

/// The labels of the axes, with the units of the joint.
fn axes(chart: &Chart, own: &JointChart) -> (Axis, Axis) {
    let label = |text: &str| Axis::new(unit_of(text, own.slides));
    (label(chart.kind.x_label), label(chart.kind.y_label))
}

/// A bound that a joint has.
fn bound(own: &JointChart, kind: &KindBound) -> Option<Bound> {
    let value = own.bound.filter(|bound| bound.is_finite())?;
    Some(Bound { both: true, in_view: kind.after_settle, ..Bound::at(kind.label, value) })
}

/// Every curve over time, in its envelope and its bound.
fn over_time(chart: &Chart, own: &JointChart, rows: &[ChartSample], settle_s: f64) -> Panel {
    let kind = chart.kind;
    let bound = bound(own, &kind.bound);
    let bound = bound.map(|b| Bound { from: kind.bound.after_settle.then_some(settle_s), ..b });
    let ends = extent(rows.iter().map(|row| row.t), 0.0);
    let steps = own.band.as_ref().map_or(Vec::new(), |band| band.within((ends.start, ends.end)));
    let steps: Vec<_> =
        steps.into_iter().map(|(from, to, low, high)| [from, to, low, high]).collect();
    // A curve alone in its panel is named by the axis.
    let named = kind.curves.len() > 1 || bound.is_some() || !steps.is_empty();
    let curve = |(c, curve): (usize, &crate::kind::KindCurve)| {
        let points = rows.iter().map(|row| [row.t, row.y[c]]).collect();
        Series::curve(if named { curve.label } else { "" }, points)
    };
    let series = kind.curves.iter().enumerate().map(curve).collect();
    let envelope = Band { label: chart.envelope.to_owned(), steps, ..Band::default() };
    let bands = if envelope.steps.is_empty() { Vec::new() } else { vec![envelope] };
    let title = short(&own.joint, 40);
    Panel { bands, ..Panel::lines(title, axes(chart, own), series, bound.into_iter().collect()) }
}

/// The second curve over the first, from its start.
fn in_phase(chart: &Chart, own: &JointChart, rows: &[ChartSample]) -> Panel {
    let points: Vec<[f64; 2]> = rows.iter().map(|row| [row.y[0], row.y[1]]).collect();
    let start = points.iter().find(|point| point.iter().all(|x| x.is_finite())).copied();
    let start = start.map(|at| Marker {
        at,
        label: "start".to_owned(),
        ink: Ink::Plain,
        ..Marker::default()
    });
    let bound = bound(own, &chart.kind.bound).map(|bound| Bound { upright: true, ..bound });
    let (mut x, mut y) = axes(chart, own);
    let level = bound.iter().flat_map(|bound| [bound.value, -bound.value]);
    let over = |values: &mut dyn Iterator<Item = f64>| {
        let range = extent(values.chain([0.0]), 0.08);
        Some([range.start, range.end])
    };
    x.range = over(&mut points.iter().map(|point| point[0]).chain(level));
    y.range = over(&mut points.iter().map(|point| point[1]));
    let title = short(&own.joint, 40);
    let series = vec![Series::curve("", points)];
    let panel = Panel::lines(title, (x, y), series, bound.into_iter().collect());
    Panel { markers: start.into_iter().collect(), ..panel }
}
