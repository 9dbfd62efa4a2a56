//! Each joint's window of inertia against what the arm's inertia may be.

use phihat_design::{Certificate, Gains};
use plotters::coord::combinators::LogCoord;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::sheet::{INKS, WIDTH_I, decades, legend, plain, sheet};
use crate::kit::sheet::{Area, DrawError, Figure, TEXT};
use crate::kit::text::short;

/// Height of a joint's row.
const ROW: u32 = 110;

/// The window; the arm's range is drawn inside of it.
const WINDOW_INK: RGBColor = RGBColor(168, 214, 240);

type Plane<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<LogCoord<f64>, RangedCoordf64>>;

/// One joint: all inertias in kg·m².
struct Row {
    name: String,
    nominal: f64,
    window: (f64, f64),
    /// The arm's range, and what it is with the margin.
    range: (f64, f64),
    reach: (f64, f64),
}

pub(super) fn figure(gains: &Gains, certificate: &Certificate) -> Option<Figure> {
    let (arm, margin) = (&certificate.arm, certificate.window_margin);
    let joints = gains.joints.iter().zip(&certificate.joints);
    let row = |(joint, claim): (&phihat_design::JointRecord, &phihat_design::JointCertificate)| {
        let of = |mu: f64| mu * joint.inertia_kg_m2;
        let window = claim.window?;
        Some(Row {
            name: short(&joint.name, 24),
            nominal: of(1.0),
            window: (of(window.low), of(window.high)),
            range: (of(arm.low), of(arm.high)),
            reach: (of(arm.low / margin), of(arm.high * margin)),
        })
    };
    let rows: Vec<Row> = joints.filter_map(row).collect();
    let ends = rows.iter().flat_map(|r| [r.window.0, r.window.1, r.reach.0, r.reach.1]);
    let x = decades(ends, 1.3)?;
    let count = u32::try_from(rows.len()).ok()?;
    let title = "Inertia: each joint's stable window, and the arm inside";
    sheet(("inertia-window", title), 210 + ROW * count, |header, body| {
        let mut right = WIDTH_I - 40;
        right = legend(header, right, "window", WINDOW_INK.stroke_width(44))?;
        right = legend(header, right, "arm", INKS[0].stroke_width(26))?;
        legend(header, right, "margin", BLACK.stroke_width(5))?;
        let mut plane = ChartBuilder::on(body)
            .margin(12)
            .margin_right(60)
            .x_label_area_size(130)
            .y_label_area_size(460)
            .build_cartesian_2d(x.clone().log_scale(), 0.0..f64::from(count))?;
        axis(&mut plane)?;
        for (index, row) in (0..count).zip(&rows) {
            let middle = f64::from(count - index) - 0.5;
            draw_row(&mut plane, row, middle)?;
            let (_, y) = plane.backend_coord(&(x.start, middle));
            let (_, top) = body.get_base_pixel();
            name(body, &row.name, y - top)?;
        }
        Ok(())
    })
}

fn axis(plane: &mut Plane<'_, '_>) -> Result<(), DrawError> {
    let drawn = plane
        .configure_mesh()
        .disable_y_mesh()
        .disable_y_axis()
        .light_line_style(TRANSPARENT)
        .bold_line_style(RGBColor(222, 222, 222).stroke_width(2))
        .axis_style(BLACK.stroke_width(2))
        .set_all_tick_mark_size(8)
        .x_labels(8)
        .x_label_formatter(&|v| plain(*v))
        .label_style(("sans-serif", TEXT))
        .axis_desc_style(("sans-serif", TEXT))
        .x_desc("inertia [kg·m²]; the tick is M̄")
        .draw();
    Ok(drawn?)
}

fn draw_row(plane: &mut Plane<'_, '_>, row: &Row, middle: f64) -> Result<(), DrawError> {
    let bar = |ends: (f64, f64), half: f64, ink: RGBColor| {
        Rectangle::new([(ends.0, middle - half), (ends.1, middle + half)], ink.filled())
    };
    let line = |points: [(f64, f64); 2]| PathElement::new(points, BLACK.stroke_width(5));
    let upright = |x: f64, half: f64| line([(x, middle - half), (x, middle + half)]);
    plane.draw_series([bar(row.window, 0.36, WINDOW_INK)])?;
    plane.draw_series([bar(row.range, 0.2, INKS[0])])?;
    let marks = [
        line([(row.reach.0, middle), (row.range.0, middle)]),
        line([(row.range.1, middle), (row.reach.1, middle)]),
        upright(row.reach.0, 0.12),
        upright(row.reach.1, 0.12),
        upright(row.nominal, 0.3),
    ];
    plane.draw_series(marks)?;
    Ok(())
}

/// A joint's name beside its row.
fn name(body: &Area<'_>, name: &str, y: i32) -> Result<(), DrawError> {
    let text = Text::new(name.to_owned(), (32, y - 26), ("sans-serif", TEXT).into_font());
    Ok(body.draw(&text)?)
}
