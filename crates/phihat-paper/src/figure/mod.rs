//! Figures of the reproduction: any panels of curves or maps, readable without colour.

use crate::record as data;
use plotters::prelude::*;

use key::Entry;
use phihat_report::kit::sheet::{Area, Figure, HEADER, TEXT, TITLE, WIDTH, accessible};
use phihat_report::kit::text::short;

mod key;
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

/// Room around a panel's axes \[px\].
const LEFT: u32 = 236;
const RIGHT: u32 = 84;
const BOTTOM: u32 = 136;
const TOP: u32 = 14;
/// Height of a line of text.
const LINE: u32 = 68;
/// Between the panels of a column.
const GAP: u32 = 20;
/// Widths of one character of text and of the title, about.
const CHARACTER: u32 = 27;
const TITLE_CHARACTER: u32 = 33;
/// Panels of a figure at most; what is more is not drawn.
const PANELS_MAX: usize = 24;

/// Where things go, from the figure's data alone.
struct Layout {
    title: Vec<String>,
    /// The key of all panels, where they share it.
    key: Vec<Vec<Entry>>,
    columns: usize,
    rows: usize,
    width: u32,
    /// Above the axes of every panel.
    head: u32,
    /// Axes with all that is around them.
    axes: u32,
}

/// One figure as SVG.
pub(crate) fn draw(figure: &data::Figure) -> Figure {
    let panels = &figure.panels[..figure.panels.len().min(PANELS_MAX)];
    let layout = Layout::new(figure, panels);
    let size = (WIDTH, layout.height());
    let mut svg = String::new();
    let drawn = {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        paint(&layout, panels, &root).and_then(|()| root.present().map_err(told))
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

impl Layout {
    fn new(figure: &data::Figure, panels: &[data::Panel]) -> Self {
        let columns: u32 = match panels.len() {
            0 | 1 => 1,
            2..=4 => 2,
            _ => 3,
        };
        let width = WIDTH / columns;
        let shared = key::shared(panels);
        let own = panels.iter().map(|panel| {
            let caption = wrapped(&panel.title, (width - 100) / CHARACTER).len();
            let key = if shared.is_none() {
                key::rows(key::entries(panel), width - 120)
            } else {
                Vec::new()
            };
            caption + key.len() + plane::words(panel).len()
        });
        let lines = u32::try_from(own.max().unwrap_or(0)).unwrap_or(0);
        let map = panels.iter().any(|panel| matches!(panel.content, data::Content::Map { .. }));
        let (most, plain) = match (columns, map) {
            (1, true) => (1500, 1300),
            (1, false) => (1500, 1000),
            (2, true) => (1120, 920),
            (2, false) => (1120, 680),
            _ => (720, 580),
        };
        let square = panels.iter().filter_map(|panel| plane::height(panel, width, most)).max();
        let axes = square.unwrap_or(plain);
        Self {
            title: wrapped(&figure.title, (WIDTH - 100) / TITLE_CHARACTER),
            key: shared.map_or(Vec::new(), |entries| key::rows(entries, WIDTH - 100)),
            columns: columns as usize,
            rows: panels.len().div_ceil(columns as usize).max(1),
            width,
            head: lines * LINE + GAP,
            axes,
        }
    }

    fn header(&self) -> u32 {
        let lines = u32::try_from(self.title.len().saturating_sub(1)).unwrap_or(0);
        let key = u32::try_from(self.key.len()).unwrap_or(0);
        HEADER + lines * (LINE + 10) + key * LINE
    }

    fn height(&self) -> u32 {
        self.header() + u32::try_from(self.rows).unwrap_or(1) * (self.head + self.axes)
    }
}

fn paint(layout: &Layout, panels: &[data::Panel], root: &Area<'_>) -> Result<(), String> {
    root.fill(&WHITE).map_err(told)?;
    let (header, body) = root.split_vertically(layout.header());
    let mut y = 20;
    for line in &layout.title {
        let text = Text::new(line.clone(), (32, y), ("sans-serif", TITLE).into_font());
        header.draw(&text).map_err(told)?;
        y += 78;
    }
    key::draw(&layout.key, &header, (40, y))?;
    for (panel, area) in panels.iter().zip(body.split_evenly((layout.rows, layout.columns))) {
        let (head, axes) = area.split_vertically(layout.head);
        let mut y = 20;
        for line in wrapped(&panel.title, (layout.width - 100) / CHARACTER) {
            let font = ("sans-serif", TEXT).into_font();
            head.draw(&Text::new(line, (60, y), font)).map_err(told)?;
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
            head.draw(&Text::new(words, (60, y), font)).map_err(told)?;
            y += 68;
        }
        plane::draw(panel, &axes)?;
    }
    Ok(())
}

/// Text in lines of about `limit` characters.
fn wrapped(text: &str, limit: u32) -> Vec<String> {
    let limit = usize::try_from(limit).unwrap_or(80);
    let mut lines: Vec<String> = Vec::new();
    for word in phihat_report::kit::text::line(text).split_whitespace() {
        let word = short(word, limit);
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= limit => {
                line.push(' ');
                line.push_str(&word);
            }
            _ => lines.push(word),
        }
    }
    lines
}

/// Text inside an attribute.
fn escaped(text: &str) -> String {
    maud::html! { (text) }.into_string()
}

/// An error as text: the figure says that it could not be drawn.
fn told(error: impl std::fmt::Display) -> String {
    error.to_string()
}
