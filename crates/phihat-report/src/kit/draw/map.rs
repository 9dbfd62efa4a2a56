//! Maps of classes; each class has its colour, its hatching and its letter.

use maud::{Markup, html};

use super::look::px;
use super::scale::Scale;
use crate::kit::anchor;
use crate::kit::figure::Content;

/// Number of distinct classes.
pub(super) const CLASSES_MAX: usize = 6;

/// From light to dark, so that they differ in grey too: colour, and the strokes of a tile of 16 units.
const INKS: [(&str, &str); CLASSES_MAX] = [
    ("#F2F2F1", ""),
    ("#F6D5A5", "M-4,4 L4,-4 M0,16 L16,0 M12,20 L20,12"),
    ("#96C9EC", "M-4,12 L4,20 M0,0 L16,16 M12,-4 L20,4"),
    ("#60B496", "M0,8 L16,8"),
    ("#C482A8", "M8,0 L8,16"),
    ("#787879", "M0,8 L16,8 M8,0 L8,16"),
];

/// Fill of a class in a figure.
pub(super) fn pattern(figure: &str, class: usize) -> String {
    format!("url(#{}-{class})", anchor("hatch", figure))
}

/// The patterns of a figure's classes.
pub(super) fn patterns(figure: &str, classes: usize) -> Markup {
    html! { @if classes > 0 { defs {
        @for (class, (colour, strokes)) in INKS.iter().enumerate().take(classes) {
            pattern id=(format!("{}-{class}", anchor("hatch", figure))) width="16" height="16"
                patternUnits="userSpaceOnUse" {
                rect width="16" height="16" fill=(colour) {}
                path d=(strokes) stroke="#404040" stroke-width="1.2" {}
            }
        }
    } } }
}

/// A class' letter on a white box around a place.
pub(super) fn letter(class: usize, [x, y]: [f64; 2], text: f64) -> Markup {
    let name = ["A", "B", "C", "D", "E", "F"][class % CLASSES_MAX];
    let half = 0.6 * text;
    html! {
        rect x=(px(x - half)) y=(px(y - half)) width=(px(2.0 * half)) height=(px(2.0 * half)) fill="#fff" {}
        text.letter x=(px(x)) y=(px(y + 0.36 * text)) text-anchor="middle" fill="#1b1f24" { (name) }
    }
}

/// Borders of the cells around some places: half-way on the scale of the axis, as values.
pub(super) fn edges(places: &[f64], log: bool) -> Vec<f64> {
    let to = |v: f64| if log { libm::log10(v) } else { v };
    let back = |v: f64| if log { libm::exp10(v) } else { v };
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

/// The cells of a map, in few rectangles, with a letter in each class' largest square.
pub(super) fn draw(
    content: &Content,
    (x, y): (&Scale, &Scale),
    (figure, text): (&str, f64),
) -> Markup {
    let Content::Map { x: places_x, y: places_y, cells, classes } = content else {
        return html! {};
    };
    let count = classes.len().min(CLASSES_MAX);
    let cell = |row: usize, column: usize| {
        let class = cells.get(row).and_then(|row| row.get(column)).map(|c| usize::from(*c));
        class.filter(|class| *class < count)
    };
    let shape = (places_y.len(), places_x.len());
    let at = |scale: &Scale, places: &[f64]| -> Vec<f64> {
        // Rounded as they are written, so that neighbours meet.
        let at = |edge: &f64| (10.0 * scale.clamped(*edge)).round() / 10.0;
        edges(places, scale.is_log()).iter().map(at).collect()
    };
    let (columns, rows) = (at(x, places_x), at(y, places_y));
    // Left, top, width, height; rows go up.
    let sides = |b: &Block| {
        let (left, right) = (columns[b.columns.0], columns[b.columns.1]);
        let (bottom, top) = (rows[b.rows.0], rows[b.rows.1]);
        [left, top, right - left, bottom - top]
    };
    let blocks = blocks(shape, &cell);
    // The letter of a class stands in its largest block or square, if there is room.
    let side = |b: &Block| {
        let [_, _, width, height] = sides(b);
        width.min(height)
    };
    let of = |class: usize| blocks.iter().copied().filter(move |block| block.class == class);
    let square = |class: usize| largest(shape, class, &cell);
    let letters = (0..count).filter_map(|class| {
        square(class).into_iter().chain(of(class)).max_by(|a, b| side(a).total_cmp(&side(b)))
    });
    let letters = letters.filter(|block| side(block) >= 1.5 * text).map(|block| {
        let [left, top, width, height] = sides(&block);
        letter(block.class, [left + 0.5 * width, top + 0.5 * height], text)
    });
    let base = |class: usize| -> String {
        let path = |block: Block| {
            let [left, top, width, height] = sides(&block).map(px);
            format!("M{left} {top}h{width}v{height}h-{width}z")
        };
        of(class).map(path).collect()
    };
    html! {
        // Below the hatching: between its tiles a renderer may leave seams.
        @for (class, (colour, _)) in INKS.iter().enumerate().take(count) {
            @let path = base(class);
            @if !path.is_empty() { path d=(path) fill=(colour) shape-rendering="crispEdges" {} }
        }
        @for block in &blocks {
            @let [left, top, width, height] = sides(block);
            rect x=(px(left)) y=(px(top)) width=(px(width)) height=(px(height)) fill=(pattern(figure,
                block.class)) shape-rendering="crispEdges" {}
        }
        @for letter in letters { (letter) }
    }
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

/// The largest square of cells of a class.
fn largest(
    shape: (usize, usize),
    class: usize,
    cell: &dyn Fn(usize, usize) -> Option<usize>,
) -> Option<Block> {
    // Side of the largest square that ends at a cell, in the row before and in this one.
    let mut above = vec![0_usize; shape.1 + 1];
    let mut best = (0, 0, 0);
    for row in 0..shape.0 {
        let mut here = vec![0_usize; shape.1 + 1];
        for column in (0..shape.1).filter(|column| cell(row, *column) == Some(class)) {
            let side = 1 + above[column].min(above[column + 1]).min(here[column]);
            here[column + 1] = side;
            best = best.max((side, row + 1, column + 1));
        }
        above = here;
    }
    let (side, row, column) = best;
    let (columns, rows) = ((column.saturating_sub(side), column), (row.saturating_sub(side), row));
    (side > 0).then_some(Block { class, columns, rows })
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

    /// A staircase, whose rows are all of another length: no block of it is as large as a square.
    #[test]
    fn the_largest_square_of_a_staircase_is_found() {
        let cell = |row: usize, column: usize| Some(usize::from(column <= row));
        let square = Block { class: 1, columns: (0, 4), rows: (3, 7) };
        assert_eq!(largest((7, 7), 1, &cell), Some(square));
        assert_eq!(largest((7, 7), 2, &cell), None);
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
