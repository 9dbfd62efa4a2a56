//! Places of the parts of a figure, from its data alone.

use super::key::{self, KeyEntry};
use super::look::{FigureSize, Rect};
use super::panel::{off_axis, ranges};
use super::scale::Scale;
use crate::kit::figure::{Content, Figure, Panel};
use crate::kit::text::{line, short};

/// Ticks of an axis at most.
const TICKS_MAX: usize = 9;

/// Panels of a figure at most; what is more is not drawn.
const PANELS_MAX: usize = 64;

/// A figure laid out.
#[derive(Debug)]
pub(super) struct FigureLayout<'a> {
    pub title: Vec<String>,
    /// The key of all panels, where they share it.
    pub key: Vec<Vec<KeyEntry>>,
    /// Top of that key.
    pub key_top: f64,
    pub panels: Vec<PanelLayout<'a>>,
    pub height: f64,
}

/// A panel laid out.
#[derive(Debug)]
pub(super) struct PanelLayout<'a> {
    pub panel: &'a Panel,
    /// Place of its first line of text.
    pub at: [f64; 2],
    pub title: Vec<String>,
    pub key: Vec<Vec<KeyEntry>>,
    /// Bounds that its axes do not reach, in words.
    pub words: Vec<String>,
    pub x: Scale,
    pub y: Scale,
    /// The area between the axes.
    pub frame: Rect,
}

impl<'a> FigureLayout<'a> {
    pub(super) fn new(figure: &'a Figure, look: &FigureSize) -> Self {
        let panels = &figure.panels[..figure.panels.len().min(PANELS_MAX)];
        let columns: usize = match panels.len() {
            0 | 1 => 1,
            2..=4 => 2,
            5..=18 => 3,
            _ => 4,
        };
        let (cell, line) = (look.width / columns as f64, look.line());
        let shared = key::shared(panels);
        let title = if look.titled {
            wrapped(&figure.title, look.letters((look.width - 40.0) / 1.2))
        } else {
            Vec::new()
        };
        let key_top = if look.titled { 0.6 * line + 1.2 * line * title.len() as f64 } else { 0.0 };
        let own = shared.is_none();
        let key = key::rows(shared.unwrap_or_default(), look.width - 2.0 * look.text, look);
        let mut placed: Vec<_> =
            panels.iter().map(|p| PanelLayout::new(p, cell, own, look)).collect();
        let head = placed.iter().map(PanelLayout::lines).max().unwrap_or(0);
        let head = head as f64 * line + 0.5 * look.text;
        let room = Room::of(panels, columns, look);
        let axes = room.height;
        let gap = if key.is_empty() { 0.0 } else { 0.3 * line };
        let header = key_top + key.len() as f64 * line + gap;
        for (place, panel) in placed.iter_mut().enumerate() {
            let (row, column) = (place / columns, place % columns);
            let (left, top) = (cell * column as f64, header + row as f64 * (head + axes));
            panel.place([left, top, left + cell, top + head], &room, look);
        }
        let rows = panels.len().div_ceil(columns);
        Self { title, key, key_top, panels: placed, height: header + rows as f64 * (head + axes) }
    }
}

/// Room of the axes, alike in all panels.
#[derive(Debug)]
struct Room {
    /// From a panel's left and right edge to its axes.
    left: f64,
    right: f64,
    /// Above and below its axes.
    top: f64,
    bottom: f64,
    /// Of the axes with all that is around them.
    height: f64,
}

impl Room {
    fn of(panels: &[Panel], columns: usize, look: &FigureSize) -> Self {
        let map = panels.iter().any(|panel| matches!(panel.content, Content::Map { .. }));
        let (most, plain) = match (columns, map) {
            (1, true) => (560.0, 490.0),
            (1, false) => (560.0, 375.0),
            (2, true) => (420.0, 345.0),
            (2, false) => (420.0, 255.0),
            (3, _) => (270.0, 232.0),
            _ => (220.0, 180.0),
        };
        let plain = look.height.unwrap_or(plain);
        let (top, bottom, right) = (0.4 * look.text, 3.5 * look.text, 1.6 * look.text);
        let labels = panels.iter().map(|panel| {
            let (_, y) = ranges(panel);
            let label = if panel.y.label.is_empty() { 0.0 } else { look.line() };
            let high = plain - top - bottom;
            label + y.placed(&panel.y, (high, 0.0), ticks_up(high, look)).widest(look)
        });
        let left = labels.fold(look.text, f64::max) + look.text;
        let width = look.width / columns as f64 - left - right;
        let square = panels.iter().filter(|panel| panel.equal).map(|panel| {
            let (x, y) = ranges(panel);
            fitted((width, most - top - bottom), x.length() / y.length())[1] + top + bottom
        });
        let height = square.reduce(f64::max).unwrap_or(plain);
        Self { left, right, top, bottom, height }
    }
}

impl<'a> PanelLayout<'a> {
    fn new(panel: &'a Panel, cell: f64, own: bool, look: &FigureSize) -> Self {
        let (x, y) = ranges(panel);
        let letters = look.letters(cell - 2.0 * look.text);
        let entries = if own { key::entries(panel) } else { Vec::new() };
        let words = off_axis(panel, &y).iter().map(|words| short(words, letters)).collect();
        Self {
            title: wrapped(&panel.title, letters),
            key: key::rows(entries, cell - 2.0 * look.text, look),
            words,
            panel,
            at: [0.0; 2],
            x,
            y,
            frame: [0.0; 4],
        }
    }

    /// Lines of text above the axes.
    fn lines(&self) -> usize {
        self.title.len() + self.key.len() + self.words.len()
    }

    /// Gives the axes their place below a head: `[left, top, right, bottom]`.
    fn place(&mut self, [left, top, right, bottom]: Rect, room: &Room, look: &FigureSize) {
        self.at = [left, top];
        let [x0, y0] = [left + room.left, bottom + room.top];
        let free = (right - room.right - x0, room.height - room.top - room.bottom);
        let [width, height] = if self.panel.equal {
            fitted(free, self.x.length() / self.y.length())
        } else {
            [free.0, free.1]
        };
        let x0 = x0 + 0.5 * (free.0 - width);
        self.frame = [x0, y0, x0 + width, y0 + height];
        let [left, top, right, bottom] = self.frame;
        let across = |most: usize| self.x.clone().placed(&self.panel.x, (left, right), most);
        let fits = |x: &Scale| (x.widest(look) + look.text) * x.ticks.len() as f64 <= width;
        self.x = (2..=TICKS_MAX).rev().map(across).find(fits).unwrap_or_else(|| across(2));
        self.y = self.y.clone().placed(&self.panel.y, (bottom, top), ticks_up(height, look));
    }
}

/// Ticks that a height has room for.
fn ticks_up(height: f64, look: &FigureSize) -> usize {
    let size = 1.05 * look.line();
    (2..=TICKS_MAX).take_while(|count| *count as f64 * size <= height).last().unwrap_or(2)
}

/// The largest size of an aspect inside a room.
fn fitted((width, height): (f64, f64), aspect: f64) -> [f64; 2] {
    let aspect = if aspect.is_finite() { aspect.clamp(1e-2, 1e2) } else { 1.0 };
    if height * aspect <= width { [height * aspect, height] } else { [width, width / aspect] }
}

/// Text in lines of about `limit` letters.
fn wrapped(text: &str, limit: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in line(text).split_whitespace() {
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
