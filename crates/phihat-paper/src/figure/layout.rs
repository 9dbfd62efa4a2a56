//! Layout of the parts of a figure.

use phihat_report::kit::sheet::{HEADER, WIDTH};
use phihat_report::kit::text::{line, short};

use super::canvas::{CHARACTER, GAP, LINE, TITLE_CHARACTER};
use super::key::{self, Entry};
use super::plane;
use crate::record as data;

/// Positions and sizes of the parts, from the figure's data alone.
pub(super) struct Layout {
    pub(super) title: Vec<String>,
    /// The key of all panels, where they share it.
    pub(super) key: Vec<Vec<Entry>>,
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) width: u32,
    /// Above the axes of every panel.
    pub(super) head: u32,
    /// Axes with all that is around them.
    pub(super) axes: u32,
}

impl Layout {
    pub(super) fn new(figure: &data::Figure, panels: &[data::Panel]) -> Self {
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

    pub(super) fn header(&self) -> u32 {
        let lines = u32::try_from(self.title.len().saturating_sub(1)).unwrap_or(0);
        let key = u32::try_from(self.key.len()).unwrap_or(0);
        HEADER + lines * (LINE + 10) + key * LINE
    }

    pub(super) fn height(&self) -> u32 {
        self.header() + u32::try_from(self.rows).unwrap_or(1) * (self.head + self.axes)
    }
}

/// Text in lines of about `limit` characters.
pub(super) fn wrapped(text: &str, limit: u32) -> Vec<String> {
    let limit = usize::try_from(limit).unwrap_or(80);
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
