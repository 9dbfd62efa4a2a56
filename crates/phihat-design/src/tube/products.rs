//! Products of matrices, row by row, with vectors.

/// `Σ_k t_ijk x_k`, `n × n`.
pub(super) fn contracted(tensor: &[f64], x: &[f64]) -> Vec<f64> {
    let n = x.len();
    tensor.chunks_exact(n).map(|row| row.iter().zip(x).map(|(t, x)| t * x).sum()).collect()
}

/// `m x` for an `r × n` matrix.
pub(super) fn times(matrix: &[f64], x: &[f64]) -> Vec<f64> {
    matrix.chunks_exact(x.len()).map(|row| row.iter().zip(x).map(|(m, x)| m * x).sum()).collect()
}

/// `|m| x`.
pub(super) fn times_abs(matrix: &[f64], x: &[f64]) -> Vec<f64> {
    let row = |row: &[f64]| row.iter().zip(x).map(|(m, x)| m.abs() * x).sum();
    matrix.chunks_exact(x.len()).map(row).collect()
}

/// `|mᵀ| x` for an `r × n` matrix, `x` of length `r`.
pub(super) fn transposed_abs(matrix: &[f64], n: usize, x: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; n];
    for (row, x) in matrix.chunks_exact(n).zip(x) {
        for (out, m) in out.iter_mut().zip(row) {
            *out += m.abs() * x;
        }
    }
    out
}
