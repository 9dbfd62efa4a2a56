//! Curves, points and bounds; each has its colour and its dashes or its shape.

use crate::record::{Bound, Series};
use plotters::prelude::*;

use super::canvas::{FigureError, Plane};
use super::scale::Scale;
use super::stroke::Window;
use phihat_report::kit::number::number;

/// Curves that can be told apart.
pub(super) const SERIES_MAX: usize = 6;

/// Colours after Okabe and Ito, and the dashes of each curve \[px\].
const INKS: [(RGBColor, &str); SERIES_MAX] = [
    (RGBColor(0, 114, 178), ""),
    (RGBColor(213, 94, 0), "28 14"),
    (RGBColor(0, 158, 115), "8 11"),
    (RGBColor(204, 121, 167), "40 12 8 12"),
    (RGBColor(230, 159, 0), "56 16"),
    (RGBColor(86, 180, 233), "24 10 7 10 7 10"),
];

/// Greys of bounds, alike to the eye, and their dashes.
const BOUND_INKS: [(RGBColor, &str); 3] = [
    (RGBColor(90, 90, 91), "12 10"),
    (RGBColor(90, 90, 92), "34 10 6 10"),
    (RGBColor(90, 90, 93), "4 14"),
];

const CURVE_WIDTH: u32 = 5;
const BOUND_WIDTH: u32 = 4;

/// A bound farther out than this many times the data is told in words, not drawn: the curve would
/// be a line.
const BOUND_REACH: f64 = 10.0;

pub(super) fn curve_ink(index: usize) -> ShapeStyle {
    INKS[index % SERIES_MAX].0.stroke_width(CURVE_WIDTH)
}

pub(super) fn bound_ink(index: usize) -> ShapeStyle {
    BOUND_INKS[index % BOUND_INKS.len()].0.stroke_width(BOUND_WIDTH)
}

/// The levels of the bounds that are near enough to the data to be drawn.
pub(super) fn levels<'a>(
    series: &'a [Series],
    bounds: &'a [Bound],
) -> impl Iterator<Item = f64> + 'a {
    let values = series.iter().flat_map(|curve| &curve.points).map(|point| point[1].abs());
    let peak = values.filter(|v| v.is_finite()).fold(0.0, f64::max);
    let near = bounds.iter().filter(move |bound| bound.value.abs() <= BOUND_REACH * peak);
    near.flat_map(both)
}

fn both(bound: &Bound) -> impl Iterator<Item = f64> + use<> {
    [Some(bound.value), bound.both.then_some(-bound.value)].into_iter().flatten()
}

/// Draws bounds, then curves over them.
pub(super) fn draw(
    series: &[Series],
    bounds: &[Bound],
    plane: &mut Plane<'_, '_>,
    (x, y, window): &(&Scale, &Scale, &Window),
) -> Result<(), FigureError> {
    for (index, bound) in bounds.iter().enumerate() {
        for level in seen(bound, y) {
            let ends = [(window.x.start, level), (window.x.end, level)];
            plane.draw_series(LineSeries::new(ends, bound_ink(index)))?;
        }
    }
    for (index, curve) in series.iter().take(SERIES_MAX).enumerate() {
        let points = curve.points.iter().map(|[px, py]| (x.at(*px), y.at(*py)));
        if curve.marks {
            let inside = points.filter(|point| window.holds(*point));
            plane.draw_series(inside.map(|at| EmptyElement::at(at) + shape(index)))?;
        } else {
            for stroke in window.strokes(points) {
                draw_stroke(plane, stroke, index)?;
            }
        }
    }
    Ok(())
}

/// Coordinates of a bound on the axis.
fn seen(bound: &Bound, y: &Scale) -> Vec<f64> {
    both(bound).map(|level| y.at(level)).filter(|level| y.holds(*level)).collect()
}

/// Bounds that the axis does not reach, in words.
pub(super) fn off_axis(bounds: &[Bound], y: &Scale) -> Vec<String> {
    let off = bounds.iter().filter(|bound| seen(bound, y).is_empty());
    off.map(|bound| {
        let sign = if bound.both { "±" } else { "" };
        format!("off the axis: {} {sign}{}", bound.label, number(bound.value))
    })
    .collect()
}

/// A line, or a mark where there is a single point.
fn draw_stroke(
    plane: &mut Plane<'_, '_>,
    stroke: Vec<(f64, f64)>,
    index: usize,
) -> Result<(), FigureError> {
    if let [at] = stroke[..] {
        plane.draw_series([EmptyElement::at(at) + shape(index)])?;
    } else {
        plane.draw_series(LineSeries::new(stroke, curve_ink(index)))?;
    }
    Ok(())
}

/// The mark of a curve's points: circle, square, triangle, diamond, cross, plus.
pub(super) fn shape(index: usize) -> Polygon<(i32, i32)> {
    let ink = INKS[index % SERIES_MAX].0.filled();
    let corners: Vec<(i32, i32)> = match index % SERIES_MAX {
        0 => vec![(11, 0), (8, 8), (0, 11), (-8, 8), (-11, 0), (-8, -8), (0, -11), (8, -8)],
        1 => vec![(10, 10), (-10, 10), (-10, -10), (10, -10)],
        2 => vec![(0, -14), (13, 10), (-13, 10)],
        3 => vec![(0, -15), (12, 0), (0, 15), (-12, 0)],
        4 => arms(|x, y| (x - y, x + y)),
        _ => arms(|x, y| (x * 3 / 2, y * 3 / 2)),
    };
    Polygon::new(corners, ink)
}

/// An upright cross as an outline, turned or stretched: lines would take on the curve's dashes.
fn arms(place: fn(i32, i32) -> (i32, i32)) -> Vec<(i32, i32)> {
    let (half, long) = (2, 10);
    let quarter = [(half, half), (half, long), (-half, long)];
    let turned = |times: usize| {
        let turn = move |point| (0..times).fold(point, |(x, y): (i32, i32), _| (-y, x));
        quarter.into_iter().map(turn)
    };
    (0..4).flat_map(turned).map(|(x, y)| place(x, y)).collect()
}

/// Gives every curve and bound its dashes. Our backend draws each dash as an element of its own, which
/// costs megabytes; no text of a user can hold the quotes looked for here.
pub(super) fn dashed(svg: &str) -> String {
    let curves = INKS.iter().map(|ink| (ink, CURVE_WIDTH));
    let bounds = BOUND_INKS.iter().map(|ink| (ink, BOUND_WIDTH));
    curves.chain(bounds).fold(svg.to_owned(), |svg, ((RGBColor(r, g, b), dashes), width)| {
        let plain = format!(r##"stroke="#{r:02X}{g:02X}{b:02X}" stroke-width="{width}""##);
        let dashes = if dashes.is_empty() {
            String::new()
        } else {
            format!(r#" stroke-dasharray="{dashes}""#)
        };
        svg.replace(&plain, &format!(r#"{plain} stroke-linejoin="round"{dashes}"#))
    })
}
