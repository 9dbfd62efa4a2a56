//! Quantiles of a few values.

use serde::{Deserialize, Serialize};

/// Quantile of the values at a share, linear between neighbours; `None` for no values, or if one is NaN.
///
/// # References
///
/// R. J. Hyndman, Y. Fan, "Sample quantiles in statistical packages", American Statistician 50(4), 1996: definition 7.
pub fn quantile(values: &[f64], share: f64) -> Option<f64> {
    if values.is_empty() || values.iter().any(|value| value.is_nan()) {
        return None;
    }
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    Some(sorted_quantile(&sorted, share))
}

/// The same of sorted values, one at least.
pub(super) fn sorted_quantile(sorted: &[f64], share: f64) -> f64 {
    let place = share.clamp(0.0, 1.0) * (sorted.len() - 1) as f64;
    let (below, part) = (place.floor(), place.fract());
    let index = (0..sorted.len()).find(|k| *k as f64 >= below).unwrap_or(0);
    let above = (index + 1).min(sorted.len() - 1);
    sorted[index] + part * (sorted[above] - sorted[index])
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
    use super::{quantile, sorted_quantile};

    #[test]
    fn quantiles_are_linear_between_neighbours() {
        assert!((sorted_quantile(&[1.0, 2.0, 4.0], 0.75) - 3.0).abs() < 1e-15);
        assert!((sorted_quantile(&[5.0], 0.3) - 5.0).abs() < 1e-15);
        assert_eq!(quantile(&[4.0, 1.0, 2.0], 0.5), Some(2.0));
        assert!(quantile(&[], 0.5).is_none() && quantile(&[f64::NAN], 0.5).is_none());
    }
}
