//! Torque noise of laws with other error bounds.

use phihat_design::TradeOff;

use super::ends::ends;
use crate::kit::draw::{FigureSize, Picture, draw};
use crate::kit::figure::{Axis, Bound, Figure, Ink, Marker, Panel, Series};

/// Laws as error against torque noise, the chosen one called by a name; `None`: there is none to draw.
pub(crate) fn figure(points: &[TradeOff], chosen: &str) -> Option<Picture> {
    let at = |p: &TradeOff| [p.torque_noise_nm, p.error_share];
    let drawn: Vec<&TradeOff> = points
        .iter()
        .filter(|p| at(p).iter().all(|value| *value > 0.0) && p.error_share.is_finite())
        .collect();
    let x = ends(drawn.iter().map(|p| p.torque_noise_nm), 1.15)?;
    let y = ends(drawn.iter().map(|p| p.error_share).chain([1.0]), 1.4)?;
    let orders = [("order 1", false, 0), ("order 2 and up", true, 1)].map(|(label, high, ink)| {
        let of = drawn.iter().filter(|p| (p.order > 1) == high).map(|p| at(p));
        Series::marks(label, of.collect()).in_ink(Ink::Curve(ink))
    });
    let series = orders.into_iter().filter(|order| !order.points.is_empty()).collect();
    let bound = Bound { in_view: true, ..Bound::at("asked for", 1.0) };
    let markers = drawn.iter().filter(|p| p.chosen).take(1).map(|p| Marker {
        at: at(p),
        label: chosen.to_owned(),
        ring: true,
        ink: Ink::Curve(u8::from(p.order > 1)),
        ..Marker::default()
    });
    let axes = (
        Axis::log("largest Δτ per sample from encoder steps [N·m]").over(x[0], x[1]),
        Axis::log("bound on |e| / bound asked for").over(y[0], y[1]),
    );
    let markers = markers.collect();
    let panel = Panel { markers, ..Panel::lines("", axes, series, vec![bound]) };
    let title = "The price of the bound: error against torque noise".to_owned();
    let figure =
        Figure { id: "trade-off".to_owned(), title, panels: vec![panel], ..Figure::default() };
    Some(draw(&figure, &FigureSize::PAPER))
}
