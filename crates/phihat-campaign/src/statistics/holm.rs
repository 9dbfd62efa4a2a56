//! Many questions at once.

/// Holm's correction: `p` of every one of `m` questions, such that the chance of any wrong "yes" among them
/// is at most the level that they are compared with, however the questions depend on each other.
///
/// With `p_(1) ≤ … ≤ p_(m)`
///
/// ```text
/// p̃_(i) = min(1, max_{j ≤ i} (m − j + 1) p_(j))                                       (1)
/// ```
///
/// In the order of the input. A figure that is no number counts as 1: a question without an answer is no "yes".
///
/// # References
///
/// S. Holm, "A simple sequentially rejective multiple test procedure", Scandinavian J. Statistics 6(2), 1979.
pub fn holm(p: &[f64]) -> Vec<f64> {
    let stated: Vec<f64> = p.iter().map(|p| if p.is_nan() { 1.0 } else { *p }).collect();
    let mut order: Vec<usize> = (0..stated.len()).collect();
    order.sort_by(|a, b| stated[*a].total_cmp(&stated[*b]));
    let mut adjusted = vec![1.0; stated.len()];
    let (mut most, mut left) = (0.0_f64, stated.len() as f64);
    for place in order {
        most = most.max((left * stated[place]).min(1.0));
        adjusted[place] = most;
        left -= 1.0;
    }
    adjusted
}

#[cfg(test)]
mod tests {
    use super::holm;

    /// Worked by hand from the definition; and the largest is not below the one before it.
    #[test]
    fn the_smallest_counts_all_and_the_largest_itself() {
        let adjusted = holm(&[0.01, 0.04, 0.03, 0.005]);
        for (found, exact) in adjusted.iter().zip([0.03, 0.06, 0.06, 0.02]) {
            assert!((found - exact).abs() < 1e-15, "{adjusted:?}");
        }
        assert!(holm(&[]).is_empty());
        assert_eq!(holm(&[0.6, f64::NAN, 0.9]), [1.0, 1.0, 1.0]);
    }

    /// Never less than what was asked, never more than Bonferroni's, and in the same order.
    #[test]
    fn it_lies_between_none_and_bonferroni() {
        let p: Vec<f64> = (1..40).map(|k| (f64::from(k) * 0.618_034).fract().powi(3)).collect();
        let adjusted = holm(&p);
        for (a, p) in adjusted.iter().zip(&p) {
            assert!(*a >= *p && *a <= (p * 39.0).min(1.0) + 1e-15);
        }
        for (i, a) in adjusted.iter().enumerate() {
            assert!(p.iter().zip(&adjusted).all(|(other, b)| *other < p[i] || b >= a));
        }
    }
}
