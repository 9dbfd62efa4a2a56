//! The drawer of every figure with axes: a [`Figure`] as SVG.
//!
//! Colours stand in the elements, so that a file is whole, and classes beside them, by which the style sheet of a page
//! (`assets/page.css`) gives the same figure other colours on a dark one.

mod ink;
mod key;
mod labels;
mod layout;
mod look;
mod map;
mod panel;
mod scale;
mod spark;
mod stroke;

use maud::{Markup, html};

use super::figure::{Content, Figure, Panel};
use super::text::{line, short};
use layout::FigureLayout;
use look::{UNITS_PER_CM, px};
use panel::PanelArea;

pub use look::FigureSize;
pub use scale::extent;
pub use spark::sparkline;

/// A figure, drawn.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// File stem: `tracking`, `error`, …
    pub name: String,
    /// Title.
    pub title: String,
    /// The picture as SVG, 16 cm wide.
    pub svg: String,
}

/// Draws a figure for a file or a page.
pub fn draw(figure: &Figure, look: &FigureSize) -> Picture {
    let svg = svg(figure, look).into_string();
    Picture { name: figure.id.clone(), title: figure.title.clone(), svg }
}

/// The SVG of a figure.
pub fn svg(figure: &Figure, look: &FigureSize) -> Markup {
    let layout = FigureLayout::new(figure, look);
    let (width, height) = (look.width, layout.height);
    let classes = figure.panels.iter().map(classes).max().unwrap_or(0);
    let linked = figure.panels.iter().flat_map(|p| &p.markers).any(|marker| marker.link.is_some());
    let role = if linked { "group" } else { "img" };
    let centimetres = |length: f64| format!("{}cm", (1e3 * length / UNITS_PER_CM).round() / 1e3);
    let title = short(&figure.title, 400);
    html! {
        svg.figure xmlns="http://www.w3.org/2000/svg" role=(role) aria-label=(title) width=(centimetres(width))
            height=(centimetres(height))
            viewBox=(format!("0 0 {} {}", px(width), px(height))) font-family="sans-serif" font-size=(look.text)
                fill="#1b1f24" {
            title { (title) }
            desc { (described(figure)) }
            (map::patterns(&figure.id, classes))
            rect.ground width=(px(width)) height=(px(height)) fill="#fff" {}
            @for (text, place) in layout.title.iter().zip(1..) {
                text.title x=(px(look.text)) y=(px(f64::from(place) * 1.2 * look.line())) font-size=(px(1.2 *
                    look.text)) { (text) }
            }
            (key::draw(&layout.key, [look.text, layout.key_top], look, &figure.id))
            @for panel in &layout.panels {
                @let [left, top] = panel.at;
                @let lines = |count: usize| top + look.line() * count as f64;
                @for (text, place) in panel.title.iter().zip(0..) { (head(text, [left, lines(place)], look)) }
                (key::draw(&panel.key, [left + look.text, lines(panel.title.len())], look, &figure.id))
                @for (text, place) in panel.words.iter().zip(panel.title.len() + panel.key.len()..) { (head(text,
                    [left, lines(place)], look)) }
                (PanelArea { panel: panel.panel, x: &panel.x, y: &panel.y, frame: panel.frame, look, figure:
                    &figure.id }.draw())
            }
        }
    }
}

/// A line above a panel.
fn head(text: &str, [left, top]: [f64; 2], look: &FigureSize) -> Markup {
    html! { text x=(px(left + look.text)) y=(px(top + 0.5 * look.line() + 0.36 * look.text)) { (text) } }
}

/// Classes that a panel's map shows.
fn classes(panel: &Panel) -> usize {
    match &panel.content {
        Content::Map { classes, .. } => classes.len().min(map::CLASSES_MAX),
        Content::Lines { .. } => 0,
    }
}

/// Panels in words at most.
const DESCRIBED: usize = 6;

/// A figure in words, for those who do not see it.
fn described(figure: &Figure) -> String {
    let panel = |panel: &Panel| {
        let entries = match &panel.content {
            Content::Lines { series, bounds } => {
                let series = series.iter().map(|curve| &curve.label);
                series.chain(bounds.iter().map(|bound| &bound.label)).collect::<Vec<_>>()
            }
            Content::Map { classes, .. } => classes.iter().collect(),
        };
        let bands = panel.bands.iter().map(|band| &band.label);
        let labels = entries.into_iter().chain(bands).filter(|label| !label.is_empty());
        let labels: Vec<_> = labels.take(8).map(|label| line(label)).collect();
        let title =
            if panel.title.is_empty() { String::new() } else { format!("{}: ", panel.title) };
        let shown =
            if labels.is_empty() { String::new() } else { format!(" ({})", labels.join(", ")) };
        line(&format!("{title}{} against {}{shown}", panel.y.label, panel.x.label))
    };
    let mut words: Vec<_> = figure.panels.iter().take(DESCRIBED).map(panel).collect();
    if figure.panels.len() > DESCRIBED {
        words.push(format!("and {} panels more", figure.panels.len() - DESCRIBED));
    }
    words.join("; ")
}
