//! Torque noise of laws with other error bounds.

use phihat_design::TradeOff;

use plotters::prelude::*;

use super::sheet::{INKS, WIDTH_I, decades, legend, mesh, sheet};
use crate::figure::ink::BOUND_INK;
use crate::kit::sheet::{Figure, TEXT, log_ticks};

/// Laws as error against torque noise, the chosen one called by a name; `None`: there is none to draw.
pub(crate) fn figure(points: &[TradeOff], chosen: &str) -> Option<Figure> {
    let drawn: Vec<&TradeOff> = points
        .iter()
        .filter(|p| p.error_share > 0.0 && p.torque_noise_nm > 0.0 && p.error_share.is_finite())
        .collect();
    let x = decades(drawn.iter().map(|p| p.torque_noise_nm), 1.15)?;
    let y = decades(drawn.iter().map(|p| p.error_share).chain([1.0]), 1.4)?;
    let title = "The price of the bound: error against torque noise";
    sheet(("trade-off", title), 1000, |header, body| {
        let mut right = WIDTH_I - 40;
        right = legend(header, right, "asked for", BOUND_INK.stroke_width(5))?;
        let orders = |high: bool| drawn.iter().any(|p| (p.order > 1) == high);
        for (high, label) in [(true, "order 2 and up"), (false, "order 1")] {
            if orders(high) {
                let width = i32::try_from(label.chars().count()).unwrap_or(10) * 27;
                let text = Text::new(label, (right - width, 26), ("sans-serif", TEXT).into_font());
                header.draw(&text)?;
                header.draw(&Circle::new((right - width - 40, 52), 14, mark(high)))?;
                right -= width + 110;
            }
        }
        let mut plane = ChartBuilder::on(body)
            .margin(12)
            .margin_right(60)
            .x_label_area_size(130)
            .y_label_area_size(230)
            .build_cartesian_2d(
                x.clone().log_scale().with_key_points(log_ticks(&x)),
                y.clone().log_scale().with_key_points(log_ticks(&y)),
            )?;
        let labels =
            ("largest Δτ per sample from encoder steps [N·m]", "bound on |e| / bound asked for");
        mesh(&mut plane, labels, 6)?;
        let level = [(x.start, 1.0), (x.end, 1.0)];
        plane.draw_series(LineSeries::new(level, BOUND_INK.stroke_width(4)))?;
        let at = |p: &TradeOff| (p.torque_noise_nm, p.error_share);
        let circles = drawn.iter().map(|p| Circle::new(at(p), 12, mark(p.order > 1)));
        plane.draw_series(circles)?;
        if let Some(one) = drawn.iter().find(|p| p.chosen) {
            let ring = EmptyElement::at(at(one))
                + Circle::new((0, 0), 26, INKS[1].stroke_width(7))
                + Text::new(chosen.to_owned(), (40, -70), ("sans-serif", TEXT).into_font());
            plane.draw_series([ring])?;
        }
        Ok(())
    })
}

fn mark(high: bool) -> ShapeStyle {
    if high { INKS[0].stroke_width(5) } else { INKS[0].filled() }
}
