//! Fronts of two figures that are both better when smaller.

/// A choice by what it costs: `[noise, error]`, both better when smaller, in any unit.
pub type FrontPoint = [f64; 2];

/// The points that no other beats in both figures, by their first figure; of equal ones the first. NaN is
/// left out.
pub fn front(points: &[FrontPoint]) -> Vec<FrontPoint> {
    let mut sorted: Vec<FrontPoint> =
        points.iter().copied().filter(|point| point.iter().all(|x| !x.is_nan())).collect();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut kept: Vec<FrontPoint> = Vec::new();
    for point in sorted {
        if kept.last().is_none_or(|last| point[1] < last[1]) {
            kept.push(point);
        }
    }
    kept
}

/// The area between a front and a reference point that is worse in both figures: what the points dominate.
///
/// ```text
/// area = Σ (r_1 − x_i) (y_{i−1} − y_i),     y_0 = r_2,  points of the front by rising x                (1)
/// ```
///
/// Larger is better. In logarithms of the figures it is an area of ratios: one law's front below another's by
/// a factor of two, over a decade of noise, is `ln 2 · ln 10` more. Points beyond the reference count for
/// nothing.
///
/// # References
///
/// E. Zitzler, L. Thiele, "Multiobjective evolutionary algorithms", IEEE Trans. Evolutionary Computation 3(4), 1999.
pub fn hypervolume(points: &[FrontPoint], reference: FrontPoint) -> f64 {
    let inside: Vec<FrontPoint> =
        points.iter().copied().filter(|p| p[0] < reference[0] && p[1] < reference[1]).collect();
    let mut above = reference[1];
    let strip = |point: &FrontPoint| {
        let area = (reference[0] - point[0]) * (above - point[1]);
        above = point[1];
        area
    };
    front(&inside).iter().map(strip).sum()
}

#[cfg(test)]
mod tests {
    use super::{front, hypervolume};
    use phihat_session::Dice;

    #[test]
    fn the_area_of_two_steps_is_that_of_two_rectangles() {
        let points = [[1.0, 3.0], [2.0, 1.0], [2.0, 2.0], [3.0, 1.0], [f64::NAN, 0.0], [9.0, 0.0]];
        assert_eq!(front(&points[..5]), [[1.0, 3.0], [2.0, 1.0]]);
        // (4 − 1)(4 − 3) + (4 − 2)(3 − 1)
        assert!((hypervolume(&points, [4.0, 4.0]) - 7.0).abs() < 1e-15);
        assert!(hypervolume(&[[5.0, 0.0]], [4.0, 4.0]).abs() < 1e-15);
    }

    /// The share of even draws in the reference's box that some point dominates, times the box: by counting.
    #[test]
    fn the_area_is_what_draws_say() {
        let mut dice = Dice::new(5, 0);
        let points: Vec<[f64; 2]> = (0..9).map(|_| [dice.share(), dice.share()]).collect();
        let beaten = |x: [f64; 2]| points.iter().any(|p| p[0] <= x[0] && p[1] <= x[1]);
        let draws = 200_000;
        let hit = (0..draws).filter(|_| beaten([dice.share(), dice.share()])).count();
        let (counted, found) = (hit as f64 / f64::from(draws), hypervolume(&points, [1.0, 1.0]));
        assert!((counted - found).abs() < 5e-3, "{counted} {found}");
    }
}
