//! The linear loop along one slice's run, as a sweep reads it.

use super::basis::Slice;
use super::kernel::Course;
use super::nominal::Nominal;
use super::segments::Segment;
use super::shapes::Shape;

/// Everything that a sweep reads.
pub(super) struct Along<'a> {
    pub(super) course: &'a Course<'a>,
    pub(super) nominal: &'a Nominal,
    pub(super) slice: Option<&'a Slice>,
    /// Shapes of the payload's parameters, per sample `ε, w` and per interval the command, one column each.
    pub(super) shapes: &'a [Option<Shape>],
    pub(super) bins: usize,
    /// What is left at each segment's start of inputs before, and does in it.
    pub(super) segments: &'a [Segment],
}
