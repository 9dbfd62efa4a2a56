//! Tables that fit the terminal.

use std::fmt;
use std::ops::{Deref, DerefMut};

use comfy_table::presets::UTF8_BORDERS_ONLY;
use comfy_table::{Cell, CellAlignment, ContentArrangement, Row, Table};

use crate::terminal;

/// A table that is no wider than the terminal: words are wrapped, and a table of figures that is too wide
/// goes on below, with its first column again.
#[derive(Debug)]
pub(crate) struct Fitted {
    table: Table,
    /// True if the columns after the first are figures, which are never wrapped.
    figures: bool,
}

impl Deref for Fitted {
    type Target = Table;

    fn deref(&self) -> &Table {
        &self.table
    }
}

impl DerefMut for Fitted {
    fn deref_mut(&mut self) -> &mut Table {
        &mut self.table
    }
}

impl Fitted {
    pub(crate) fn new(headers: impl Into<Row>) -> Self {
        let mut table = Table::new();
        table.load_style(UTF8_BORDERS_ONLY);
        table.set_header(headers);
        Self { table, figures: false }
    }

    /// Figures to the right, names to the left, one space around.
    pub(crate) fn align(&mut self) {
        self.figures = true;
        for column in self.table.column_iter_mut() {
            column.set_padding((0, 1));
        }
        for column in self.table.column_iter_mut().skip(1) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }

    /// A table of words within the terminal, or within so many columns where there is none.
    pub(crate) fn wrapped(&self, without: u16) -> String {
        wrapped(self.table.clone(), terminal::width().unwrap_or(without))
    }

    /// A table of words and figures: wrapped where there is room for so many columns, else with its figures below.
    pub(crate) fn wrapped_or_below(mut self, room: u16) -> String {
        self.figures = true;
        match terminal::width().filter(|width| *width < room) {
            Some(width) => self.within(width),
            None => self.wrapped(room),
        }
    }

    /// The table within so many columns of the terminal.
    pub(crate) fn within(&self, width: u16) -> String {
        if natural(&self.table) <= usize::from(width) {
            return self.table.to_string();
        }
        if !self.figures {
            return wrapped(self.table.clone(), width);
        }
        let parts = self.groups(width).into_iter().map(|columns| {
            let mut part = Self::new(cells(self.table.header(), &columns));
            self.table.row_iter().for_each(|row| {
                part.table.add_row(cells(Some(row), &columns));
            });
            part.align();
            wrapped(part.table, width)
        });
        parts.collect::<Vec<_>>().join("\n")
    }

    /// The first column and as many others as fit, again and again.
    fn groups(&self, width: u16) -> Vec<Vec<usize>> {
        let widths = outer_widths(&self.table);
        let name = widths.first().copied().unwrap_or_default();
        let mut groups: Vec<Vec<usize>> = Vec::new();
        let mut room = 0;
        for (place, own) in widths.iter().enumerate().skip(1) {
            if let Some(group) = groups.last_mut().filter(|_| *own <= room) {
                group.push(place);
                room -= own;
            } else {
                groups.push(vec![0, place]);
                room = usize::from(width).saturating_sub(FRAME + name + own);
            }
        }
        groups
    }
}

impl fmt::Display for Fitted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match terminal::width() {
            Some(width) => f.write_str(&self.within(width)),
            None => self.table.fmt(f),
        }
    }
}

/// The lines at both sides of a table.
const FRAME: usize = 2;

/// Every column with what is around its content.
fn outer_widths(table: &Table) -> Vec<usize> {
    let around = table.column_iter().map(|column| usize::from(column.padding_width()));
    let widths = table.column_max_content_widths();
    // One column of the terminal between two of the table.
    widths.into_iter().zip(around).map(|(own, around)| usize::from(own) + around + 1).collect()
}

fn natural(table: &Table) -> usize {
    (FRAME + outer_widths(table).iter().sum::<usize>()).saturating_sub(1)
}

fn wrapped(mut table: Table, width: u16) -> String {
    table.set_content_arrangement(ContentArrangement::Dynamic);
    table.set_width(width);
    table.to_string()
}

fn cells(row: Option<&Row>, columns: &[usize]) -> Row {
    let all: Vec<Cell> = row.into_iter().flat_map(Row::cell_iter).cloned().collect();
    columns.iter().filter_map(|place| all.get(*place).cloned()).collect::<Vec<_>>().into()
}
