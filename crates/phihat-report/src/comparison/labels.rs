//! Places for the labels of a scatter plot: one column beside it, in the order of the marks, none on another.

/// Least distance of two labels.
const GAP: f64 = 15.0;

/// Heights for the labels of marks at heights `y`, in the same order: as near as the gap and the column from `top`
/// to `bottom` allow. Labels in a column that is too short begin above it.
pub(super) fn heights(y: &[f64], top: f64, bottom: f64) -> Vec<f64> {
    let mut order: Vec<usize> = (0..y.len()).collect();
    order.sort_by(|&i, &k| y[i].total_cmp(&y[k]));
    let mut heights = vec![0.0; y.len()];
    let mut above = f64::NEG_INFINITY;
    for &k in &order {
        above = y[k].max(top).max(above + GAP);
        heights[k] = above;
    }
    let mut below = bottom + GAP;
    for &k in order.iter().rev() {
        below = heights[k].min(below - GAP);
        heights[k] = below;
    }
    heights
}

#[cfg(test)]
mod tests {
    use super::{GAP, heights};

    #[test]
    fn labels_of_a_crowd_keep_their_order_and_their_distance() {
        let y: Vec<f64> = (0..30).map(|k| 300.0 + f64::from((k * 7) % 30)).collect();
        let placed = heights(&y, 20.0, 500.0);
        for i in 0..30 {
            assert!((20.0 - 1e-9..=500.0 + 1e-9).contains(&placed[i]));
            for k in 0..30 {
                if y[i] < y[k] {
                    assert!(placed[i] + GAP <= placed[k] + 1e-9, "{i} {k}");
                }
            }
        }
        // Alone, a label is where its mark is.
        assert_eq!(heights(&[100.0, 200.0], 20.0, 500.0), [100.0, 200.0]);
    }
}
