//! Ranges of axes that hold any data: none, one value, or a diverged run.

use std::ops::Range;

/// The finite extent of `values`, widened by `margin` of itself on both sides.
pub(super) fn extent(values: impl Iterator<Item = f64>, margin: f64) -> Range<f64> {
    let finite = values.filter(|v| v.is_finite());
    let (low, high) =
        finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if low > high {
        return -1.0..1.0;
    }
    // An axis narrower than this could not tell its ticks apart.
    let least = (1e-6 * low.abs().max(high.abs())).max(1e-9);
    let pad = (margin * (high - low)).max(if high - low < least { least } else { 0.0 });
    low - pad..high + pad
}

/// Cuts a curve where it is not finite.
pub(super) fn strokes(x: &[f64], y: &[f64]) -> Vec<Vec<(f64, f64)>> {
    let mut strokes = vec![vec![]];
    for point in x.iter().copied().zip(y.iter().copied()) {
        if point.0.is_finite() && point.1.is_finite() {
            if let Some(stroke) = strokes.last_mut() {
                stroke.push(point);
            }
        } else {
            strokes.push(vec![]);
        }
    }
    strokes.retain(|s| !s.is_empty());
    strokes
}
