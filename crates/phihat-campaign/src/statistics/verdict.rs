//! Conclusion from a ratio: better, worse, or not distinguishable.

use serde::{Deserialize, Serialize};

use super::paired::Ratio;

/// A ratio nearer to 1 than this does not matter to anybody, however sure it is.
pub const NOTICEABLE: f64 = 1.1;

/// Level that corrected p-values are compared with.
const LEVEL: f64 = 0.05;

/// Band of error ratios between one law and itself under another name, tuned and measured like two laws.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Placebo {
    /// A factor, 1 or more: ratios from `1/factor` to `factor` are what tuning and worlds do to one law.
    pub factor: f64,
    /// Number of pairs.
    pub pairs: usize,
}

/// The band of several pairs, each one law under two names: the farthest end of all their intervals. Without
/// a pair the factor is 1 and the count 0.
pub fn placebo(pairs: &[Ratio]) -> Placebo {
    let far = |pair: &Ratio| pair.interval.iter().map(|end| end.ln().abs()).fold(0.0, f64::max);
    let most = pairs.iter().map(far).fold(0.0, f64::max);
    Placebo { factor: most.exp(), pairs: pairs.len() }
}

/// Conclusion about a law against another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Standing {
    /// Smaller errors: beyond the placebo band, by more than 10 %, and not by chance.
    Better,
    /// Larger errors, likewise.
    Worse,
    /// Not distinguishable by this comparison.
    Alike,
}

/// The standing of a ratio whose p-value was corrected for all questions that were asked.
pub fn standing(ratio: &Ratio, corrected: f64, placebo: Placebo) -> Standing {
    let bar = placebo.factor.max(NOTICEABLE);
    if corrected > LEVEL || corrected.is_nan() {
        Standing::Alike
    } else if ratio.ratio < 1.0 / bar {
        Standing::Better
    } else if ratio.ratio > bar {
        Standing::Worse
    } else {
        Standing::Alike
    }
}

#[cfg(test)]
mod tests {
    use super::{Placebo, Ratio, Standing, placebo, standing};

    fn of(ratio: f64, interval: [f64; 2]) -> Ratio {
        Ratio { ratio, interval, p: 0.001 }
    }

    #[test]
    fn better_takes_the_band_ten_percent_and_no_chance() {
        let band = placebo(&[of(1.02, [0.8, 1.1]), of(1.0, [0.9, 1.2])]);
        assert!((band.factor - 1.25).abs() < 1e-12 && band.pairs == 2, "{band:?}");
        let sure = |ratio: f64| standing(&of(ratio, [ratio, ratio]), 0.01, band);
        assert_eq!(sure(0.79), Standing::Better);
        assert_eq!(sure(0.81), Standing::Alike);
        assert_eq!(sure(1.24), Standing::Alike);
        assert_eq!(sure(1.26), Standing::Worse);
        assert_eq!(standing(&of(0.1, [0.1, 0.1]), 0.06, band), Standing::Alike);
        let none = Placebo { factor: 1.0, pairs: 0 };
        assert_eq!(standing(&of(0.92, [0.92, 0.92]), 0.001, none), Standing::Alike);
        assert_eq!(standing(&of(0.90, [0.90, 0.90]), 0.001, none), Standing::Better);
    }
}
