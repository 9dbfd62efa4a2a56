//! Fewer samples, same picture: no peak is lost. Chosen while the samples go by.

use core::ops::Range;

/// Curves of one chart at most.
pub(crate) const CURVES: usize = 2;

/// One sample of the curves of a chart; entries beyond them are not used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ChartSample {
    /// Number of the sample in the run.
    pub k: u64,
    /// Its time \[s\].
    pub t: f64,
    /// Its values, not a number where there is nothing to draw.
    pub y: [f64; CURVES],
}

/// Samples of a part of a run, so chosen that curves drawn through them look like the originals.
///
/// # Method
///
/// M4: the part is cut into stretches; of each stretch and curve the first, the last, the lowest
/// and the highest sample are kept, both sides of a jump, so that it stays steep when zoomed, and
/// the borders of every gap that is not finite, so that it stays a gap. All curves share the samples. A part
/// that is short enough is kept whole.
///
/// # References
///
/// Jugel et al., *M4: a visualization-oriented time series data aggregation*, VLDB 2014.
#[derive(Debug, Clone)]
pub(crate) struct Stretches {
    part: Range<u64>,
    count: u64,
    /// The stretch that is going on, and the sample that it ends before.
    at: u64,
    end: u64,
    stretch: TimeStretch,
    rows: Vec<ChartSample>,
}

/// A change from one sample to the next that is more than this share of the whole stretch's.
const JUMP: f64 = 0.25;

#[derive(Debug, Clone, Copy, Default)]
struct TimeStretch {
    ends: Option<(ChartSample, ChartSample)>,
    curves: [CurveExtremes; CURVES],
}

/// Samples of one curve that a stretch stores.
#[derive(Debug, Clone, Copy, Default)]
struct CurveExtremes {
    low: Option<ChartSample>,
    high: Option<ChartSample>,
    /// The steepest change that is a number: its two sides.
    steepest: Option<(ChartSample, ChartSample)>,
    gap: Option<(ChartSample, ChartSample)>,
}

impl Stretches {
    /// To choose from a part of a run, of so many stretches.
    pub(crate) fn new(part: Range<u64>, count: usize) -> Self {
        let count = u64::try_from(count).unwrap_or(u64::MAX).max(1);
        let mut made = Self {
            at: 0,
            end: part.start,
            part,
            count,
            stretch: TimeStretch::default(),
            rows: Vec::new(),
        };
        made.end = made.border(1);
        made
    }

    /// First sample of a stretch.
    fn border(&self, stretch: u64) -> u64 {
        let length = u128::from(self.part.end.saturating_sub(self.part.start));
        let at = u128::from(stretch) * length / u128::from(self.count);
        self.part.start + u64::try_from(at).unwrap_or(u64::MAX)
    }

    /// The next sample of the run.
    pub(crate) fn push(&mut self, row: ChartSample) {
        if !self.part.contains(&row.k) {
            return;
        }
        if self.part.end - self.part.start <= 4 * self.count {
            self.rows.push(row);
            return;
        }
        if row.k >= self.end {
            self.close();
            while row.k >= self.end {
                self.at += 1;
                self.end = self.border(self.at + 1);
            }
        }
        self.stretch.add(row);
    }

    /// Stored samples, in the order of the run.
    pub(crate) fn finish(mut self) -> Vec<ChartSample> {
        self.close();
        self.rows
    }

    fn close(&mut self) {
        let mut kept = core::mem::take(&mut self.stretch).kept();
        kept.sort_unstable_by_key(|row| row.k);
        kept.dedup_by_key(|row| row.k);
        self.rows.extend(kept);
    }
}

impl TimeStretch {
    fn add(&mut self, row: ChartSample) {
        let before = self.ends.map(|(_, last)| last);
        self.ends = Some((self.ends.map_or(row, |(first, _)| first), row));
        for (c, seen) in self.curves.iter_mut().enumerate() {
            let value = row.y[c];
            if !value.is_finite() {
                seen.gap = Some((seen.gap.map_or(row, |(first, _)| first), row));
                continue;
            }
            // The first of the lowest and the last of the highest, where several are.
            if seen.low.is_none_or(|low| value.total_cmp(&low.y[c]).is_lt()) {
                seen.low = Some(row);
            }
            if seen.high.is_none_or(|high| value.total_cmp(&high.y[c]).is_ge()) {
                seen.high = Some(row);
            }
            let step = |(a, b): (ChartSample, ChartSample)| (b.y[c] - a.y[c]).abs();
            let pair = before.map(|before| (before, row)).filter(|pair| step(*pair).is_finite());
            if pair.is_some_and(|pair| seen.steepest.is_none_or(|most| step(pair) >= step(most))) {
                seen.steepest = pair;
            }
        }
    }

    fn kept(self) -> Vec<ChartSample> {
        let pair = |(a, b): (ChartSample, ChartSample)| [a, b];
        let mut rows: Vec<ChartSample> = self.ends.into_iter().flat_map(pair).collect();
        for (c, seen) in self.curves.iter().enumerate() {
            rows.extend(seen.low.into_iter().chain(seen.high));
            rows.extend(seen.gap.into_iter().flat_map(pair));
            let height = seen.high.zip(seen.low).map_or(0.0, |(high, low)| high.y[c] - low.y[c]);
            let jump = seen.steepest.filter(|(a, b)| (b.y[c] - a.y[c]).abs() > JUMP * height);
            rows.extend(jump.into_iter().flat_map(pair));
        }
        rows
    }
}

#[cfg(test)]
mod tests {
    use super::{CURVES, ChartSample, Stretches};
    use proptest::prelude::*;

    /// Numbers of the samples that are kept of curves.
    fn kept(curves: &[Vec<f64>], buckets: usize) -> Vec<usize> {
        let samples = curves[0].len();
        let mut stretches = Stretches::new(0..samples as u64, buckets);
        for k in 0..samples {
            let y: [f64; CURVES] = std::array::from_fn(|c| curves.get(c).map_or(0.0, |y| y[k]));
            stretches.push(ChartSample { k: k as u64, t: k as f64, y });
        }
        let rows = stretches.finish();
        rows.iter().map(|row| usize::try_from(row.k).unwrap_or(usize::MAX)).collect()
    }

    fn sample() -> impl Strategy<Value = f64> {
        prop_oneof![9 => -1e3..1e3, 1 => Just(f64::NAN)]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1_000))]
        #[test]
        fn extrema_of_every_stretch_survive(
            values in prop::collection::vec(sample(), 0..400), buckets in 1usize..40,
        ) {
            let curves = [values.clone(), values.iter().rev().copied().collect()];
            let indices = kept(&curves, buckets);
            prop_assert!(indices.windows(2).all(|w| w[0] < w[1]));
            prop_assert_eq!(indices.first().copied(), (!values.is_empty()).then_some(0));
            prop_assert!(indices.len() <= values.len().min(14 * buckets).max(4 * buckets));
            for curve in &curves {
                // Oracle: plain scan of the whole curve, on bits.
                let bits = |high: bool, from: &mut dyn Iterator<Item = f64>| {
                    let finite = from.filter(|v| v.is_finite());
                    if high { finite.fold(f64::NEG_INFINITY, f64::max).to_bits() }
                    else { finite.fold(f64::INFINITY, f64::min).to_bits() }
                };
                for high in [false, true] {
                    let all = bits(high, &mut curve.iter().copied());
                    let some = bits(high, &mut indices.iter().map(|&k| curve[k]));
                    prop_assert_eq!(all, some);
                }
                let gaps = curve.iter().any(|v| v.is_nan());
                prop_assert_eq!(gaps, indices.iter().any(|&k| curve[k].is_nan()));
            }
        }
    }

    #[test]
    fn a_jump_stays_steep() {
        let curve: Vec<f64> =
            (0..10_000).map(|k| 1e-3 * f64::from(k) + if k < 4_321 { 0.0 } else { 9.0 }).collect();
        let indices = kept(&[curve], 100);
        assert!(indices.contains(&4_320) && indices.contains(&4_321));
    }

    #[test]
    fn a_peak_in_every_bucket_survives() {
        let mut curve = vec![0.0; 10_000];
        for k in (7..10_000).step_by(100) {
            curve[k] = 5.0;
            curve[k + 1] = -5.0;
        }
        let indices = kept(&[curve.clone()], 100);
        let count = |v: f64| indices.iter().filter(|&&k| (curve[k] - v).abs() < 1e-9).count();
        assert_eq!((count(5.0), count(-5.0)), (100, 100));
    }
}
