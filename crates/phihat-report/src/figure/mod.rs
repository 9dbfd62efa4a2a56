//! Static figures: every chart as small multiples, for paper.

use crate::arm::animation;
use crate::chart::{Chart, charts};
use crate::kind::Plane;
use crate::kit::MILLI;
use crate::kit::sheet::{Area, DrawError, Figure, HEADER, TEXT, TITLE, WIDTH, accessible};
use crate::kit::text::short;
use crate::record::{Record, Seen};
use crate::stretches::Row;
use ink::{INKS, dashed};
use panel::{Ink, draw_panel};
use plotters::prelude::*;

mod axis;
mod claims;
mod ink;
mod panel;

pub(crate) use claims::{claim_figures, front};

/// The name of every figure that a record may have.
pub const FIGURES: [&str; 13] = [
    "arm",
    "tracking",
    "error",
    "error-steady",
    "error-integral",
    "velocity-error",
    "torque",
    "unknown-dynamics",
    "phase",
    "torque-step",
    "inertia-window",
    "bode",
    "trade-off",
];

/// Every figure of a record: those of the run, and those of what was proved about its gains.
///
/// # Example
///
/// ```
/// # use phihat_report::{Drawing, Record, RunInfo};
/// # use phihat_sim::{Metrics, Simulation};
/// # use phihat_study::Study;
/// # let text = r#"
/// #     duration_s = 2.0
/// #     [robot]
/// #     name = "planar3r"
/// #     [spec]
/// #     settle_s = 1.0
/// #     error_max_rad = 2e-3
/// #     [gains]
/// #     order = 1
/// #     bandwidth_rad_s = 20.0
/// #     estimator_bandwidth_rad_s = 70.0
/// #     inertia_kg_m2 = [0.42, 0.18, 0.14]
/// #     [reference]
/// #     kind = "sines"
/// #     center = "ready"
/// #     fade_in_s = 1.0
/// #     [[reference.sine]]
/// #     amplitude_rad = 0.2
/// #     frequency_hz = 0.3
/// # "#;
/// # let study = Study::from_text(text, "demo.toml", "".as_ref())?;
/// # let gains = phihat_design::requested_gains(&study).ok_or("no gains")?;
/// # let names = study.robot.joint_names();
/// # let law = gains.joint_gains(&names, study.control.period_ns, Default::default())?;
/// # let trace = Simulation::new(&study, &law)?.run(|_| ()).trace;
/// # let metrics = Metrics::of(&trace, &study);
/// # let origin = RunInfo {
/// #     study: study.name.clone(), title: study.title.clone(), study_sha256: study.sha256.clone(),
/// #     seed: study.seed, robot: study.robot.name.clone(),
/// #     robot_description: study.robot.description.clone(),
/// #     robot_provenance: study.robot.provenance.clone(), phihat_version: String::new(),
/// #     toolchain: String::new(), form: "observer".to_owned(), rate_hz: 1000.0, delay_samples: 0,
/// #     world: Vec::new(), command: String::new(), warnings: Vec::new(),
/// # };
/// // A study, its gains, and what a run of them left: trace, metrics, and where it came from.
/// let drawing = Drawing::of(&trace, study.spec.settle);
/// let record = Record {
///     run: &origin,
///     study_text: &study.text,
///     gains: Some(&gains),
///     drawing: &drawing,
///     metrics: &metrics,
///     tube: None,
/// };
/// let figures = phihat_report::figures(&record);
/// assert!(figures.iter().any(|figure| figure.svg.starts_with("<svg")));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn figures(record: &Record<'_>) -> Vec<Figure> {
    let run = run_figures(&record.seen()).into_iter();
    arm(record).into_iter().chain(run).chain(claim_figures(record)).collect()
}

/// The arm as it moves, where one is recorded.
fn arm(record: &Record<'_>) -> Option<Figure> {
    // One scale for all joints: a bound is drawn where all have the same.
    let mut bounds = record.metrics.joints.iter().map(|joint| joint.error_spec_rad);
    let first = bounds.next().flatten();
    let same = |bound: Option<f64>| bound.map(f64::to_bits) == first.map(f64::to_bits);
    let bound = first.filter(|_| bounds.all(same));
    let bound = bound.map(|bound| (MILLI * bound, record.metrics.settle_s));
    let svg = animation(record.drawing, bound)?;
    Some(Figure { name: "arm".to_owned(), title: "The arm as it moves".to_owned(), svg })
}

/// The figures of the run, in the order of the page.
pub fn run_figures(record: &Seen<'_>) -> Vec<Figure> {
    let settle_s = record.metrics.settle_s;
    let mut figures = vec![];
    for chart in charts(record) {
        let whole = View { title: chart.title(), settle_s, rows: |drawn| &drawn.figure };
        figures.push(figure(&chart, chart.kind.stem, &whole));
        if let Some((stem, title)) = chart.steady() {
            figures.push(figure(
                &chart,
                stem,
                &View { title, settle_s, rows: |drawn| &drawn.steady },
            ));
        }
    }
    figures
}

fn figure(chart: &Chart, stem: &str, view: &View) -> Figure {
    Figure { name: stem.to_owned(), title: view.title.to_owned(), svg: draw(chart, view) }
}

/// Columns of panels and height of one.
fn grid(joints: usize) -> (usize, u32) {
    match joints {
        0 | 1 => (1, 960),
        2..=4 => (2, 640),
        5..=18 => (3, 540),
        _ => (4, 460),
    }
}

fn draw(chart: &Chart, view: &View) -> String {
    let (columns, height) = grid(chart.panels.len());
    let rows = chart.panels.len().div_ceil(columns).max(1);
    let size = (WIDTH, HEADER + height * u32::try_from(rows).unwrap_or(1));
    let mut svg = String::new();
    let drawn = {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        paint(chart, &root, (rows, columns), view)
    };
    match drawn {
        Ok(()) => accessible(&dashed(&svg), view.title, size),
        Err(_) => format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} 60"><text x="10" y="40" font-size="24">{}: could not be drawn</text></svg>"#,
            view.title
        ),
    }
}

/// Part of a chart that a figure draws: the whole run or the steady part.
struct View {
    title: &'static str,
    settle_s: f64,
    rows: fn(&crate::drawing::Drawn) -> &Vec<Row>,
}

fn paint(
    chart: &Chart,
    root: &Area<'_>,
    shape: (usize, usize),
    view: &View,
) -> Result<(), DrawError> {
    root.fill(&WHITE)?;
    let (header, body) = root.split_vertically(HEADER);
    header.draw(&Text::new(view.title, (32, 20), ("sans-serif", TITLE).into_font()))?;
    if chart.kind.plane == Plane::Time && chart.kind.curves.len() > 1 {
        draw_legend(chart, &header)?;
    }
    for (panel, area) in chart.panels.iter().zip(body.split_evenly(shape)) {
        let rows = (view.rows)(&panel.drawn);
        let curve = |c: usize| rows.iter().map(|row| row.y[c]).collect();
        let ink = Ink {
            kind: chart.kind,
            name: short(&panel.joint, 40),
            slides: panel.slides,
            t: rows.iter().map(|row| row.t).collect(),
            curves: (0..chart.kind.curves.len()).map(curve).collect(),
            bound: panel.bound,
            tube: panel.tube.as_ref(),
            settle_s: view.settle_s,
        };
        draw_panel(&ink, &area)?;
    }
    Ok(root.present()?)
}

fn draw_legend(chart: &Chart, header: &Area<'_>) -> Result<(), DrawError> {
    let mut x = 2520;
    for (curve, ink) in chart.kind.curves.iter().zip(INKS).rev() {
        let width = i32::try_from(curve.label.chars().count()).unwrap_or(10) * 28;
        x -= width;
        header.draw(&Text::new(curve.label, (x, 26), ("sans-serif", TEXT).into_font()))?;
        header.draw(&PathElement::new([(x - 140, 52), (x - 20, 52)], ink.stroke_width(6)))?;
        x -= 200;
    }
    Ok(())
}
