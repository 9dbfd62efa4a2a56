//! Places for the labels of a scatter plot: beside their marks, none on a mark or another label.

use core::f64::consts::TAU;

/// Height of a label.
pub(crate) const HIGH: f64 = 14.0;
/// Half a mark, with some room.
const MARK: f64 = 8.0;
/// Distances that are tried, near ones first, and directions at each.
const DISTANCES: [f64; 14] =
    [10.0, 16.0, 24.0, 34.0, 46.0, 60.0, 76.0, 94.0, 114.0, 136.0, 160.0, 190.0, 230.0, 280.0];
const DIRECTIONS: usize = 16;
/// Distance from which on a line leads from mark to label.
const LED: f64 = 12.0;
/// Marks nearer than this make a crowd.
const NEAR: f64 = 70.0;

/// Place of a label: left edge, centre, width; `led` is true if a line has to lead to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Place {
    pub left: f64,
    pub centre: f64,
    pub width: f64,
    pub led: bool,
}

impl Place {
    /// `[left, top, right, bottom]`
    fn sides(&self) -> [f64; 4] {
        [self.left, self.centre - HIGH / 2.0, self.left + self.width, self.centre + HIGH / 2.0]
    }

    /// The place of the label's edge that is nearest to its mark.
    pub(crate) fn nearest(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [left, top, right, bottom] = self.sides();
        [x.clamp(left, right), y.clamp(top, bottom)]
    }
}

/// A place for the label of every mark, inside `frame`: `[left, top, right, bottom]`.
///
/// Those in the thickest crowd choose first. A label for which there is no free place has its nearest one.
pub(crate) fn places(marks: &[[f64; 2]], widths: &[f64], frame: [f64; 4]) -> Vec<Place> {
    let crowd = |&k: &usize| {
        let near = |other: &&[f64; 2]| distance(marks[k], **other) < NEAR;
        core::cmp::Reverse(marks.iter().filter(near).count())
    };
    let mut order: Vec<usize> = (0..marks.len()).collect();
    order.sort_by_key(crowd);
    let around = |[x, y]: [f64; 2]| [x - MARK, y - MARK, x + MARK, y + MARK];
    let mut taken: Vec<[f64; 4]> = marks.iter().map(|mark| around(*mark)).collect();
    let mut places: Vec<Option<Place>> = vec![None; marks.len()];
    for k in order {
        let free = |place: &Place| {
            let sides = place.sides();
            inside(sides, frame) && taken.iter().all(|other| !overlap(sides, *other))
        };
        let place = candidates(marks[k], widths[k]).find(free);
        let place = place.or_else(|| candidates(marks[k], widths[k]).next());
        taken.extend(place.map(|place| place.sides()));
        places[k] = place;
    }
    places.into_iter().flatten().collect()
}

/// Places around a mark, near ones first; to the right and to the left before above and below.
fn candidates([x, y]: [f64; 2], width: f64) -> impl Iterator<Item = Place> {
    let around = move |distance: f64| {
        (0..DIRECTIONS).map(move |k| {
            // 0, 1/2, then alternating away from the horizontal.
            let turn = (k / 2 + k % 2 * (DIRECTIONS / 2)) as f64 / DIRECTIONS as f64;
            let (sine, cosine) = (TAU * turn).sin_cos();
            let left =
                if cosine >= 0.0 { x + distance * cosine } else { x + distance * cosine - width };
            Place { left, centre: y + distance * sine, width, led: distance > LED }
        })
    };
    DISTANCES.into_iter().flat_map(around)
}

fn distance([x, y]: [f64; 2], [u, v]: [f64; 2]) -> f64 {
    (x - u).hypot(y - v)
}

fn inside(sides: [f64; 4], frame: [f64; 4]) -> bool {
    sides[0] >= frame[0] && sides[1] >= frame[1] && sides[2] <= frame[2] && sides[3] <= frame[3]
}

fn overlap(a: [f64; 4], b: [f64; 4]) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}

#[cfg(test)]
mod tests {
    use super::{inside, overlap, places};

    #[test]
    fn labels_of_a_crowd_lie_on_nothing_and_inside_the_frame() {
        // 36 marks, most of them within a tenth of the figure.
        let mark = |k: u32| {
            let (u, v) = (f64::from(k * 37 % 36) / 36.0, f64::from(k * 23 % 36) / 36.0);
            if k < 28 {
                [300.0 + 90.0 * u, 250.0 + 80.0 * v]
            } else {
                [80.0 + 700.0 * u, 30.0 + 480.0 * v]
            }
        };
        let marks: Vec<_> = (0..36).map(mark).collect();
        let widths: Vec<_> = (0..36).map(|k| 30.0 + f64::from(k * 29 % 110)).collect();
        let frame = [70.0, 16.0, 930.0, 580.0];
        let all = places(&marks, &widths, frame);
        assert_eq!(all.len(), 36);
        for (i, place) in all.iter().enumerate() {
            assert!(inside(place.sides(), frame), "{place:?}");
            for other in &all[..i] {
                assert!(!overlap(place.sides(), other.sides()), "{place:?} {other:?}");
            }
            for [x, y] in &marks {
                assert!(!overlap(place.sides(), [x - 1.0, y - 1.0, x + 1.0, y + 1.0]), "{place:?}");
            }
        }
        // Alone, a label is to the right of its mark.
        let alone = places(&[[200.0, 200.0]], &[50.0], frame)[0];
        assert_eq!((alone.centre, alone.led), (200.0, false));
        assert!((208.0..=212.0).contains(&alone.left));
    }
}
