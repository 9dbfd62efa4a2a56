//! Sums over many rows at once, in lanes.

use phihat_model::{Lanes, Scalar as _};

/// Rows that are summed together; the number of rows is a multiple of it.
pub(super) const WIDE: usize = 8;

/// Sums of one output, and where its terms are: factor and row.
pub(super) type LaneColumn<'a> = &'a [(usize, f64)];

/// `out_s = Σ_t flow_ts from_t`, each entry a row; `flow` has as many columns as `out` has rows.
pub(super) fn combine(flow: &[f64], from: &[f64], rows: usize, out: &mut [f64]) {
    let columns = out.len() / rows;
    out.fill(0.0);
    add_products((flow, columns), (from, rows), out);
}

/// Adds `Σ_t flow_ts from_t` to each row `s` of `out`, `flow` with a stride from one `t` to the next.
pub(super) fn add_products(
    (flow, stride): (&[f64], usize),
    (from, rows): (&[f64], usize),
    out: &mut [f64],
) {
    let columns = out.len() / rows;
    let mut s = 0;
    while s < columns {
        let four = columns - s >= 4;
        for at in (0..rows).step_by(WIDE) {
            if four {
                sums::<4>((flow, stride, s), (from, rows, at), out);
            } else {
                sums::<1>((flow, stride, s), (from, rows, at), out);
            }
        }
        s += if four { 4 } else { 1 };
    }
}

/// `S` outputs from column `s` on, over the lanes from `at` on: independent sums.
fn sums<const S: usize>(
    (flow, stride, s): (&[f64], usize, usize),
    (from, rows, at): (&[f64], usize, usize),
    out: &mut [f64],
) {
    let mut sum: [Lanes; S] = core::array::from_fn(|c| eight(out, (s + c) * rows + at));
    for (factors, from) in flow.chunks_exact(stride).zip(from.chunks_exact(rows)) {
        let Some(factors) = factors.get(s..).and_then(|row| row.first_chunk::<S>()) else {
            continue;
        };
        let from = eight(from, at);
        for (sum, factor) in sum.iter_mut().zip(factors) {
            *sum += from * Lanes::splat(*factor);
        }
    }
    for (c, sum) in sum.iter().enumerate() {
        put(*sum, out, (s + c) * rows + at);
    }
}

/// Eight rows of one entry, from a row on.
#[inline]
pub(super) fn eight(entry: &[f64], at: usize) -> Lanes {
    let eight = entry.get(at..).and_then(|rows| rows.first_chunk::<WIDE>());
    eight.map_or_else(Lanes::default, |rows| Lanes::from(*rows))
}

/// Writes eight rows of one entry, from a row on.
#[inline]
pub(super) fn put(eight: Lanes, entry: &mut [f64], at: usize) {
    entry[at..at + WIDE].copy_from_slice(&<[f64; WIDE]>::from(eight));
}

/// Sparse sums: a row per column, the last two into `read`.
pub(super) fn gather<'a>(
    columns: impl Iterator<Item = LaneColumn<'a>>,
    from: &[f64],
    rows: usize,
    (out, read): (&mut [f64], &mut [f64]),
) {
    let into = out.chunks_exact_mut(rows).chain(read.chunks_exact_mut(rows));
    for (terms, into) in columns.zip(into) {
        let mut blocks = into.chunks_exact_mut(4 * WIDE);
        let mut at = 0;
        for block in &mut blocks {
            gathered::<4>(terms, (from, rows, at), block);
            at += 4 * WIDE;
        }
        for block in blocks.into_remainder().chunks_exact_mut(WIDE) {
            gathered::<1>(terms, (from, rows, at), block);
            at += WIDE;
        }
    }
}

/// One sparse sum over `S` lanes from `at` on.
fn gathered<const S: usize>(
    terms: LaneColumn<'_>,
    (from, rows, at): (&[f64], usize, usize),
    into: &mut [f64],
) {
    let mut sum = [Lanes::default(); S];
    for (row, factor) in terms {
        let first = row * rows + at;
        let Some(from) = from.get(first..first + S * WIDE) else { continue };
        for (sum, from) in sum.iter_mut().zip(from.as_chunks::<WIDE>().0) {
            *sum += Lanes::from(*from) * Lanes::splat(*factor);
        }
    }
    for (sum, into) in sum.into_iter().zip(into.as_chunks_mut::<WIDE>().0) {
        *into = sum.into();
    }
}
