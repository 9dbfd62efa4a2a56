//! Quantiles and shares of independent runs, with intervals that hold whatever the distribution is.
//!
//! The number of `n` independent values below the `p`-quantile is binomial, `B ~ Bin(n, p)`. So the `l`-th
//! and the `u`-th smallest value enclose the quantile with probability `P(l ≤ B ≤ u − 1)` or more, for any
//! distribution.

/// Probability that an interval of this module encloses what it is about, at least.
pub const CONFIDENCE: f64 = 0.95;

/// Probability left out at each end.
const TAIL: f64 = (1.0 - CONFIDENCE) / 2.0;

/// Places of a quantile among sorted values, from 1: of the estimate, and of both ends of its interval;
/// `None` if there are too few values to bound it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Places {
    /// Of the estimate: the smallest value with a share `p` of all at or below it.
    pub at: u64,
    /// Of the lower end.
    pub low: Option<u64>,
    /// Of the upper end.
    pub high: Option<u64>,
}

/// Places of the `p`-quantile among `n` sorted values, `0 < p < 1`; `None` for no values.
pub fn quantile_places(n: u64, p: f64) -> Option<Places> {
    if n == 0 {
        return None;
    }
    let binomial = Binomial::new(n, p);
    // The largest l with P(B ≤ l − 1) ≤ TAIL, the smallest u with P(B ≥ u) ≤ TAIL.
    let low = binomial.below(TAIL);
    let high = n + 1 - Binomial::new(n, 1.0 - p).below(TAIL);
    let at = whole((n as f64 * p).ceil()).clamp(1, n);
    Some(Places { at, low: (low > 0).then_some(low), high: (high <= n).then_some(high) })
}

/// The interval of Clopper and Pearson for the probability of something that happened in `k` of `n` runs.
pub fn share_interval(k: u64, n: u64) -> (f64, f64) {
    if n == 0 {
        return (0.0, 1.0);
    }
    // P(B ≥ k) at the lower end, P(B ≤ k) at the upper one are TAIL; each is monotone in p.
    let low = if k == 0 { 0.0 } else { crossing(|p| Binomial::new(n, p).at_least(k) > TAIL) };
    let high = if k == n { 1.0 } else { crossing(|p| Binomial::new(n, p).at_most(k) <= TAIL) };
    (low, high)
}

/// A whole number that is not negative, as one.
fn whole(x: f64) -> u64 {
    format!("{x:.0}").parse().unwrap_or(0)
}

/// Smallest argument at which `holds` is true, by bisection; it is true at 1 and false at 0.
fn crossing(holds: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if holds(middle) { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}

/// `Bin(n, p)` as far as it is not negligible: about its mode, relative to it, and all of it summed.
struct Binomial {
    /// The first place that is kept.
    first: u64,
    /// Probabilities from there on.
    masses: Vec<f64>,
}

/// Masses below this part of the largest are left out.
const NEGLIGIBLE: f64 = 1e-20;

impl Binomial {
    fn new(n: u64, p: f64) -> Self {
        let mode = whole(((n + 1) as f64 * p).floor()).min(n);
        let odds = p / (1.0 - p);
        let up = |k: u64| (n - k) as f64 / (k + 1) as f64 * odds;
        let (mut before, mut mass) = (Vec::new(), 1.0);
        for k in (0..mode).rev() {
            mass /= up(k);
            if mass < NEGLIGIBLE {
                break;
            }
            before.push(mass);
        }
        let first = mode - before.len() as u64;
        let mut masses: Vec<f64> = before.into_iter().rev().collect();
        masses.push(1.0);
        mass = 1.0;
        for k in mode..n {
            mass *= up(k);
            if mass < NEGLIGIBLE {
                break;
            }
            masses.push(mass);
        }
        let sum: f64 = masses.iter().sum();
        for mass in &mut masses {
            *mass /= sum;
        }
        Self { first, masses }
    }

    /// The largest `l` with `P(B < l) ≤ tail`.
    fn below(&self, tail: f64) -> u64 {
        let mut sum = 0.0;
        let within = self.masses.iter().take_while(|mass| {
            sum += **mass;
            sum <= tail
        });
        self.first + within.count() as u64
    }

    fn at_most(&self, k: u64) -> f64 {
        let places = (self.first..).zip(&self.masses);
        places.take_while(|(place, _)| *place <= k).map(|(_, mass)| mass).sum()
    }

    fn at_least(&self, k: u64) -> f64 {
        let places = (self.first..).zip(&self.masses);
        places.filter(|(place, _)| *place >= k).map(|(_, mass)| mass).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::{Places, quantile_places, share_interval};

    fn close(a: f64, b: f64) {
        assert!((a - b).abs() < 5e-5, "{a} and {b}");
    }

    #[test]
    fn intervals_are_those_of_the_textbooks() {
        // By hand from the table of B(16, 0.75): P(B ≤ 7) = 0.0075, P(B ≤ 8) = 0.0271, P(B ≥ 16) = 0.0100,
        // P(B ≥ 15) = 0.0635.
        assert_eq!(
            quantile_places(16, 0.75),
            Some(Places { at: 12, low: Some(8), high: Some(16) })
        );
        // The median of few: with 5 values no interval of 95 % is bounded (2·0.5⁵ = 0.0625), with 6 it is the
        // whole range.
        assert_eq!(quantile_places(5, 0.5), Some(Places { at: 3, low: None, high: None }));
        assert_eq!(quantile_places(6, 0.5), Some(Places { at: 3, low: Some(1), high: Some(6) }));
        // Wilks: 59 values bound the 95 % quantile at one side with 95 %; with 2.5 % left out it takes 72.
        assert_eq!(quantile_places(71, 0.95).and_then(|p| p.high), None);
        assert_eq!(quantile_places(72, 0.95).and_then(|p| p.high), Some(72));
        assert_eq!(quantile_places(0, 0.5), None);
    }

    #[test]
    fn shares_have_the_intervals_of_clopper_and_pearson() {
        // Closed forms at the ends: 1 − (α/2)^(1/n) and (α/2)^(1/n).
        let (low, high) = share_interval(0, 100);
        assert!(low.abs() < 1e-15);
        close(high, 1.0 - 0.025_f64.powf(0.01));
        let (low, high) = share_interval(10, 10);
        close(low, 0.025_f64.powf(0.1));
        assert!((high - 1.0).abs() < 1e-15);
        // Clopper and Pearson, 1934: 3 of 10.
        let (low, high) = share_interval(3, 10);
        close(low, 0.066_74);
        close(high, 0.652_45);
    }

    #[test]
    fn a_million_runs_are_no_trouble() {
        // Normal approximation: 990 000 ± 1.96·sqrt(9900).
        let places = quantile_places(1_000_000, 0.99).map(|p| (p.at, p.low, p.high));
        let Some((990_000, Some(low), Some(high))) = places else { unreachable!("{places:?}") };
        assert!(low.abs_diff(989_805) < 5 && high.abs_diff(990_196) < 5, "{low} {high}");
        let (low, high) = share_interval(0, 1_000_000);
        assert!(low.abs() < 1e-15 && (high - 3.69e-6).abs() < 1e-8, "{high}");
    }
}
