//! Square matrices of an arm's size.

/// Row-major `n × n`.
pub(crate) type StateSquare = Vec<f64>;

/// `a b`, all `n × n`.
pub(crate) fn product(a: &[f64], b: &[f64], n: usize) -> StateSquare {
    let mut out = vec![0.0; n * n];
    for i in 0..n {
        for k in 0..n {
            let factor = a[i * n + k];
            for j in 0..n {
                out[i * n + j] += factor * b[k * n + j];
            }
        }
    }
    out
}
