//! What is left of inputs from long ago, segment by segment of the run.

use super::kernel::{Course, Scale};
use crate::parallel::parallel;

/// What a state left over at a segment's start does in it.
#[derive(Debug, Clone)]
pub(super) struct Segment {
    pub(super) from: usize,
    pub(super) rows: Vec<f64>,
    pub(super) left: f64,
}

/// What a state left at the start of each segment does.
pub(super) fn segments(
    course: &Course<'_>,
    length: usize,
    scale: &Scale,
    threads: usize,
) -> Vec<Segment> {
    let samples = course.intervals.len();
    let starts: Vec<usize> = (length..samples).step_by(length).collect();
    parallel(&starts, threads, |from| {
        let to = (from + length).min(samples);
        let (rows, left) = course.segment(from, to, scale);
        Segment { from, rows, left }
    })
}
