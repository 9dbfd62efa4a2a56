//! Places for the labels of a scatter plot: beside their marks, and not on one another.

use super::scatter::{MARGIN, SIZE};

/// A mark, and how long its label is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spot {
    pub x: f64,
    pub y: f64,
    pub letters: usize,
}

/// Where a label begins, on its baseline, and where the line from its mark ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Label {
    pub x: f64,
    pub y: f64,
    pub foot: [f64; 2],
}

/// Width of a letter and height of a line at the figure's size of text.
const LETTER: f64 = 6.7;
const LINE: f64 = 14.0;

/// Half the width of a mark, with a little air.
const MARK: f64 = 8.0;

/// A rectangle: left, top, right, bottom.
type Area = [f64; 4];

/// A place per label: of rings of places around its mark the one that covers least of what is there already.
pub(super) fn placed(spots: &[Spot]) -> Vec<Label> {
    let marks = spots.iter().map(|s| [s.x - MARK, s.y - MARK, s.x + MARK, s.y + MARK]);
    let mut taken: Vec<Area> = marks.collect();
    let mut labels = Vec::with_capacity(spots.len());
    for spot in spots {
        let mut best: Option<(f64, Area)> = None;
        for area in candidates(spot) {
            let cost = cost(area, spot, &taken);
            if best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, area));
            }
        }
        let area = best.map_or([spot.x, spot.y, spot.x, spot.y], |(_, area)| area);
        taken.push(area);
        let [left, top, right, bottom] = area;
        let foot = [spot.x.clamp(left, right), spot.y.clamp(top, bottom)];
        labels.push(Label { x: left, y: bottom - 3.0, foot });
    }
    labels
}

/// Places around a mark, near ones first.
fn candidates(spot: &Spot) -> impl Iterator<Item = Area> {
    let wide = LETTER * spot.letters as f64;
    let (x, y) = (spot.x, spot.y);
    (0..9).flat_map(move |ring| {
        let out = MARK + 1.0 + LINE * f64::from(ring);
        [
            (1.0, 0.0),
            (-1.0, 0.0),
            (0.0, -1.0),
            (0.0, 1.0),
            (1.0, -1.0),
            (1.0, 1.0),
            (-1.0, -1.0),
            (-1.0, 1.0),
        ]
        .map(|(right, down): (f64, f64)| {
            let left = match right {
                r if r > 0.0 => x + out,
                r if r < 0.0 => x - out - wide,
                _ => x - 0.5 * wide,
            };
            let top = y - 0.5 * LINE + down * (out + 0.2 * LINE);
            [left, top, left + wide, top + LINE]
        })
    })
}

/// What a place covers, what of it is outside the axes, and how far it is.
fn cost(area: Area, spot: &Spot, taken: &[Area]) -> f64 {
    let covered: f64 = taken.iter().map(|other| shared(area, *other)).sum();
    let [left, top, right, bottom] = MARGIN;
    let inside = [left, top, SIZE[0] - right, SIZE[1] - bottom];
    let whole = (area[2] - area[0]) * (area[3] - area[1]);
    let far = (0.5 * (area[0] + area[2]) - spot.x).hypot(0.5 * (area[1] + area[3]) - spot.y);
    10.0 * covered + 50.0 * (whole - shared(area, inside)) + far
}

/// The area that two rectangles share.
fn shared(a: Area, b: Area) -> f64 {
    let wide = a[2].min(b[2]) - a[0].max(b[0]);
    let high = a[3].min(b[3]) - a[1].max(b[1]);
    wide.max(0.0) * high.max(0.0)
}

#[cfg(test)]
mod tests {
    use super::{LETTER, LINE, Spot, placed, shared};

    #[test]
    fn labels_of_a_crowd_do_not_touch() {
        let spot = |k: u32| {
            let (row, column) = (f64::from(k / 6), f64::from(k % 6));
            Spot { x: 300.0 + 40.0 * column, y: 150.0 + 22.0 * row, letters: 14 }
        };
        let spots: Vec<_> = (0..30).map(spot).collect();
        let labels = placed(&spots);
        assert_eq!(labels.len(), spots.len());
        let area = |k: usize| {
            let (x, y) = (labels[k].x, labels[k].y + 3.0);
            [x, y - LINE, x + LETTER * 14.0, y]
        };
        let over = |i: usize, k: usize| shared(area(i), area(k)) > 0.1 * LETTER * 14.0 * LINE;
        let touching = (0..30).flat_map(|i| (0..i).map(move |k| (i, k)));
        assert_eq!(touching.filter(|(i, k)| over(*i, *k)).count(), 0);
    }
}
