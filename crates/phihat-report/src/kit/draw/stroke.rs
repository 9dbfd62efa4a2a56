//! Curves without points that nobody could see.

/// Deviation from the whole curve that is allowed \[px\]; 60 px are a centimetre on paper.
const TOLERANCE_PX: f64 = 0.11;

/// Places beyond this are drawn here: far outside of any picture, on nearly the same line.
const FAR: f64 = 1e5;

type Pixel = [f64; 2];

/// The pieces of a curve, thinned; it is cut where it is not finite.
pub(super) fn strokes(points: impl Iterator<Item = Pixel>) -> Vec<Vec<Pixel>> {
    let mut strokes: Vec<Vec<Pixel>> = vec![Vec::new()];
    for point in points {
        if !point.iter().all(|x| x.is_finite()) {
            strokes.push(Vec::new());
        } else if let Some(stroke) = strokes.last_mut() {
            stroke.push(point.map(|x| x.clamp(-FAR, FAR)));
        }
    }
    strokes.iter().filter(|stroke| !stroke.is_empty()).map(|stroke| thinned(stroke)).collect()
}

/// Ramer, Douglas and Peucker: what is left out lies within [`TOLERANCE_PX`] of what is drawn.
fn thinned(stroke: &[Pixel]) -> Vec<Pixel> {
    let end = stroke.len() - 1;
    let mut keep = vec![false; stroke.len()];
    (keep[0], keep[end]) = (true, true);
    let mut open = vec![(0, end)];
    while let Some((from, to)) = open.pop() {
        let distances = (from + 1..to).map(|k| (distance(stroke[k], stroke[from], stroke[to]), k));
        let farthest = distances.max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((_, k)) = farthest.filter(|(far, _)| *far > TOLERANCE_PX) {
            keep[k] = true;
            open.extend([(from, k), (k, to)]);
        }
    }
    stroke.iter().zip(keep).filter(|(_, keep)| *keep).map(|(point, _)| *point).collect()
}

/// From a point to a segment \[px\].
fn distance(point: Pixel, a: Pixel, b: Pixel) -> f64 {
    let from = |x: Pixel| [x[0] - a[0], x[1] - a[1]];
    let (p, b) = (from(point), from(b));
    let length = b[0] * b[0] + b[1] * b[1];
    let share = if length > 0.0 { (p[0] * b[0] + p[1] * b[1]) / length } else { 0.0 };
    let share = share.clamp(0.0, 1.0);
    libm::hypot(p[0] - share * b[0], p[1] - share * b[1])
}

#[cfg(test)]
mod tests {
    use super::{distance, strokes};
    use proptest::prelude::*;

    #[test]
    fn what_is_not_finite_is_a_gap_and_a_spike_stays() {
        let gaps = [[0.0, 0.0], [1.0, f64::NAN], [2.0, 0.5], [f64::INFINITY, 0.0], [4.0, 0.0]];
        assert_eq!(strokes(gaps.into_iter()), [[[0.0, 0.0]], [[2.0, 0.5]], [[4.0, 0.0]]]);
        let mut line: Vec<_> = (0..1000).map(|k| [f64::from(k), 0.1 * f64::from(k)]).collect();
        assert_eq!(strokes(line.iter().copied())[0].len(), 2);
        line[500][1] = 900.0;
        let spike = &strokes(line.into_iter())[0];
        assert!(spike.contains(&[500.0, 900.0]) && spike.len() <= 5, "{spike:?}");
    }

    proptest! {
        /// Oracle: every point of the curve, and its distance to each piece that was drawn.
        #[test]
        fn nothing_is_farther_than_the_tolerance(
            points in prop::collection::vec([0.0..10.0, -1.5..1.5], 1..60)
        ) {
            let drawn = &strokes(points.iter().copied())[0];
            for point in &points {
                let to = |s: &[[f64; 2]]| distance(*point, s[0], s[s.len() - 1]);
                let nearest = drawn.windows(2).chain(drawn.windows(1)).map(to).fold(f64::INFINITY, f64::min);
                prop_assert!(nearest < 0.12, "{point:?}: {nearest} px");
            }
        }
    }
}
