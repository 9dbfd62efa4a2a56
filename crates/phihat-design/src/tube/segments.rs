//! Remainder of inputs from long ago, segment by segment of the run.

use phihat_certificate::extremes::larger;

use super::kernel::InputCourse;
use phihat_certificate::parallel::parallel;

/// Bins of a segment whose rows are bounded together.
const BLOCK: usize = 4;

/// Response in a segment to a state that is left over at its start, by each of its numbers, of size 1 there.
#[derive(Debug, Clone)]
pub(super) struct TubeSegment {
    /// Bin that it begins with, and the one after its last.
    bins: (usize, usize),
    pub(super) from: usize,
    /// `[block][row][state]`: the largest value of every row in a block of bins and as far around as
    /// responses are moved.
    around: Vec<Vec<f64>>,
    /// The same within reach of its start, and of its end.
    first: Vec<f64>,
    last: Vec<f64>,
    /// `[state][state]`
    left: Vec<f64>,
    /// Bins that responses are moved by at most.
    reach: usize,
}

/// Responses to a state left at the start of each segment, moved by so many bins at most.
pub(super) fn segments(
    course: &InputCourse<'_>,
    (length, reach): (usize, usize),
    threads: usize,
) -> Vec<TubeSegment> {
    let samples = course.intervals.len();
    let starts: Vec<usize> = (length..samples).step_by(length).collect();
    parallel(&starts, threads, |from| {
        let to = (from + length).min(samples);
        let (blocks, left) = course.segment((from, to), BLOCK * course.bin);
        let bins = (from / course.bin, to.div_ceil(course.bin));
        let near = |k: usize| -> Vec<f64> {
            let low = (k * BLOCK).saturating_sub(reach) / BLOCK;
            let high = ((k + 1) * BLOCK - 1 + reach) / BLOCK;
            hull(&blocks[low..=high.min(blocks.len() - 1)])
        };
        let count = blocks.len();
        TubeSegment {
            bins,
            from,
            around: (0..count).map(near).collect(),
            first: hull(&blocks[..=(reach / BLOCK).min(count - 1)]),
            last: hull(&blocks[count.saturating_sub(reach / BLOCK + 2)..]),
            left,
            reach,
        }
    })
}

/// The largest of each.
fn hull(all: &[Vec<f64>]) -> Vec<f64> {
    let mut most = all[0].clone();
    for one in &all[1..] {
        most.iter_mut().zip(one).for_each(|(most, one)| *most = larger(*most, *one));
    }
    most
}

/// `m x`, row after row, for a matrix without negative entries.
fn add_times(out: &mut [f64], matrix: &[f64], x: &[f64]) {
    for (out, row) in out.iter_mut().zip(matrix.chunks_exact(x.len())) {
        *out += row.iter().zip(x).map(|(m, x)| m * x).sum::<f64>();
    }
}

impl TubeSegment {
    /// Remainder at its end of a state at its start.
    pub(super) fn left_of(&self, state: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; state.len()];
        add_times(&mut out, &self.left, state);
        out
    }

    /// Adds what a state at its start does in one of its bins.
    pub(super) fn add(&self, out: &mut [f64], b: usize, state: &[f64]) {
        add_times(out, &self.around[(b - self.bins.0) / BLOCK], state);
    }

    /// Returns true if it acts in a bin before it, its responses being moved.
    pub(super) fn reaches(&self, b: usize) -> bool {
        b + self.reach >= self.bins.0
    }

    /// Adds what a state at its start does there.
    pub(super) fn add_before(&self, out: &mut [f64], state: &[f64]) {
        add_times(out, &self.first, state);
    }

    /// Likewise in a bin after it.
    pub(super) fn add_after(&self, out: &mut [f64], b: usize, state: &[f64]) {
        if b < self.bins.1 + self.reach {
            add_times(out, &self.last, state);
        }
    }
}
