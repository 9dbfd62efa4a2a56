//! Fewer samples, same picture: no peak is lost.

use std::ops::Range;

/// Indices to keep of `span`, in order, so that curves drawn through them look like the originals.
///
/// # Method
///
/// M4: the span is cut into `buckets`; of each bucket and curve the first, the last, the lowest
/// and the highest sample are kept, both sides of a jump, so that it stays steep when zoomed, and
/// the borders of every stretch that is not finite, so that a gap stays a gap. All curves share the indices. A span that is short enough is kept whole.
///
/// # References
///
/// Jugel et al., *M4: a visualization-oriented time series data aggregation*, VLDB 2014.
pub(crate) fn kept(curves: &[Vec<f64>], span: Range<usize>, buckets: usize) -> Vec<usize> {
    let (count, buckets) = (span.len(), buckets.max(1));
    if count <= 4 * buckets {
        return span.collect();
    }
    let mut indices = Vec::with_capacity(8 * buckets);
    for b in 0..buckets {
        let bucket = span.start + b * count / buckets..span.start + (b + 1) * count / buckets;
        indices.extend([bucket.start, bucket.end - 1]);
        for curve in curves {
            extremes(curve, bucket.clone(), &mut indices);
            jump(curve, bucket.clone(), &mut indices);
            gap_borders(curve, bucket.clone(), &mut indices);
        }
    }
    indices.sort_unstable();
    indices.dedup();
    indices
}

fn extremes(curve: &[f64], bucket: Range<usize>, indices: &mut Vec<usize>) {
    let finite = || bucket.clone().filter(|&k| curve[k].is_finite());
    indices.extend(finite().min_by(|&i, &k| curve[i].total_cmp(&curve[k])));
    indices.extend(finite().max_by(|&i, &k| curve[i].total_cmp(&curve[k])));
}

/// A change from one sample to the next that is more than this part of the whole bucket's.
const JUMP: f64 = 0.25;

fn jump(curve: &[f64], bucket: Range<usize>, indices: &mut Vec<usize>) {
    let step = |k: usize| (curve[k + 1] - curve[k]).abs();
    let steps = bucket.start..bucket.end.saturating_sub(1);
    let finite = steps.filter(|&k| step(k).is_finite());
    let Some(steepest) = finite.max_by(|&i, &k| step(i).total_cmp(&step(k))) else { return };
    let (low, high) = bucket
        .map(|k| curve[k])
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if step(steepest) > JUMP * (high - low) {
        indices.extend([steepest, steepest + 1]);
    }
}

fn gap_borders(curve: &[f64], bucket: Range<usize>, indices: &mut Vec<usize>) {
    let mut gaps = bucket.filter(|&k| !curve[k].is_finite());
    let Some(first) = gaps.next() else { return };
    indices.push(first);
    indices.extend(gaps.next_back());
}

#[cfg(test)]
mod tests {
    use super::kept;
    use proptest::prelude::*;

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
            let indices = kept(&curves, 0..values.len(), buckets);
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
        let indices = kept(&[curve], 0..10_000, 100);
        assert!(indices.contains(&4_320) && indices.contains(&4_321));
    }

    #[test]
    fn a_peak_in_every_bucket_survives() {
        let mut curve = vec![0.0; 10_000];
        for k in (7..10_000).step_by(100) {
            curve[k] = 5.0;
            curve[k + 1] = -5.0;
        }
        let indices = kept(&[curve.clone()], 0..10_000, 100);
        let count = |v: f64| indices.iter().filter(|&&k| (curve[k] - v).abs() < 1e-9).count();
        assert_eq!((count(5.0), count(-5.0)), (100, 100));
    }
}
