//! Changes of the linear run's matrices between a launch and where its responses are used.

use phihat_certificate::extremes::{hull, larger, smaller};

use super::kernel::InputCourse;

/// Largest moves of the matrices, entry by entry, one row per group of bins.
pub(super) struct Moved {
    /// Of `M`, `D`, `K`.
    pub(super) matrices: [Vec<Vec<f64>>; 3],
    /// Of `Ṁ`.
    pub(super) rate: Vec<Vec<f64>>,
    /// Of `J`.
    pub(super) jacobian: Vec<Vec<f64>>,
    /// `|J̇|`.
    pub(super) jacobian_rate: Vec<Vec<f64>>,
}

impl Moved {
    pub(super) fn new(course: &InputCourse<'_>, group: usize) -> Self {
        let n = course.scene.n;
        let blocks = Blocks::new(course, group);
        let (samples, square) = (blocks.samples, n * n);
        let at = |k: usize| &course.intervals[k].derivatives;
        let t = course.scene.period;
        let twist = course.inputs().twist;
        let m = blocks.moves(square, |k, e| at(k).m[e]);
        let d = blocks.moves(square, |k, e| at(k).d[e]);
        let k = blocks.moves(square, |k, e| at(k).k[e]);
        let rate = blocks.moves(square, |k, e| {
            let next = (k + 1).min(samples - 1);
            let before = next.saturating_sub(1);
            (at(next).m[e] - at(before).m[e]) / t
        });
        let jacobian = blocks.moves(twist * n, |k, e| course.jacobians[k][e]);
        let mut jacobian_rate = vec![vec![0.0_f64; twist * n]; blocks.groups];
        if twist > 0 {
            for k in 1..samples {
                let g = k / (group * course.bin);
                for e in 0..twist * n {
                    let rate = (course.jacobians[k][e] - course.jacobians[k - 1][e]).abs() / t;
                    jacobian_rate[g][e] = larger(jacobian_rate[g][e], rate);
                }
            }
        }
        Self { matrices: [m, d, k], rate, jacobian, jacobian_rate }
    }
}

/// Blocks of a bin each, in groups.
struct Blocks {
    samples: usize,
    bin: usize,
    group: usize,
    groups: usize,
    /// Blocks around one that responses of its group reach.
    window: usize,
}

impl Blocks {
    fn new(course: &InputCourse<'_>, group: usize) -> Self {
        let (samples, bin) = (course.intervals.len(), course.bin);
        let reach = group * bin / 2 + bin + 1;
        let groups = samples.div_ceil(group * bin);
        Self { samples, bin, group, groups, window: reach.div_ceil(bin) }
    }

    /// Largest move of every entry `value(sample, entry)` per group: largest and smallest over blocks, then over
    /// windows around each block.
    fn moves(&self, entries: usize, value: impl Fn(usize, usize) -> f64) -> Vec<Vec<f64>> {
        let blocks = self.samples.div_ceil(self.bin);
        let mut low = vec![vec![f64::INFINITY; entries]; blocks];
        let mut high = vec![vec![f64::NEG_INFINITY; entries]; blocks];
        for k in 0..self.samples {
            let block = k / self.bin;
            for e in 0..entries {
                let x = value(k, e);
                low[block][e] = smaller(low[block][e], x);
                high[block][e] = larger(high[block][e], x);
            }
        }
        let mut out = vec![vec![0.0_f64; entries]; self.groups];
        for block in 0..blocks {
            let g = block / self.group;
            let around = block.saturating_sub(self.window)..(block + self.window + 1).min(blocks);
            for e in 0..entries {
                let (bottom, top) = hull(around.clone().map(|b| (low[b][e], high[b][e])));
                // Either way from the block's own values.
                let up = top - low[block][e];
                let down = high[block][e] - bottom;
                out[g][e] = larger(out[g][e], larger(up, down));
            }
        }
        out
    }
}
