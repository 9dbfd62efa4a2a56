//! Several linear runs side by side: one value per run.

/// Runs that are stepped together.
pub(super) const WIDE: usize = 8;

/// One signal of `W` runs.
pub(super) type Lane<const W: usize> = [f64; W];

/// `out += Σ_j row_j x_j`.
#[inline]
pub(super) fn add_row<const W: usize>(out: &mut Lane<W>, row: &[f64], x: &[Lane<W>]) {
    for (factor, x) in row.iter().zip(x) {
        for c in 0..W {
            out[c] += factor * x[c];
        }
    }
}
