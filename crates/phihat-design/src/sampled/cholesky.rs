//! Whether a small symmetric matrix is positive definite, checked without a library.

/// Least pivot of the Cholesky factorisation, each as a share of its diagonal entry; negative or zero when
/// the matrix is not positive definite, NaN when it holds one.
pub(crate) fn least_pivot(matrix: &[Vec<f64>]) -> f64 {
    let n = matrix.len();
    let mut factor = vec![vec![0.0; n]; n];
    let mut least = f64::INFINITY;
    for j in 0..n {
        let spent: f64 = factor[j][..j].iter().map(|f| f * f).sum();
        let pivot = matrix[j][j] - spent;
        let share = pivot / matrix[j][j].abs();
        if share.is_nan() || share <= 0.0 {
            return share;
        }
        least = least.min(share);
        let root = pivot.sqrt();
        factor[j][j] = root;
        for i in j + 1..n {
            let spent: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
            factor[i][j] = (matrix[i][j] - spent) / root;
        }
    }
    least
}
