//! One joint's panel of a static figure.

use super::axis::strokes;
use super::ink::{BOUND_INK, INKS, TUBE_INK};
use crate::band::Band;
use crate::kind::{Kind, Plane};
use crate::kit::number::{number, tick};
use crate::kit::sheet::{Area, DrawError, TEXT, extent};
use crate::kit::unit_of;
use plotters::chart::ChartContext;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use std::ops::Range;

/// A bound farther out than this many times the data is told in words, not drawn: the curve would
/// be a line.
const BOUND_REACH: f64 = 10.0;

/// Contents of one panel.
pub(super) struct Ink<'a> {
    pub kind: &'a Kind,
    pub name: String,
    pub slides: bool,
    pub t: Vec<f64>,
    pub curves: Vec<Vec<f64>>,
    pub bound: Option<f64>,
    pub tube: Option<&'a Band>,
    pub settle_s: f64,
}

type Plane2<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

pub(super) fn draw_panel(ink: &Ink<'_>, area: &Area<'_>) -> Result<(), DrawError> {
    let (x, y) = ranges(ink);
    let mut plane = ChartBuilder::on(area)
        .caption(caption(ink), ("sans-serif", TEXT))
        .margin(12)
        .margin_right(48)
        .x_label_area_size(124)
        .y_label_area_size(216)
        .build_cartesian_2d(x.clone(), y.clone())?;
    plane
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(RGBColor(222, 222, 222).stroke_width(2))
        .axis_style(BLACK.stroke_width(2))
        .set_all_tick_mark_size(8)
        .x_labels(5)
        .y_labels(5)
        .x_label_formatter(&|v| tick(*v, x.end - x.start))
        .y_label_formatter(&|v| tick(*v, y.end - y.start))
        .label_style(("sans-serif", TEXT))
        .axis_desc_style(("sans-serif", TEXT))
        .x_desc(unit_of(ink.kind.x_label, ink.slides))
        .y_desc(unit_of(ink.kind.y_label, ink.slides))
        .draw()?;
    draw_tube(ink, &mut plane, &x)?;
    draw_bounds(ink, &mut plane, &x, &y)?;
    match ink.kind.plane {
        Plane::Time => draw_curves(ink, &mut plane),
        Plane::Phase => draw_orbit(ink, &mut plane),
    }
}

/// The joint's name, and the bound where it does not fit on the axis.
fn caption(ink: &Ink<'_>) -> String {
    let label = ink.kind.bound.label;
    match (ink.bound, seen_bound(ink)) {
        (Some(bound), None) => format!("{} ({label} ±{}, off the axis)", ink.name, number(bound)),
        _ => ink.name.clone(),
    }
}

/// The bound, if the data come near enough to it.
fn seen_bound(ink: &Ink<'_>) -> Option<f64> {
    let against = ink.curves.first().filter(|_| ink.kind.plane == Plane::Phase);
    let curves = against.map_or(&ink.curves[..], std::slice::from_ref);
    let peak =
        curves.iter().flatten().filter(|v| v.is_finite()).fold(0.0, |p: f64, v| p.max(v.abs()));
    ink.bound.filter(|b| b.is_finite() && (*b <= BOUND_REACH * peak || ink.kind.bound.after_settle))
}

fn ranges(ink: &Ink<'_>) -> (Range<f64>, Range<f64>) {
    let bounds = || seen_bound(ink).into_iter().flat_map(|b| [b, -b]);
    if let (Plane::Phase, [e, de, ..]) = (ink.kind.plane, &ink.curves[..]) {
        let x = e.iter().copied().chain(bounds()).chain([0.0]);
        return (extent(x, 0.08), extent(de.iter().copied().chain([0.0]), 0.08));
    }
    let x = extent(ink.t.iter().copied(), 0.0);
    let steps = ink.tube.map_or(vec![], |tube| tube.within((x.start, x.end)));
    let tube = steps.iter().flat_map(|(.., low, high)| [*low, *high]);
    let y = ink.curves.iter().flatten().copied().chain(bounds()).chain(tube);
    let y = extent(y, 0.08);
    (x, y)
}

/// A band of steps, drawn as one shape: there and back.
fn draw_tube(ink: &Ink<'_>, plane: &mut Plane2<'_, '_>, x: &Range<f64>) -> Result<(), DrawError> {
    let steps = ink.tube.map_or(vec![], |tube| tube.within((x.start, x.end)));
    let finite = steps.into_iter().filter(|(.., low, high)| (high - low).is_finite());
    let steps: Vec<_> = finite.collect();
    let above = steps.iter().flat_map(|(from, to, _, high)| [(*from, *high), (*to, *high)]);
    let below = steps.iter().rev().flat_map(|(from, to, low, _)| [(*to, *low), (*from, *low)]);
    let outline: Vec<_> = above.chain(below).collect();
    if !outline.is_empty() {
        plane.draw_series([Polygon::new(outline, TUBE_INK.mix(0.25).filled())])?;
    }
    Ok(())
}

fn draw_bounds(
    ink: &Ink<'_>,
    plane: &mut Plane2<'_, '_>,
    x: &Range<f64>,
    y: &Range<f64>,
) -> Result<(), DrawError> {
    let Some(bound) = seen_bound(ink) else { return Ok(()) };
    let style = BOUND_INK.stroke_width(4);
    let from = if ink.kind.bound.after_settle { ink.settle_s.max(x.start) } else { x.start };
    for level in [bound, -bound] {
        let ends = match ink.kind.plane {
            Plane::Time => [(from.min(x.end), level), (x.end, level)],
            Plane::Phase => [(level, y.start), (level, y.end)],
        };
        plane.draw_series(LineSeries::new(ends, style))?;
    }
    Ok(())
}

fn draw_curves(ink: &Ink<'_>, plane: &mut Plane2<'_, '_>) -> Result<(), DrawError> {
    for (curve, color) in ink.curves.iter().zip(INKS) {
        for stroke in strokes(&ink.t, curve) {
            draw_stroke(plane, stroke, color)?;
        }
    }
    Ok(())
}

fn draw_orbit(ink: &Ink<'_>, plane: &mut Plane2<'_, '_>) -> Result<(), DrawError> {
    let [e, de, ..] = &ink.curves[..] else { return Ok(()) };
    let strokes = strokes(e, de);
    let start = strokes.first().and_then(|s| s.first()).copied();
    for stroke in strokes {
        draw_stroke(plane, stroke, INKS[0])?;
    }
    let Some(start) = start else { return Ok(()) };
    plane.draw_series([Circle::new(start, 12, BLACK.filled())])?;
    // Beside the dot, towards the middle.
    let (x, y) = (plane.x_range(), plane.y_range());
    let right = start.0 > x.start.midpoint(x.end);
    let low = start.1 < y.start.midpoint(y.end);
    let offset = (if right { -125 } else { 25 }, if low { -60 } else { 20 });
    let text = Text::new("start", offset, ("sans-serif", TEXT).into_font());
    let label = EmptyElement::at(start) + text;
    plane.draw_series([label])?;
    Ok(())
}

/// A line, or a dot where there is a single sample.
fn draw_stroke(
    plane: &mut Plane2<'_, '_>,
    stroke: Vec<(f64, f64)>,
    color: RGBColor,
) -> Result<(), DrawError> {
    if let [point] = stroke[..] {
        plane.draw_series([Circle::new(point, 6, color.filled())])?;
    } else {
        plane.draw_series(LineSeries::new(stroke, color.stroke_width(5)))?;
    }
    Ok(())
}
