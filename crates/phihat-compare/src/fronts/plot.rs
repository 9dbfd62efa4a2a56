//! The pictures of a comparison at equal noise.

use maud::{Markup, html};
use phihat_report::kit::text::line;

use crate::page::axis::{Axis, axes};
use crate::page::labels::places;

/// Size of a picture, and its margins: left, top, right, bottom.
const SIZE: [f64; 2] = [960.0, 560.0];
const MARGIN: [f64; 4] = [70.0, 16.0, 16.0, 56.0];
/// Width of a character of a label, generously.
const CHARACTER: f64 = 6.9;

/// A law's curve.
#[derive(Debug, Clone)]
pub(super) struct Curve {
    pub(super) name: String,
    /// `ours`, `k0` …: how it is drawn.
    pub(super) class: &'static str,
    pub(super) places: Vec<Place>,
}

/// A place of a curve, and from where to where its quartiles reach.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) quartiles: Option<[f64; 2]>,
}

/// Curves on logarithmic axes, each with its name at its last place.
pub(super) fn curves(all: &[Curve], label: &str, (below, beside): (&str, &str)) -> Markup {
    let [width, height] = SIZE;
    let [left, top, right, bottom] = MARGIN;
    let drawn: Vec<&Curve> = all.iter().filter(|curve| !curve.places.is_empty()).collect();
    let every = || drawn.iter().flat_map(|curve| &curve.places);
    let reach = every().flat_map(|place| place.quartiles.into_iter().flatten().chain([place.y]));
    let x = Axis::around(every().map(|place| place.x), left, width - right);
    let y = Axis::around(reach, height - bottom, top);
    let at = |place: &Place| [x.at(place.x), y.at(place.y)];
    let ends: Vec<[f64; 2]> = drawn.iter().filter_map(|c| c.places.last().map(at)).collect();
    let widths: Vec<f64> =
        drawn.iter().map(|c| CHARACTER * c.name.chars().count() as f64).collect();
    let labels = places(&ends, &widths, [left + 4.0, top, width - right, height - bottom - 4.0]);
    let path = |curve: &Curve| {
        let each = curve.places.iter().map(|place| at(place).map(|p| format!("{p:.1}")).join(","));
        each.collect::<Vec<_>>().join(" ")
    };
    html! {
        svg role="img" aria-label=(line(label)) viewBox=(format!("0 0 {width} {height}")) {
            (axes(SIZE, MARGIN, (&x, &y), (below, beside)))
            @for ((curve, label), end) in drawn.iter().zip(&labels).zip(&ends) {
                @if label.led { @let [u, v] = label.nearest(*end);
                    path.leader d=(format!("M{:.1} {:.1}L{u:.1} {v:.1}", end[0], end[1])) {} }
                g class=(curve.class) {
                    title { (line(&curve.name)) }
                    polyline points=(path(curve)) {}
                    @for place in &curve.places { @let [cx, cy] = at(place);
                        @if let Some([low, high]) = place.quartiles {
                            path.reach d=(format!("M{cx:.1} {:.1}V{:.1}", y.at(low), y.at(high))) {}
                        }
                        circle cx=(format!("{cx:.1}")) cy=(format!("{cy:.1}")) r="3.5" {}
                    }
                    text x=(format!("{:.1}", label.left)) y=(format!("{:.1}", label.centre + 4.0)) { (line(&curve.name)) }
                }
            }
        }
    }
}

/// Mean ranks on a line, the best first, and how far apart they have to be to differ.
pub(super) fn critical_difference(laws: &[(String, f64)], difference: f64, label: &str) -> Markup {
    let (row, left, width) = (22.0, 250.0, 640.0);
    let most = laws.iter().map(|(_, rank)| *rank).fold(2.0, f64::max).ceil();
    let at = |rank: f64| left + (rank - 1.0) / (most - 1.0) * width;
    let height = 60.0 + row * laws.len() as f64;
    let best = laws.first().map_or(1.0, |(_, rank)| *rank);
    html! {
        svg role="img" aria-label=(line(label)) viewBox=(format!("0 0 960 {height}")) {
            @for rank in (1..=100_u32).map(f64::from).take_while(|rank| *rank <= most) {
                path.grid d=(format!("M{:.1} 30V{}", at(rank), height - 10.0)) {}
                text.tick.below x=(format!("{:.1}", at(rank))) y="22" { (rank) }
            }
            rect.alike x=(format!("{:.1}", at(best))) y="30" width=(format!("{:.1}", (at(best + difference).min(left + width + 40.0) - at(best)))) height=(height - 40.0) {}
            @for (i, (name, rank)) in laws.iter().enumerate() {
                @let y = 46.0 + row * i as f64;
                g class=(if name.starts_with("proposed") { "ours" } else { "others" }) {
                    text.beside x=(left - 12.0) y=(y + 4.0) { (line(name)) }
                    circle cx=(format!("{:.1}", at(*rank))) cy=(y) r="4.5" { title { (line(name)) ": " (format!("{rank:.2}")) } }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Curve, Place, critical_difference, curves};

    /// A page is HTML: a mark that nobody closes swallows those after it.
    #[test]
    fn every_mark_is_closed() {
        let place = |x: f64| Place { x, y: 2.0 * x, quartiles: Some([x, 3.0 * x]) };
        let curve = |name: &str| Curve {
            name: name.to_owned(),
            class: "k0",
            places: vec![place(1.0), place(2.0)],
        };
        let all = [curve("a"), curve("b"), Curve { places: Vec::new(), ..curve("c") }];
        let one = curves(&all, "label", ("x", "y")).into_string();
        let laws = [("a".to_owned(), 1.2), ("proposed-1".to_owned(), 2.6)];
        let other = critical_difference(&laws, 0.7, "label").into_string();
        for picture in [&one, &other] {
            for tag in ["svg", "g", "path", "text", "polyline", "circle", "rect"] {
                let opened = picture.matches(&format!("<{tag} ")).count();
                assert_eq!(
                    opened,
                    picture.matches(&format!("</{tag}>")).count(),
                    "{tag}: {picture}"
                );
            }
        }
        assert_eq!(one.matches("<polyline ").count(), 2);
        assert_eq!(other.matches("<circle ").count(), 2);
    }
}
