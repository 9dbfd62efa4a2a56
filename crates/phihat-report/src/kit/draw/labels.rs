//! Places for labels: next to their marks, none on a mark or another label.

use core::f64::consts::TAU;

use super::look::{FigureSize, Rect};

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

/// Place of a label: left edge, centre, width, height; `led` is true if a line has to lead to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Label {
    pub left: f64,
    pub centre: f64,
    pub led: bool,
    size: [f64; 2],
}

impl Label {
    fn sides(&self) -> Rect {
        let [width, height] = self.size;
        let top = self.centre - 0.5 * height;
        [self.left, top, self.left + width, top + height]
    }

    /// The place of the label's edge that is nearest to its mark.
    pub(super) fn nearest(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [left, top, right, bottom] = self.sides();
        [x.clamp(left, right), y.clamp(top, bottom)]
    }
}

/// A place for the label of every mark, inside a frame and on none of the areas that are taken; one without text has
/// none that matters.
///
/// Those in the thickest crowd choose first. A label for which there is no free place has its nearest one.
pub(super) fn places(
    marks: &[[f64; 2]],
    texts: &[&str],
    (frame, mut taken): (Rect, Vec<Rect>),
    look: &FigureSize,
) -> Vec<Label> {
    let crowd = |&k: &usize| {
        let near = |other: &&[f64; 2]| distance(marks[k], **other) < NEAR;
        core::cmp::Reverse(marks.iter().filter(near).count())
    };
    let mut order: Vec<usize> = (0..marks.len()).collect();
    order.sort_by_key(crowd);
    taken.extend(marks.iter().map(|[x, y]| [x - MARK, y - MARK, x + MARK, y + MARK]));
    let mut labels: Vec<Label> =
        marks.iter().map(|mark| label_at(*mark, 0.0, 0.0, [0.0; 2])).collect();
    for k in order.into_iter().filter(|k| !texts[*k].is_empty()) {
        // A label's own width is a little less than what text may take.
        let size = [0.9 * look.wide(texts[k].chars().count()), 1.15 * look.text];
        let free = |label: &Label| {
            let sides = label.sides();
            inside(sides, frame) && taken.iter().all(|other| !overlap(sides, *other))
        };
        let nearest = label_at(marks[k], DISTANCES[0], 0.0, size);
        labels[k] = candidates(marks[k], size).find(free).unwrap_or(nearest);
        taken.push(labels[k].sides());
    }
    labels
}

/// Places around a mark, near ones first; to the right and to the left before above and below.
fn candidates(mark: [f64; 2], size: [f64; 2]) -> impl Iterator<Item = Label> {
    let around = move |distance: f64| {
        (0..DIRECTIONS).map(move |k| {
            // 0, 1/2, then alternating away from the horizontal.
            let turn = (k / 2 + k % 2 * (DIRECTIONS / 2)) as f64 / DIRECTIONS as f64;
            label_at(mark, distance, turn, size)
        })
    };
    DISTANCES.into_iter().flat_map(around)
}

/// The label at a distance from its mark, in a direction \[turns\].
fn label_at([x, y]: [f64; 2], distance: f64, turn: f64, size: [f64; 2]) -> Label {
    let (sine, cosine) = libm::sincos(TAU * turn);
    let left = if cosine >= 0.0 { 0.0 } else { -size[0] };
    let (left, centre) = (x + distance * cosine + left, y + distance * sine);
    Label { left, centre, led: distance > LED, size }
}

fn distance([x, y]: [f64; 2], [u, v]: [f64; 2]) -> f64 {
    libm::hypot(x - u, y - v)
}

fn inside(sides: [f64; 4], frame: [f64; 4]) -> bool {
    sides[0] >= frame[0] && sides[1] >= frame[1] && sides[2] <= frame[2] && sides[3] <= frame[3]
}

fn overlap(a: [f64; 4], b: [f64; 4]) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}

#[cfg(test)]
mod tests {
    use super::{FigureSize, inside, overlap, places};

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
        let text = |k: usize| &"computed-torque-inside-and-out"[..4 + k * 29 % 16];
        let texts: Vec<_> = (0..36).map(text).collect();
        let frame = [70.0, 16.0, 930.0, 580.0];
        let all = places(&marks, &texts, (frame, Vec::new()), &FigureSize::WIDE);
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
        let one =
            |taken| places(&[[200.0, 200.0]], &["label"], (frame, taken), &FigureSize::WIDE)[0];
        let alone = one(Vec::new());
        assert_eq!((alone.centre, alone.led), (200.0, false));
        assert!((208.0..=212.0).contains(&alone.left));
        // Where a line goes through its mark, it is beside the line.
        let beside = one(vec![[70.0, 199.0, 930.0, 201.0]]);
        assert!(beside.sides()[1] >= 201.0 || beside.sides()[3] <= 199.0, "{beside:?}");
    }
}
