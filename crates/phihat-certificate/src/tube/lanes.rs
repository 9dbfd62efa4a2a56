//! Sums over many rows at once, in lanes.

/// Rows that are summed together; the number of rows is a multiple of it.
pub(super) const WIDE: usize = 8;

/// Sums of one output, and where its terms are: factor and row.
pub(super) type LaneColumn<'a> = &'a [(usize, f64)];

/// `out_s = Σ_t flow_ts from_t`, each entry a row; `flow` has as many columns as `out` has rows.
pub(super) fn combine(flow: &[f64], from: &[f64], rows: usize, out: &mut [f64]) {
    let columns = out.len() / rows;
    let mut s = 0;
    while s < columns {
        let four = columns - s >= 4;
        for at in (0..rows).step_by(WIDE) {
            if four {
                sums::<4>((flow, columns, s), (from, rows, at), out);
            } else {
                sums::<1>((flow, columns, s), (from, rows, at), out);
            }
        }
        s += if four { 4 } else { 1 };
    }
}

/// `S` outputs from column `s` on, over the lanes from `at` on: independent sums.
fn sums<const S: usize>(
    (flow, columns, s): (&[f64], usize, usize),
    (from, rows, at): (&[f64], usize, usize),
    out: &mut [f64],
) {
    let mut sum = [[0.0; WIDE]; S];
    for (factors, from) in flow.chunks_exact(columns).zip(from.chunks_exact(rows)) {
        let (factors, from) = (&factors[s..s + S], &from[at..at + WIDE]);
        for (sum, factor) in sum.iter_mut().zip(factors) {
            for (sum, from) in sum.iter_mut().zip(from) {
                *sum += factor * from;
            }
        }
    }
    for (c, sum) in sum.iter().enumerate() {
        out[(s + c) * rows + at..][..WIDE].copy_from_slice(sum);
    }
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
        for at in (0..rows).step_by(WIDE) {
            let mut sum = [0.0; WIDE];
            for (row, factor) in terms {
                let from = &from[row * rows + at..][..WIDE];
                for (sum, from) in sum.iter_mut().zip(from) {
                    *sum += factor * from;
                }
            }
            into[at..at + WIDE].copy_from_slice(&sum);
        }
    }
}
