//! Key of a figure: the meaning of its marks.

use crate::record::{Content, Panel};
use plotters::prelude::*;

use super::canvas::{CHARACTER, FigureError};
use super::{lines, map};
use phihat_report::kit::sheet::{Area, TEXT};
use phihat_report::kit::text::short;

/// Width of a mark with its gap, and the gap to the next entry \[px\].
const MARK: u32 = 170;
const GAP: u32 = 60;
/// Characters of a label at most.
const LABEL_MAX: usize = 84;

/// A mark and what it stands for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Entry {
    mark: Mark,
    label: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mark {
    Line(usize),
    Points(usize),
    Bound(usize),
    Class(usize),
}

/// The entries of a panel; none where a single curve needs no name.
pub(super) fn entries(panel: &Panel) -> Vec<Entry> {
    let entry = |mark: Mark, label: &str| Entry { mark, label: short(label, LABEL_MAX) };
    match &panel.content {
        Content::Lines { series, bounds } => {
            let curves = series.iter().take(lines::SERIES_MAX).enumerate().map(|(index, curve)| {
                let mark = if curve.marks { Mark::Points(index) } else { Mark::Line(index) };
                entry(mark, &curve.label)
            });
            let bounds =
                bounds.iter().enumerate().map(|(i, bound)| entry(Mark::Bound(i), &bound.label));
            curves.chain(bounds).filter(|entry| !entry.label.is_empty()).collect()
        }
        Content::Map { classes, .. } => {
            let named = classes.iter().take(map::CLASSES_MAX).enumerate();
            named.map(|(i, class)| entry(Mark::Class(i), class)).collect()
        }
    }
}

/// The entries of all panels, if they are the same ones.
pub(super) fn shared(panels: &[Panel]) -> Option<Vec<Entry>> {
    let first = panels.first().map(entries)?;
    panels.iter().all(|panel| entries(panel) == first).then_some(first)
}

/// Entries in rows of a width \[px\].
pub(super) fn rows(entries: Vec<Entry>, width: u32) -> Vec<Vec<Entry>> {
    let mut rows: Vec<Vec<Entry>> = Vec::new();
    let mut used = 0;
    for mut entry in entries {
        let most = usize::try_from(width.saturating_sub(MARK) / CHARACTER).unwrap_or(1);
        entry.label = short(&entry.label, most);
        let wide = entry.width();
        match rows.last_mut() {
            Some(row) if used + GAP + wide <= width => {
                used += GAP + wide;
                row.push(entry);
            }
            _ => {
                used = wide;
                rows.push(vec![entry]);
            }
        }
    }
    rows
}

impl Entry {
    fn width(&self) -> u32 {
        MARK + CHARACTER * u32::try_from(self.label.chars().count()).unwrap_or(0)
    }
}

/// Draws rows from a place on.
pub(super) fn draw(
    rows: &[Vec<Entry>],
    area: &Area<'_>,
    (left, top): (i32, i32),
) -> Result<(), FigureError> {
    for (row, y) in rows.iter().zip((top..).step_by(68)) {
        let mut x = left;
        for entry in row {
            mark(entry.mark, area, (x, y + 24))?;
            let text = (x + 150, y + 4);
            let font = ("sans-serif", TEXT).into_font();
            area.draw(&Text::new(entry.label.clone(), text, font))?;
            x += i32::try_from(entry.width() + GAP).unwrap_or(0);
        }
    }
    Ok(())
}

fn mark(mark: Mark, area: &Area<'_>, (x, y): (i32, i32)) -> Result<(), FigureError> {
    let across = |ink: ShapeStyle| PathElement::new([(x, y), (x + 126, y)], ink);
    let drawn = match mark {
        Mark::Line(index) => area.draw(&across(lines::curve_ink(index))),
        Mark::Bound(index) => area.draw(&across(lines::bound_ink(index))),
        Mark::Points(index) => area.draw(&(EmptyElement::at((x + 63, y)) + lines::shape(index))),
        Mark::Class(index) => {
            let corners = [(x + 10, y - 26), (x + 126, y + 26)];
            area.draw(&Rectangle::new(corners, map::ink(index).filled()))?;
            area.draw(&Rectangle::new(corners, BLACK.stroke_width(2)))?;
            return map::letter(index, area, (x + 68, y));
        }
    };
    Ok(drawn?)
}
