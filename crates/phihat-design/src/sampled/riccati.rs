//! A solution of a Riccati equation, from the sign of its Hamiltonian matrix.

use nalgebra::DMatrix;

/// The stabilising `P` of `AᵀP + PA + P G P + Q = 0`, symmetric; `None` when the iteration finds none.
///
/// # Method
///
/// Newton's iteration `H ← (c H + (c H)⁻¹)/2`, `c` by the determinant, on `H = [[A, G], [−Q, −Aᵀ]]`; the stable
/// subspace is the kernel of `sign H + 1`.
pub(crate) fn solve(a: &DMatrix<f64>, g: &DMatrix<f64>, q: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = a.nrows();
    let mut h = DMatrix::zeros(2 * n, 2 * n);
    h.view_mut((0, 0), (n, n)).copy_from(a);
    h.view_mut((0, n), (n, n)).copy_from(g);
    h.view_mut((n, 0), (n, n)).copy_from(&-q);
    h.view_mut((n, n), (n, n)).copy_from(&-a.transpose());
    for _ in 0..60 {
        let inverse = h.clone().try_inverse()?;
        let c = (inverse.norm() / h.norm()).sqrt();
        let next = (&h * c + inverse / c) * 0.5;
        let moved = (&next - &h).norm();
        let size = next.norm();
        h = next;
        if !size.is_finite() {
            return None;
        }
        if moved < 1e-13 * size {
            break;
        }
    }
    // (sign H + 1) [I; P] = 0: the right block times P is minus the left block.
    for i in 0..2 * n {
        h[(i, i)] += 1.0;
    }
    let left = h.columns(0, n).into_owned();
    let right = h.columns(n, n).into_owned();
    // Reflections take roots alone, which are the same bits on every machine.
    let (mut known, factors) = (-left, right.qr());
    factors.q_tr_mul(&mut known);
    let p = factors.unpack_r().solve_upper_triangular(&known.rows(0, n))?;
    Some((&p + p.transpose()) * 0.5)
}
