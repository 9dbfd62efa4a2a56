//! Curves that any data can be: none, one value, or a diverged run.

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
