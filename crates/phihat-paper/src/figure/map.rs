//! Maps of classes; each class has its colour, its hatching and its letter.

use std::fmt::Write;

use crate::record::Content;
use plotters::prelude::*;

use super::canvas::{FigureError, Plane};
use super::scale::Scale;
use phihat_report::kit::sheet::{Area, TEXT};

/// Classes that can be told apart.
pub(super) const CLASSES_MAX: usize = 6;

/// From light to dark, so that they differ in grey too: colour, and the strokes of a tile of 40 px.
const INKS: [(RGBColor, &str); CLASSES_MAX] = [
    (RGBColor(242, 242, 241), ""),
    (RGBColor(246, 213, 165), "M-10,10 L10,-10 M0,40 L40,0 M30,50 L50,30"),
    (RGBColor(150, 201, 236), "M-10,30 L10,50 M0,0 L40,40 M30,-10 L50,10"),
    (RGBColor(96, 180, 150), "M0,20 L40,20"),
    (RGBColor(196, 130, 168), "M20,0 L20,40"),
    (RGBColor(120, 120, 121), "M0,20 L40,20 M20,0 L20,40"),
];

/// Side of a letter's box \[px\].
const LETTER: i32 = 72;

pub(super) fn ink(class: usize) -> RGBColor {
    INKS[class % CLASSES_MAX].0
}

/// A class' letter on a white box around a place.
pub(super) fn letter(class: usize, area: &Area<'_>, (x, y): (i32, i32)) -> Result<(), FigureError> {
    let corners = [(x - 24, y - 24), (x + 24, y + 24)];
    area.draw(&Rectangle::new(corners, WHITE.filled()))?;
    Ok(area.draw(&sign(class, (x, y)))?)
}

fn sign(class: usize, (x, y): (i32, i32)) -> Text<'static, (i32, i32), &'static str> {
    let name = ["A", "B", "C", "D", "E", "F"][class % CLASSES_MAX];
    Text::new(name, (x - 15, y - 18), ("sans-serif", TEXT).into_font())
}

/// Borders of the cells around some places: half-way on the scale of the axis, as values.
pub(super) fn edges(places: &[f64], log: bool) -> Vec<f64> {
    let to = |v: f64| if log { v.log10() } else { v };
    let back = |v: f64| if log { 10.0_f64.powf(v) } else { v };
    let at: Vec<f64> = places.iter().map(|place| to(*place)).collect();
    let [first, .., last] = at[..] else {
        return at.iter().flat_map(|v| [v - 0.5, v + 0.5]).map(back).collect();
    };
    let half = |a: f64, b: f64| 0.5 * (b - a);
    let (low, high) = (first - half(at[0], at[1]), last + half(at[at.len() - 2], last));
    let middles = at.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
    [low].into_iter().chain(middles).chain([high]).map(back).collect()
}

/// Cells of one class: columns and rows, the last ones not included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Block {
    class: usize,
    columns: (usize, usize),
    rows: (usize, usize),
}

pub(super) fn draw(
    content: &Content,
    plane: &mut Plane<'_, '_>,
    (x, y): (&Scale, &Scale),
) -> Result<(), FigureError> {
    let Content::Map { x: places_x, y: places_y, cells, classes } = content else { return Ok(()) };
    let cell = |row: usize, column: usize| {
        let class = cells.get(row).and_then(|row| row.get(column)).map(|c| usize::from(*c));
        class.filter(|class| *class < classes.len().min(CLASSES_MAX))
    };
    let shape = (places_y.len(), places_x.len());
    let at = |scale: &Scale, edges: Vec<f64>| -> Vec<f64> {
        edges.iter().map(|edge| scale.held(scale.at(*edge))).collect()
    };
    let (columns, rows) = (at(x, edges(places_x, x.is_log())), at(y, edges(places_y, y.is_log())));
    if columns.iter().chain(&rows).any(|edge| !edge.is_finite()) {
        return Err(FigureError::OffAxis);
    }
    let corners = |b: &Block| {
        [(columns[b.columns.0], rows[b.rows.0]), (columns[b.columns.1], rows[b.rows.1])]
    };
    let blocks = blocks(shape, &cell);
    plane.draw_series(blocks.iter().map(|b| Rectangle::new(corners(b), ink(b.class).filled())))?;
    for class in 0..classes.len().min(CLASSES_MAX) {
        let Some(square) = largest(shape, &|row, column| cell(row, column) == Some(class)) else {
            continue;
        };
        let [low, high] = corners(&Block { class, ..square }).map(|at| plane.backend_coord(&at));
        if (high.0 - low.0).min(low.1 - high.1) >= LETTER {
            let origin = plane.plotting_area().get_base_pixel();
            let middle = (low.0.midpoint(high.0), low.1.midpoint(high.1));
            let area = plane.plotting_area().strip_coord_spec();
            letter(class, &area, (middle.0 - origin.0, middle.1 - origin.1))?;
        }
    }
    Ok(())
}

/// Few rectangles: runs of a row, joined downwards while they repeat.
fn blocks(shape: (usize, usize), cell: &dyn Fn(usize, usize) -> Option<usize>) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    for row in 0..shape.0 {
        let mut column = 0;
        while column < shape.1 {
            let class = cell(row, column);
            let end = (column..shape.1).find(|c| cell(row, *c) != class).unwrap_or(shape.1);
            if let Some(class) = class {
                let columns = (column, end);
                let above =
                    |b: &&mut Block| b.rows.1 == row && b.columns == columns && b.class == class;
                match blocks.iter_mut().rev().find(above) {
                    Some(block) => block.rows.1 = row + 1,
                    None => blocks.push(Block { class, columns, rows: (row, row + 1) }),
                }
            }
            column = end;
        }
    }
    blocks
}

/// The largest square of cells that belong: the letter's place.
fn largest(shape: (usize, usize), belongs: &dyn Fn(usize, usize) -> bool) -> Option<Block> {
    let mut above = vec![0_usize; shape.1 + 1];
    let mut best = (0, 0, 0);
    for row in 0..shape.0 {
        let mut here = vec![0_usize; shape.1 + 1];
        for column in 0..shape.1 {
            if belongs(row, column) {
                let side = 1 + above[column].min(above[column + 1]).min(here[column]);
                here[column + 1] = side;
                best = best.max((side, row + 1, column + 1));
            }
        }
        above = here;
    }
    let (side, row, column) = best;
    (side > 0).then(|| Block {
        class: 0,
        columns: (column - side, column),
        rows: (row - side, row),
    })
}

/// Gives every class its hatching, by patterns that bear the figure's name; no text of a user can hold
/// the quotes looked for here.
pub(super) fn hatched(svg: &str, figure: &str) -> String {
    let name: String =
        figure.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
    let (mut defs, mut svg) = (String::new(), svg.to_owned());
    for (class, (RGBColor(r, g, b), strokes)) in INKS.iter().enumerate() {
        let fill = format!("#{r:02X}{g:02X}{b:02X}");
        let plain = format!(r#"fill="{fill}" stroke="none""#);
        if !svg.contains(&plain) {
            continue;
        }
        let id = format!("hatch-{name}-{class}");
        let hatched = format!(r#"fill="url(#{id})" stroke="none" shape-rendering="crispEdges""#);
        svg = svg.replace(&plain, &hatched);
        // Writing to a string cannot fail.
        let _ = write!(
            defs,
            r##"<pattern id="{id}" width="40" height="40" patternUnits="userSpaceOnUse"><rect width="40" height="40" fill="{fill}"/><path d="{strokes}" stroke="#404040" stroke-width="3"/></pattern>"##
        );
    }
    match svg.find('>').filter(|_| !defs.is_empty()) {
        Some(end) => format!("{}<defs>{defs}</defs>{}", &svg[..=end], &svg[end + 1..]),
        None => svg,
    }
}

#[cfg(test)]
mod tests {
    use super::{Block, blocks, edges, largest};
    use proptest::prelude::*;

    proptest! {
        /// Oracle: every cell lies in exactly one block of its class.
        #[test]
        fn blocks_cover_every_cell_once(cells in prop::collection::vec(prop::collection::vec(0_usize..3, 7), 1..9)) {
            let blocks = blocks((cells.len(), 7), &|row, column| Some(cells[row][column]));
            for (row, column) in (0..cells.len()).flat_map(|row| (0..7).map(move |c| (row, c))) {
                let over = |b: &&Block| {
                    (b.rows.0..b.rows.1).contains(&row) && (b.columns.0..b.columns.1).contains(&column)
                };
                let classes: Vec<_> = blocks.iter().filter(over).map(|b| b.class).collect();
                prop_assert_eq!(classes, vec![cells[row][column]]);
            }
        }
    }

    #[test]
    fn a_letter_stands_in_the_largest_square() {
        let cells = ["#..#.", "..##.", ".###.", "..##."];
        let belongs = |row: usize, column: usize| cells[row].as_bytes()[column] == b'#';
        let found = largest((4, 5), &belongs).map(|b| (b.rows, b.columns));
        assert_eq!(found, Some(((2, 4), (2, 4))));
        assert_eq!(largest((4, 5), &|_, _| false), None);
    }

    #[test]
    fn cells_end_half_way_as_the_axis_counts() {
        assert_eq!(edges(&[1.0, 2.0, 4.0], false), [0.5, 1.5, 3.0, 5.0]);
        let log = edges(&[1.0, 100.0], true);
        let right = [0.1, 10.0, 1000.0];
        assert!(log.iter().zip(right).all(|(a, b)| (a / b - 1.0_f64).abs() < 1e-12), "{log:?}");
        assert_eq!(edges(&[3.0], false), [2.5, 3.5]);
        assert!(edges(&[], false).is_empty());
    }
}
