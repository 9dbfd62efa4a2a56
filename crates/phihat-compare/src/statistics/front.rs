//! Fronts of two figures that are both better when smaller.

use serde::{Deserialize, Serialize};

use super::paired::sorted_quantile;

/// A choice by what it costs: `[noise, error]`, both better when smaller, in any unit.
pub type Point = [f64; 2];

/// The points that no other beats in both figures, by their first figure; of equal ones the first. NaN is
/// left out.
pub fn front(points: &[Point]) -> Vec<Point> {
    let mut sorted: Vec<Point> =
        points.iter().copied().filter(|point| point.iter().all(|x| !x.is_nan())).collect();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut kept: Vec<Point> = Vec::new();
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
pub fn hypervolume(points: &[Point], reference: Point) -> f64 {
    let inside: Vec<Point> =
        points.iter().copied().filter(|p| p[0] < reference[0] && p[1] < reference[1]).collect();
    let mut above = reference[1];
    let strip = |point: &Point| {
        let area = (reference[0] - point[0]) * (above - point[1]);
        above = point[1];
        area
    };
    front(&inside).iter().map(strip).sum()
}

/// Quantile of the values at a share, linear between neighbours; `None` for no values, or if one is NaN.
pub fn quantile(values: &[f64], share: f64) -> Option<f64> {
    if values.is_empty() || values.iter().any(|value| value.is_nan()) {
        return None;
    }
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    Some(sorted_quantile(&sorted, share))
}

/// Median and quartiles of several runs of one thing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// A quarter lies below.
    pub lower: f64,
    /// Half lies below.
    pub median: f64,
    /// Three quarters lie below.
    pub upper: f64,
}

impl Spread {
    /// `None` of none, or where one is no number.
    pub fn of(values: &[f64]) -> Option<Self> {
        let at = |share: f64| quantile(values, share);
        Some(Self { lower: at(0.25)?, median: at(0.5)?, upper: at(0.75)? })
    }
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
