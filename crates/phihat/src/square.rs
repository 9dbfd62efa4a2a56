//! Small square matrices, of which the leading `m × m` block counts: at design time only.

type Square<const N: usize> = [[f64; N]; N];

/// Coefficients `c_0 … c_{m−1}` of `det(λ − A) = λ^m + c_{m−1} λ^{m−1} + … + c_0`.
pub(crate) fn characteristic_polynomial<const N: usize>(a: &Square<N>, m: usize) -> [f64; N] {
    let mut c = [0.0; N];
    let mut work = [[0.0; N]; N];
    let mut last = 1.0;
    let mut k = 1.0;
    for coefficient in c.iter_mut().take(m).rev() {
        for (i, row) in work.iter_mut().enumerate().take(m) {
            if let Some(entry) = row.get_mut(i) {
                *entry += last;
            }
        }
        work = product(a, &work, m);
        let trace: f64 = work.iter().enumerate().filter_map(|(i, row)| row.get(i)).sum();
        last = -trace / k;
        *coefficient = last;
        k += 1.0;
    }
    c
}

/// `A B` of the leading `m × m` blocks.
pub(crate) fn product<const N: usize>(a: &Square<N>, b: &Square<N>, m: usize) -> Square<N> {
    let mut out = [[0.0; N]; N];
    for (row, left) in out.iter_mut().zip(a).take(m) {
        for (factor, right) in left.iter().zip(b).take(m) {
            for (entry, value) in row.iter_mut().zip(right) {
                *entry += factor * value;
            }
        }
    }
    out
}
