//! Means.

/// Arithmetic mean; 0 for no values.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Root of the mean square; 0 for no values.
pub fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// Geometric mean of positive values; 1 for no values.
pub fn geometric_mean(values: &[f64]) -> f64 {
    let logs: f64 = values.iter().map(|value| value.ln()).sum();
    (logs / values.len().max(1) as f64).exp()
}

#[cfg(test)]
mod tests {
    use super::{geometric_mean, mean, rms};

    /// By hand; and the means of positive values stand in this order (Maclaurin).
    #[test]
    fn means_are_those_of_the_definition_and_in_order() {
        let values = [1.0, 2.0, 4.0];
        assert!((mean(&values) - 7.0 / 3.0).abs() < 1e-15);
        assert!((rms(&values) - 7.0_f64.sqrt()).abs() < 1e-15);
        assert!((geometric_mean(&values) - 2.0).abs() < 1e-15);
        assert!(mean(&[]).abs() < 1e-15 && rms(&[]).abs() < 1e-15);
        assert!((geometric_mean(&[]) - 1.0).abs() < 1e-15);
        let values: Vec<f64> = (1..50).map(|k| (f64::from(k) * 0.618_034).fract() + 0.01).collect();
        assert!(geometric_mean(&values) < mean(&values) && mean(&values) < rms(&values));
    }
}
