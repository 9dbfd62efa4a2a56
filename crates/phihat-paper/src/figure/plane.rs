//! The axes of a panel, and what is drawn between them.

use crate::record::{Axis, Content, Panel};
use plotters::prelude::*;

use super::canvas::{BOTTOM, FigureError, LEFT, Plane, RIGHT, TOP};
use super::scale::Scale;
use super::stroke::Window;
use super::{lines, map};
use phihat_report::kit::sheet::{Area, TEXT};
use phihat_report::kit::text::short;

/// Left of the vertical axis' label \[px\].
const EDGE: u32 = 14;

/// Height that a panel of equal units needs for its axes at a width; `None` where units differ.
pub(super) fn height(panel: &Panel, width: u32, most: u32) -> Option<u32> {
    let (x, y) = scales(panel);
    let room = (width.saturating_sub(LEFT + RIGHT), most.saturating_sub(TOP + BOTTOM));
    panel.equal.then(|| fitted(room, x.length() / y.length()).1 + TOP + BOTTOM)
}

/// Contents of a panel that it cannot show, in words.
pub(super) fn words(panel: &Panel) -> Vec<String> {
    match &panel.content {
        Content::Lines { bounds, .. } => lines::off_axis(bounds, &scales(panel).1),
        Content::Map { .. } => Vec::new(),
    }
}

/// Draws a panel; its area has the axes and their labels and nothing else.
pub(super) fn draw(panel: &Panel, area: &Area<'_>) -> Result<(), FigureError> {
    let (x, y) = scales(panel);
    let size = area.dim_in_pixel();
    let room = (size.0.saturating_sub(LEFT + RIGHT), size.1.saturating_sub(TOP + BOTTOM));
    let (width, height) = if panel.equal { fitted(room, x.length() / y.length()) } else { room };
    let side = (room.0 - width) / 2;
    let mut plane = ChartBuilder::on(area)
        .margin_left(side + EDGE)
        .margin_right(RIGHT + (room.0 - width - side))
        .margin_top(TOP)
        .margin_bottom(room.1 - height)
        .x_label_area_size(BOTTOM)
        .y_label_area_size(LEFT - EDGE)
        .build_cartesian_2d(x.clone(), y.clone())?;
    mesh(panel, &mut plane, (&x, &y))?;
    let window = Window {
        pixels: [f64::from(width) / x.length(), f64::from(height) / y.length()],
        x: plane.x_range(),
        y: plane.y_range(),
    };
    match &panel.content {
        Content::Lines { series, bounds } => {
            lines::draw(series, bounds, &mut plane, &(&x, &y, &window))
        }
        Content::Map { .. } => {
            map::draw(&panel.content, &mut plane, (&x, &y))?;
            frame(&mut plane, &window)
        }
    }
}

/// The largest size of an aspect inside a room.
fn fitted((width, height): (u32, u32), aspect: f64) -> (u32, u32) {
    let pixels = |value: f64| {
        // Both ends are sizes of an area: small and not negative.
        format!("{:.0}", value.clamp(40.0, 4000.0)).parse::<u32>().unwrap_or(40)
    };
    let by_height = f64::from(height) * aspect;
    if by_height <= f64::from(width) {
        (pixels(by_height).min(width), height)
    } else {
        (width, pixels(f64::from(width) / aspect).min(height))
    }
}

fn scales(panel: &Panel) -> (Scale, Scale) {
    match &panel.content {
        Content::Lines { series, bounds } => {
            let points = || series.iter().flat_map(|curve| &curve.points);
            let y = points().map(|p| p[1]).chain(lines::levels(series, bounds));
            (
                Scale::new(&panel.x, points().map(|p| p[0]), panel.equal),
                Scale::new(&panel.y, y, true),
            )
        }
        Content::Map { x, y, .. } => {
            let scale = |axis: &Axis, places: &[f64]| {
                Scale::new(axis, map::edges(places, axis.log).into_iter(), false)
            };
            (scale(&panel.x, x), scale(&panel.y, y))
        }
    }
}

fn mesh(
    panel: &Panel,
    plane: &mut Plane<'_, '_>,
    (x, y): (&Scale, &Scale),
) -> Result<(), FigureError> {
    let drawn = plane
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(RGBColor(222, 222, 222).stroke_width(2))
        .axis_style(BLACK.stroke_width(2))
        .set_all_tick_mark_size(8)
        .x_label_formatter(&|v| x.label(*v))
        .y_label_formatter(&|v| y.label(*v))
        .label_style(("sans-serif", TEXT))
        .axis_desc_style(("sans-serif", TEXT))
        .x_desc(short(&panel.x.label, 60))
        .y_desc(short(&panel.y.label, 40))
        .draw();
    Ok(drawn?)
}

/// Cells cover the axes.
fn frame(plane: &mut Plane<'_, '_>, window: &Window) -> Result<(), FigureError> {
    let corners = [(window.x.start, window.y.start), (window.x.end, window.y.end)];
    plane.draw_series([Rectangle::new(corners, BLACK.stroke_width(2))])?;
    Ok(())
}
