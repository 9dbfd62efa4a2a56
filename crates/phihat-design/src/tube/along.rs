//! The linear loop along one slice's run, as a sweep reads it.

use super::basis::Slice;
use super::kernel::InputCourse;
use super::nominal::NominalRun;
use super::segments::TubeSegment;
use super::shapes::LinearRun;

/// Everything that a sweep reads.
pub(super) struct Along<'a> {
    pub(super) course: &'a InputCourse<'a>,
    pub(super) nominal: &'a NominalRun,
    pub(super) slice: Option<&'a Slice>,
    /// Shapes of the payload's parameters, per sample `ε, w` and per interval the command, one column each.
    pub(super) shapes: &'a [Option<LinearRun>],
    pub(super) bins: usize,
    /// Remainder of earlier inputs at each segment's start, and its effect in the segment.
    pub(super) segments: &'a [TubeSegment],
}

impl Along<'_> {
    /// Samples of a bin, the last of which is the first of the next.
    pub(super) fn samples(&self, b: usize) -> (usize, usize) {
        let bin = self.course.bin;
        (b * bin, ((b + 1) * bin).min(self.course.intervals.len()))
    }

    /// Largest size of what the payload's parameters do, from what each of them does; 0 without a payload.
    pub(super) fn pushed(&self, unit: impl Fn(&LinearRun) -> f64) -> f64 {
        self.slice.map_or(0.0, |slice| {
            slice.size(&core::array::from_fn(|d| self.shapes[d].as_ref().map_or(0.0, &unit)))
        })
    }
}
