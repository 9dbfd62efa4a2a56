//! The pictures of a comparison at equal noise.

use maud::Markup;
use phihat_report::kit::draw::{FigureSize, svg};
use phihat_report::kit::figure::{Axis, AxisTicks, Band, Figure, Fill, Ink, Marker, Panel, Series};
use phihat_report::kit::text::{line, short};

use super::record::{Fronts, LawRecord};

/// A law's name for people, marked where it is tuned a second time.
pub(super) fn name(law: &LawRecord) -> String {
    let title = line(&law.title).replace(" (this project)", "");
    let again = law.again.is_some() && !title.ends_with("again");
    if again { format!("{title}, again") } else { title }
}

/// The name of a law by its id.
pub(super) fn name_of(fronts: &Fronts, id: &str) -> String {
    fronts.laws.iter().find(|law| law.id == id).map_or_else(|| line(id), name)
}

/// A law's curve with its name at the end, in the colour of what it knows: ours thick, a second name grey.
pub(super) fn curve(law: &LawRecord, points: Vec<[f64; 2]>) -> Series {
    let known = law.tier as u8;
    let ink = if law.again.is_some() {
        Ink::Soft
    } else if law.ours {
        Ink::Bold(known)
    } else {
        Ink::Thin(known)
    };
    Series { named: true, ..Series::curve(short(&name(law), 36), points).in_ink(ink) }
}

/// Curves as a picture.
pub(super) fn picture(title: &str, axes: (Axis, Axis), curves: Vec<Series>) -> Markup {
    let curves = curves.into_iter().filter(|curve| !curve.points.is_empty()).collect();
    let panels = vec![Panel::lines("", axes, curves, Vec::new())];
    svg(&Figure { title: title.to_owned(), panels, ..Figure::default() }, &FigureSize::WIDE)
}

/// Mean ranks on a line, the best first, over the stretch in which they do not differ.
pub(super) fn mean_ranks(fronts: &Fronts, laws: &[(String, f64)], difference: f64) -> Markup {
    let count = laws.len() as f64;
    let rows = || laws.iter().zip((0..).map(|place| count - f64::from(place) - 0.5));
    let marker = |((id, rank), y): (&(String, f64), f64)| Marker {
        at: [*rank, y],
        note: format!("{}: {rank:.2}", name_of(fronts, id)),
        ink: if id.starts_with("proposed") { Ink::Curve(0) } else { Ink::Soft },
        ..Marker::default()
    };
    let most = laws.iter().map(|(_, rank)| *rank).fold(2.0, f64::max).ceil();
    let best = laws.first().map_or(1.0, |(_, rank)| *rank);
    let alike = Band {
        steps: vec![[best, best + difference, 0.0, count]],
        fill: Fill::Same,
        ..Band::default()
    };
    let ranks =
        Axis { ticks: AxisTicks::Multiples(1.0), ..Axis::new("mean rank").over(0.8, most + 0.2) };
    let names =
        AxisTicks::Names(rows().map(|((id, _), y)| (y, short(&name_of(fronts, id), 34))).collect());
    let names = Axis { ticks: names, ..Axis::default().over(0.0, count) };
    let panel = Panel::lines("", (ranks, names), Vec::new(), Vec::new());
    let panel = Panel { bands: vec![alike], markers: rows().map(marker).collect(), ..panel };
    let title = "Mean ranks over the test worlds".to_owned();
    let figure = Figure { title, panels: vec![panel], ..Figure::default() };
    svg(&figure, &FigureSize::WIDE.of_height(52.0 + 22.0 * count))
}
