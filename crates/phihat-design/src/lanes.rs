//! Several linear runs side by side: one value per run.

use core::ops::{Deref, DerefMut};

use phihat_model::Lanes;

/// Runs that are stepped together.
pub(crate) const WIDE: usize = 8;

/// One signal of [`WIDE`] runs.
pub(crate) type Wide = Lane<WIDE>;

/// One signal of `W` runs, where a vector register is filled at once.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(64))]
pub(crate) struct Lane<const W: usize>(pub(crate) [f64; W]);

impl<const W: usize> Lane<W> {
    pub(crate) const ZERO: Self = Self([0.0; W]);

    /// Adds a multiple of another signal.
    ///
    /// Vectors of eight are written out: with the profiles' second level of optimisation the compiler makes none of
    /// loops as short as these. The bits are those of `self + factor x`, run by run.
    #[expect(clippy::inline_always, reason = "one instruction each")]
    #[inline(always)]
    pub(crate) fn add_scaled(&mut self, factor: f64, x: &Self) {
        let (eights, rest) = self.0.as_chunks_mut::<{ Lanes::COUNT }>();
        let (x_eights, x_rest) = x.0.as_chunks::<{ Lanes::COUNT }>();
        let factors = Lanes::from([factor; Lanes::COUNT]);
        for (sum, x) in eights.iter_mut().zip(x_eights) {
            *sum = (Lanes::from(*sum) + factors * Lanes::from(*x)).into();
        }
        for (sum, x) in rest.iter_mut().zip(x_rest) {
            *sum += factor * x;
        }
    }

    /// `factor x + offset`.
    #[expect(clippy::inline_always, reason = "one instruction each")]
    #[inline(always)]
    pub(crate) fn affine(&self, factor: f64, offset: f64) -> Self {
        let mut out = Self([offset; W]);
        out.add_scaled(factor, self);
        out
    }

    /// `self − x`.
    #[expect(clippy::inline_always, reason = "one instruction each")]
    #[inline(always)]
    pub(crate) fn minus(&self, x: &Self) -> Self {
        let mut out = *self;
        out.add_scaled(-1.0, x);
        out
    }

    /// `|self|`.
    #[expect(clippy::inline_always, reason = "one instruction each")]
    #[inline(always)]
    pub(crate) fn size(&self) -> Self {
        Self(core::array::from_fn(|c| self.0[c].abs()))
    }

    /// The larger of both.
    #[expect(clippy::inline_always, reason = "one instruction each")]
    #[inline(always)]
    pub(crate) fn larger(&self, x: &Self) -> Self {
        Self(core::array::from_fn(|c| if self.0[c] < x.0[c] { x.0[c] } else { self.0[c] }))
    }

    /// Run by run.
    #[inline]
    pub(crate) fn of(one: impl FnMut(usize) -> f64) -> Self {
        Self(core::array::from_fn(one))
    }
}

impl<const W: usize> Deref for Lane<W> {
    type Target = [f64; W];

    #[inline]
    fn deref(&self) -> &[f64; W] {
        &self.0
    }
}

impl<const W: usize> DerefMut for Lane<W> {
    #[inline]
    fn deref_mut(&mut self) -> &mut [f64; W] {
        &mut self.0
    }
}

/// Rows of a matrix that are summed together, so that no sum waits for the one before.
const ROWS: usize = 4;

/// `out += m x` for an `out.len() × x.len()` matrix.
#[inline]
pub(crate) fn add_product<const W: usize>(out: &mut [Lane<W>], m: &[f64], x: &[Lane<W>]) {
    let columns = x.len();
    let mut rows = out.chunks_exact_mut(ROWS);
    let mut blocks = m.chunks_exact(ROWS * columns);
    for (out, block) in (&mut rows).zip(&mut blocks) {
        add_rows::<W, ROWS>(out, block, x);
    }
    let (out, m) = (rows.into_remainder(), blocks.remainder());
    match out.len() {
        1 => add_rows::<W, 1>(out, m, x),
        2 => add_rows::<W, 2>(out, m, x),
        3 => add_rows::<W, 3>(out, m, x),
        _ => {}
    }
}

#[inline]
fn add_rows<const W: usize, const R: usize>(out: &mut [Lane<W>], m: &[f64], x: &[Lane<W>]) {
    let columns = x.len();
    let rows: [&[f64]; R] = core::array::from_fn(|r| &m[r * columns..][..columns]);
    let mut sums: [Lane<W>; R] = core::array::from_fn(|r| out[r]);
    for j in 0..columns {
        let x = x[j];
        for r in 0..R {
            sums[r].add_scaled(rows[r][j], &x);
        }
    }
    out.copy_from_slice(&sums);
}

/// `sum += |x|`.
#[inline]
pub(crate) fn add_size<const W: usize>(sum: &mut Lane<W>, x: &Lane<W>) {
    let (eights, rest) = sum.0.as_chunks_mut::<{ Lanes::COUNT }>();
    let (x_eights, x_rest) = x.0.as_chunks::<{ Lanes::COUNT }>();
    for (sum, x) in eights.iter_mut().zip(x_eights) {
        *sum = (Lanes::from(*sum) + Lanes::from(*x).abs()).into();
    }
    for (sum, x) in rest.iter_mut().zip(x_rest) {
        *sum += x.abs();
    }
}

/// `sum +=` at least the mean of `|·|` along a line from `a` to `b`; exactly that where it does not cross zero.
#[inline]
pub(crate) fn add_size_of_line<const W: usize>(sum: &mut Lane<W>, a: &Lane<W>, b: &Lane<W>) {
    for c in 0..W {
        let (x, y, both) = (a[c].abs(), b[c].abs(), (a[c] + b[c]).abs());
        let larger = if x < y { y } else { x };
        sum[c] += 0.5 * if both < larger { larger } else { both };
    }
}

#[cfg(test)]
mod tests {
    use super::{Lane, add_product, add_size_of_line};

    #[test]
    fn products_of_every_height() {
        for rows in 1..=9_u8 {
            let m: Vec<f64> = (0..rows * 3).map(f64::from).collect();
            let x = [[1.0, -1.0], [2.0, 0.5], [-3.0, 4.0]].map(Lane);
            let mut out = vec![Lane([10.0, 20.0]); usize::from(rows)];
            add_product(&mut out, &m, &x);
            for (i, out) in out.iter().enumerate() {
                for c in 0..2 {
                    let sum: f64 = (0..3).map(|j| m[i * 3 + j] * x[j][c]).sum();
                    assert!((out[c] - [10.0, 20.0][c] - sum).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn at_least_the_mean_along_a_line() {
        for i in -20..=20 {
            for j in -20..=20 {
                let (a, b) = (f64::from(i), f64::from(j));
                let mut sum = Lane([0.0]);
                add_size_of_line(&mut sum, &Lane([a]), &Lane([b]));
                let parts = 10_000;
                let at = |k: i32| (a + (b - a) * (f64::from(k) + 0.5) / f64::from(parts)).abs();
                let mean = (0..parts).map(at).sum::<f64>() / f64::from(parts);
                assert!(sum[0] >= mean * (1.0 - 1e-6), "{a} {b}: {} {mean}", sum[0]);
                assert!(a * b < 0.0 || sum[0] <= mean * (1.0 + 1e-6), "{a} {b}: {} {mean}", sum[0]);
            }
        }
        let mut sum = Lane([0.0; 2]);
        add_size_of_line(&mut sum, &Lane([f64::NAN, 1.0]), &Lane([1.0, f64::NAN]));
        assert!(sum.iter().all(|sum| sum.is_nan()));
    }
}
