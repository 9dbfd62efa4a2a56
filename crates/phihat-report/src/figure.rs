//! Static figures: every chart as small multiples, for paper.

use crate::chart::{Chart, Plane, charts, settle_index, times};
use crate::decimate::kept;
use crate::record::Record;
use crate::text::short;
use panel::{Ink, draw_panel};
use plotters::prelude::*;

mod axis;
mod panel;

/// One figure of a record.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    /// File stem: `tracking`, `error`, …
    pub name: String,
    /// What it shows.
    pub title: String,
    /// The figure, made for 16 cm of width.
    pub svg: String,
}

/// 80 pixels per centimetre on paper.
const WIDTH: u32 = 1280;
const HEADER: u32 = 64;
/// Stretches kept per panel: two pixels each where a panel has half the width.
const BUCKETS: usize = 220;

/// Every figure of a record, in the order of the page.
pub fn figures(record: &Record<'_>) -> Vec<Figure> {
    let (t, settle) = (times(record), settle_index(record));
    let figure = |chart: &Chart| Figure {
        name: chart.stem.to_owned(),
        title: chart.title.to_owned(),
        svg: draw(chart, &t, settle, record.metrics.settle_s),
    };
    charts(record).iter().map(figure).collect()
}

/// Columns of panels and height of one.
fn grid(joints: usize) -> (usize, u32) {
    match joints {
        0 | 1 => (1, 480),
        2..=8 => (2, 300),
        9..=18 => (3, 230),
        _ => (4, 200),
    }
}

fn draw(chart: &Chart, t: &[f64], settle: usize, settle_s: f64) -> String {
    let (columns, height) = grid(chart.panels.len());
    let rows = chart.panels.len().div_ceil(columns).max(1);
    let size = (WIDTH, HEADER + height * u32::try_from(rows).unwrap_or(1));
    let mut svg = String::new();
    let drawn = {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        paint(chart, &root, (rows, columns), &Run { t, settle, settle_s })
    };
    match drawn {
        Ok(()) => accessible(&dashed(&svg), chart.title),
        Err(_) => format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} 60"><text x="10" y="40" font-size="24">{}: could not be drawn</text></svg>"#,
            chart.title
        ),
    }
}

/// The time base that all panels share.
struct Run<'a> {
    t: &'a [f64],
    settle: usize,
    settle_s: f64,
}

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
type Drawn<'a> = Result<(), DrawingAreaErrorKind<<SVGBackend<'a> as DrawingBackend>::ErrorType>>;

fn paint<'a>(chart: &Chart, root: &Area<'a>, shape: (usize, usize), run: &Run<'_>) -> Drawn<'a> {
    root.fill(&WHITE)?;
    let (header, body) = root.split_vertically(HEADER);
    header.draw(&Text::new(chart.title, (16, 14), ("sans-serif", 32).into_font()))?;
    if chart.plane == Plane::Time && chart.curves.len() > 1 {
        draw_legend(chart, &header)?;
    }
    let last_row = chart.panels.len().saturating_sub(shape.1);
    let end = if chart.plane == Plane::Phase { run.settle } else { run.t.len() };
    for (j, (panel, area)) in chart.panels.iter().zip(body.split_evenly(shape)).enumerate() {
        let indices = kept(&panel.curves, 0..end, BUCKETS);
        let pick = |v: &[f64]| -> Vec<f64> { indices.iter().map(|&k| v[k]).collect() };
        let ink = Ink {
            chart,
            name: short(&panel.joint, 40),
            t: pick(run.t),
            curves: panel.curves.iter().map(|c| pick(c)).collect(),
            bound: panel.bound,
            settle_s: run.settle_s,
            y_titled: j % shape.1 == 0,
            x_titled: j >= last_row,
        };
        draw_panel(&ink, &area)?;
    }
    root.present()
}

/// Colours of the curves, after Okabe and Ito; the second is the dashed one.
const INKS: [RGBColor; 2] = [RGBColor(0, 114, 178), RGBColor(213, 94, 0)];
/// Colour of bounds and marks.
const BOUND_INK: RGBColor = RGBColor(90, 90, 91);

fn draw_legend<'a>(chart: &Chart, header: &Area<'a>) -> Drawn<'a> {
    let mut x = 1264;
    for (curve, ink) in chart.curves.iter().zip(INKS).rev() {
        let width = i32::try_from(curve.label.chars().count()).unwrap_or(10) * 14;
        x -= width;
        header.draw(&Text::new(curve.label, (x, 18), ("sans-serif", 28).into_font()))?;
        header.draw(&PathElement::new([(x - 70, 34), (x - 10, 34)], ink.stroke_width(3)))?;
        x -= 100;
    }
    Ok(())
}

/// Gives the second curve and the bounds their dashes. Our backend draws each dash as an element
/// of its own, which costs megabytes; no text of a user can hold the quotes looked for here.
fn dashed(svg: &str) -> String {
    svg.replace(r##"stroke="#D55E00""##, r##"stroke="#D55E00" stroke-dasharray="14 7""##)
        .replace(r##"stroke="#5A5A5B""##, r##"stroke="#5A5A5B" stroke-dasharray="5 5""##)
}

/// Names the figure for those who do not see it, and lets it shrink with its page.
fn accessible(svg: &str, title: &str) -> String {
    svg.replacen("<svg ", &format!(r#"<svg role="img" aria-label="{title}" "#), 1)
}
