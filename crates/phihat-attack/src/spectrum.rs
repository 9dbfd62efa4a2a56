//! Inertia matrices with a given spectrum, and inverses of small matrices.

use phihat_session::Dice;

/// `M̄^{1/2} U diag(μ) Uᵀ M̄^{1/2}` with a random rotation `U` and `μ` in a range: at its ends, or anywhere between.
pub(crate) fn with_spectrum(
    nominal: &[f64],
    (low, high): (f64, f64),
    ends: bool,
    dice: &mut Dice,
) -> Vec<Vec<f64>> {
    let n = nominal.len();
    let draw = |dice: &mut Dice| {
        if ends { dice.pick(&[low, high]) } else { dice.log_between(low, high) }
    };
    let mut matrix = vec![vec![0.0; n]; n];
    for (i, row) in matrix.iter_mut().enumerate() {
        row[i] = draw(dice);
    }
    for i in 0..n {
        for j in i + 1..n {
            turn(&mut matrix, (i, j), dice.between(0.0, core::f64::consts::TAU));
        }
    }
    for (i, row) in matrix.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            *entry *= (nominal[i] * nominal[j]).sqrt();
        }
    }
    matrix
}

/// `R A Rᵀ` with a rotation in the plane of two axes.
fn turn(matrix: &mut [Vec<f64>], (i, j): (usize, usize), angle: f64) {
    let (sin, cos) = angle.sin_cos();
    for row in matrix.iter_mut() {
        (row[i], row[j]) = (cos * row[i] - sin * row[j], sin * row[i] + cos * row[j]);
    }
    for k in 0..matrix.len() {
        let (a, b) = (matrix[i][k], matrix[j][k]);
        (matrix[i][k], matrix[j][k]) = (cos * a - sin * b, sin * a + cos * b);
    }
}

/// By Gauss and Jordan, with pivots; `None`: singular.
pub(crate) fn inverse(matrix: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let n = matrix.len();
    let unit = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 };
    let mut rows: Vec<Vec<f64>> = (0..n)
        .map(|i| matrix[i].iter().copied().chain((0..n).map(|j| unit(i, j))).collect())
        .collect();
    for column in 0..n {
        let size = |row: &usize| rows[*row][column].abs();
        let pivot = (column..n).max_by(|a, b| size(a).total_cmp(&size(b)))?;
        rows.swap(column, pivot);
        let own = rows[column].clone();
        let by = own[column];
        if by == 0.0 || !by.is_finite() {
            return None;
        }
        for (i, row) in rows.iter_mut().enumerate() {
            let factor = if i == column { 1.0 - 1.0 / by } else { row[column] / by };
            for (entry, own) in row.iter_mut().zip(&own) {
                *entry -= factor * own;
            }
        }
    }
    Some(rows.into_iter().map(|row| row[n..].to_vec()).collect())
}

#[cfg(test)]
mod tests {
    use super::{inverse, with_spectrum};
    use phihat_session::Dice;

    #[test]
    fn trace_and_inverse_of_drawn_matrices() {
        for index in 0..50 {
            let mut dice = Dice::new(3, index);
            let matrix = with_spectrum(&[1.0, 1.0, 1.0], (0.5, 2.0), index % 2 == 0, &mut dice);
            let inverse = inverse(&matrix).unwrap();
            let trace = |m: &[Vec<f64>]| (0..3).map(|i| m[i][i]).sum::<f64>();
            assert!(
                (1.499..=6.001).contains(&trace(&matrix))
                    && (1.499..=6.001).contains(&trace(&inverse))
            );
            for i in 0..3 {
                for j in 0..3 {
                    let product: f64 = (0..3).map(|k| matrix[i][k] * inverse[k][j]).sum();
                    let unit = if i == j { 1.0 } else { 0.0 };
                    assert!((product - unit).abs() < 1e-12, "{matrix:?}");
                    assert!((matrix[i][j] - matrix[j][i]).abs() < 1e-12);
                }
            }
        }
    }
}
