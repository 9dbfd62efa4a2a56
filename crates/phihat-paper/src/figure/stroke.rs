//! Curves as a panel can hold them: cut at its edges, without points that nobody could see.

use std::ops::Range;

/// Deviation from the whole curve that is allowed \[px\]; 160 px are a centimetre on paper.
const TOLERANCE_PX: f64 = 0.3;

/// A panel's coordinates, and the pixels that one of each takes.
#[derive(Debug, Clone)]
pub(super) struct Window {
    pub x: Range<f64>,
    pub y: Range<f64>,
    pub pixels: [f64; 2],
}

type Point = (f64, f64);

impl Window {
    /// The pieces of a curve inside the panel; it is cut where it is not finite.
    pub(super) fn strokes(&self, points: impl Iterator<Item = Point>) -> Vec<Vec<Point>> {
        let mut strokes: Vec<Vec<Point>> = Vec::new();
        let mut open = false;
        let mut last: Option<Point> = None;
        for point in points {
            if !(point.0.is_finite() && point.1.is_finite()) {
                (open, last) = (false, None);
                continue;
            }
            let piece = self.inside(last.unwrap_or(point), point);
            last = Some(point);
            let Some((from, to, leaves)) = piece else {
                open = false;
                continue;
            };
            match strokes.last_mut().filter(|_| open) {
                Some(stroke) => stroke.push(to),
                None => strokes.push(if near(from, to) { vec![to] } else { vec![from, to] }),
            }
            open = !leaves;
        }
        strokes.iter().map(|stroke| self.thinned(stroke)).collect()
    }

    /// Returns true if a point lies inside.
    pub(super) fn holds(&self, (x, y): Point) -> bool {
        (self.x.start..=self.x.end).contains(&x) && (self.y.start..=self.y.end).contains(&y)
    }

    /// The part of a segment inside, by Liang and Barsky, and whether it leaves the panel at its end.
    fn inside(&self, a: Point, b: Point) -> Option<(Point, Point, bool)> {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let (mut first, mut last) = (0.0_f64, 1.0_f64);
        for (step, room) in [
            (-dx, a.0 - self.x.start),
            (dx, self.x.end - a.0),
            (-dy, a.1 - self.y.start),
            (dy, self.y.end - a.1),
        ] {
            if step.abs() < f64::MIN_POSITIVE {
                if room < 0.0 {
                    return None;
                }
            } else if step < 0.0 {
                first = first.max(room / step);
            } else {
                last = last.min(room / step);
            }
        }
        let at = |share: f64| (a.0 + share * dx, a.1 + share * dy);
        let end = if last < 1.0 { at(last) } else { b };
        (first <= last).then(|| (at(first), end, last < 1.0))
    }

    /// Ramer, Douglas and Peucker: what is left out lies within [`TOLERANCE_PX`] of what is drawn.
    fn thinned(&self, stroke: &[Point]) -> Vec<Point> {
        let mut keep = vec![false; stroke.len()];
        let Some(end) = stroke.len().checked_sub(1) else { return Vec::new() };
        (keep[0], keep[end]) = (true, true);
        let mut open = vec![(0, end)];
        while let Some((from, to)) = open.pop() {
            let far = |k: &usize| self.distance(stroke[*k], stroke[from], stroke[to]);
            let farthest = (from + 1..to).max_by(|i, k| far(i).total_cmp(&far(k)));
            if let Some(k) = farthest.filter(|k| far(k) > TOLERANCE_PX) {
                keep[k] = true;
                open.extend([(from, k), (k, to)]);
            }
        }
        stroke.iter().zip(keep).filter(|(_, keep)| *keep).map(|(point, _)| *point).collect()
    }

    /// From a point to a segment \[px\].
    fn distance(&self, point: Point, a: Point, b: Point) -> f64 {
        let pixels = |p: Point| ((p.0 - a.0) * self.pixels[0], (p.1 - a.1) * self.pixels[1]);
        let (p, b) = (pixels(point), pixels(b));
        let length = b.0 * b.0 + b.1 * b.1;
        let share = if length > 0.0 { (p.0 * b.0 + p.1 * b.1) / length } else { 0.0 };
        let share = share.clamp(0.0, 1.0);
        (p.0 - share * b.0).hypot(p.1 - share * b.1)
    }
}

fn near(a: Point, b: Point) -> bool {
    (a.0 - b.0).abs() < f64::MIN_POSITIVE && (a.1 - b.1).abs() < f64::MIN_POSITIVE
}

#[cfg(test)]
mod tests {
    use super::Window;
    use proptest::prelude::*;

    const WINDOW: Window = Window { x: 0.0..10.0, y: -1.0..1.0, pixels: [100.0, 400.0] };

    #[test]
    fn a_curve_that_leaves_is_cut_at_the_edge() {
        let strokes = WINDOW.strokes([(0.0, 0.0), (4.0, 4.0), (8.0, 0.0)].into_iter());
        assert_eq!(strokes, [vec![(0.0, 0.0), (1.0, 1.0)], vec![(7.0, 1.0), (8.0, 0.0)]]);
        let through = WINDOW.strokes([(2.0, -3.0), (2.0, 3.0)].into_iter());
        assert_eq!(through, [vec![(2.0, -1.0), (2.0, 1.0)]]);
    }

    #[test]
    fn what_is_not_finite_is_a_gap() {
        let points =
            [(0.0, 0.0), (1.0, f64::NAN), (2.0, 0.5), (f64::INFINITY, 0.0), (4.0, 0.0), (5.0, 0.1)];
        let strokes = WINDOW.strokes(points.into_iter());
        assert_eq!(strokes, [vec![(0.0, 0.0)], vec![(2.0, 0.5)], vec![(4.0, 0.0), (5.0, 0.1)]]);
    }

    #[test]
    fn a_straight_line_is_two_points_and_a_spike_stays() {
        let line = |k: u32| (1e-2 * f64::from(k), 1e-3 * f64::from(k) - 0.5);
        let mut points: Vec<_> = (0..1000).map(line).collect();
        assert_eq!(WINDOW.strokes(points.iter().copied())[0].len(), 2);
        points[500].1 = 0.9;
        let [stroke] = &WINDOW.strokes(points.into_iter())[..] else { unreachable!() };
        assert!(stroke.contains(&(5.0, 0.9)) && stroke.len() <= 5, "{stroke:?}");
    }

    proptest! {
        /// Oracle: every point of the curve, and its distance to each piece that was drawn.
        #[test]
        fn nothing_inside_is_farther_than_the_tolerance(
            points in prop::collection::vec((0.0..10.0, -1.5..1.5), 1..60)
        ) {
            let strokes = WINDOW.strokes(points.iter().copied());
            for stroke in &strokes {
                prop_assert!(stroke.iter().all(|(x, y)| (-1e-9..=10.0 + 1e-9).contains(x) && y.abs() <= 1.0 + 1e-9));
            }
            for point in points.iter().filter(|point| WINDOW.holds(**point)) {
                let pieces = strokes.iter().flat_map(|s| s.windows(2).chain(s.windows(1)));
                let to = |s: &[(f64, f64)]| WINDOW.distance(*point, s[0], s[s.len() - 1]);
                let nearest = pieces.map(to).fold(f64::INFINITY, f64::min);
                prop_assert!(nearest < 0.31, "{point:?}: {nearest} px");
            }
        }
    }
}
