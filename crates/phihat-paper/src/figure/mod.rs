//! Figures of the reproduction: any panels of curves or maps, readable without colour.

use crate::record as data;
use plotters::prelude::*;

use canvas::{CHARACTER, FigureError};
use layout::{Layout, wrapped};
use phihat_report::kit::sheet::{Area, Figure, TEXT, TITLE, WIDTH, accessible};
use phihat_report::kit::text::short;

mod canvas;
mod key;
mod layout;
mod lines;
mod map;
mod plane;
mod scale;
mod stroke;

/// Every figure of a reproduction, in the order of the page.
pub fn reproduction_figures(reproduction: &data::Reproduction) -> Vec<Figure> {
    let sections = reproduction.sections.iter();
    sections.flat_map(|section| &section.figures).map(draw).collect()
}

/// Panels of a figure at most; what is more is not drawn.
const PANELS_MAX: usize = 24;

/// One figure as SVG.
pub(crate) fn draw(figure: &data::Figure) -> Figure {
    let panels = &figure.panels[..figure.panels.len().min(PANELS_MAX)];
    let layout = Layout::new(figure, panels);
    let size = (WIDTH, layout.height());
    let mut svg = String::new();
    let drawn = {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        paint(&layout, panels, &root).and_then(|()| Ok(root.present()?))
    };
    let title = escaped(&short(&figure.title, 400));
    let svg = match drawn {
        Ok(()) => map::hatched(&lines::dashed(&accessible(&svg, &title, size)), &figure.id),
        Err(_) => format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} 60"><text x="10" y="40" font-size="24">{title}: could not be drawn</text></svg>"#
        ),
    };
    Figure { name: figure.id.clone(), title: figure.title.clone(), svg }
}

fn paint(layout: &Layout, panels: &[data::Panel], root: &Area<'_>) -> Result<(), FigureError> {
    root.fill(&WHITE)?;
    let (header, body) = root.split_vertically(layout.header());
    let mut y = 20;
    for line in &layout.title {
        let text = Text::new(line.clone(), (32, y), ("sans-serif", TITLE).into_font());
        header.draw(&text)?;
        y += 78;
    }
    key::draw(&layout.key, &header, (40, y))?;
    for (panel, area) in panels.iter().zip(body.split_evenly((layout.rows, layout.columns))) {
        let (head, axes) = area.split_vertically(layout.head);
        let mut y = 20;
        for line in wrapped(&panel.title, (layout.width - 100) / CHARACTER) {
            let font = ("sans-serif", TEXT).into_font();
            head.draw(&Text::new(line, (60, y), font))?;
            y += 68;
        }
        if layout.key.is_empty() {
            let rows = key::rows(key::entries(panel), layout.width - 120);
            key::draw(&rows, &head, (60, y))?;
            y += 68 * i32::try_from(rows.len()).unwrap_or(0);
        }
        for words in plane::words(panel) {
            let font = ("sans-serif", TEXT).into_font();
            let words = short(&words, (layout.width as usize - 100) / CHARACTER as usize);
            head.draw(&Text::new(words, (60, y), font))?;
            y += 68;
        }
        plane::draw(panel, &axes)?;
    }
    Ok(())
}

/// Text inside an attribute.
fn escaped(text: &str) -> String {
    maud::html! { (text) }.into_string()
}
