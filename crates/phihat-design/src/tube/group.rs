//! Data shared by neighbouring bins: one launch's sums, second derivatives, and how far matrices move.

use phihat_model::Model;

use super::along::Along;
use super::basis::Direction;
use super::kernel::Kernel;
use super::linear::middle;
use super::moved::Moved;
use super::tensors::{SliceModels, Tensors};
use super::within::Within;

/// Data shared by one group of bins.
pub(super) struct BinGroup {
    /// The first of its bins, and the one after the last.
    pub(super) bins: (usize, usize),
    pub(super) kernel: Kernel,
    pub(super) tensors: Tensors,
    /// Differences of `M`, `D`, `K` from those of the kernel's launch, entry by entry; and of `J`, `6 × n`.
    pub(super) moved: [Vec<f64>; 3],
    pub(super) moved_rate: Vec<f64>,
    pub(super) moved_jacobian: Vec<f64>,
    /// `|J̇|`.
    pub(super) jacobian_rate: Vec<f64>,
    /// Changes over a sample of what linear runs hold, bin after bin.
    pub(super) within: Vec<Within>,
}

/// Data from which groups are made.
pub(super) struct Groups<'a> {
    pub(super) along: &'a Along<'a>,
    pub(super) moved: &'a Moved,
    /// The arm with the slice's smallest and largest mass.
    pub(super) ends: &'a [Model],
    pub(super) directions: &'a [Option<Direction>],
    /// Bins per group.
    pub(super) bins: usize,
    /// Samples from one look at the second derivatives to the next.
    pub(super) looks: usize,
    /// Samples of a segment.
    pub(super) length: usize,
}

impl Groups<'_> {
    /// Number of groups of the run.
    pub(super) fn count(&self) -> usize {
        self.along.bins.div_ceil(self.bins)
    }

    pub(super) fn group(&self, g: usize) -> BinGroup {
        let of = |rows: &[Vec<f64>]| rows.get(g).cloned().unwrap_or_default();
        let [m, d, k] = &self.moved.matrices;
        let bins = (g * self.bins, ((g + 1) * self.bins).min(self.along.bins));
        let within = |b: usize| Within::of(self.along, self.along.samples(b));
        BinGroup {
            bins,
            kernel: self.kernel(g),
            tensors: self.tensors(g),
            moved: [of(m), of(d), of(k)],
            moved_rate: of(&self.moved.rate),
            moved_jacobian: of(&self.moved.jacobian),
            jacobian_rate: of(&self.moved.jacobian_rate),
            within: (bins.0..bins.1).map(within).collect(),
        }
    }

    /// Sums of a launch in the group's middle, to the end of a segment.
    fn kernel(&self, g: usize) -> Kernel {
        let (bins, bin) = (self.bins, self.along.course.bin);
        let launch = (g * bins + bins / 2) * bin;
        let boundary = (launch + self.length).div_ceil(self.length) * self.length;
        let end = boundary.min((self.along.bins + bins + 2) * bin);
        self.along.course.kernel(launch, end)
    }

    /// The largest second derivatives that looks along the group find.
    fn tensors(&self, g: usize) -> Tensors {
        let Along { course, nominal, slice, .. } = *self.along;
        let (bin, samples) = (course.bin, course.intervals.len());
        let mut looked = SliceModels::new(self.ends, self.directions);
        let first = g * self.bins * bin + self.looks / 2;
        let mut at = |k: usize| looked.at(&middle(course.scene, nominal, k), slice);
        let mut tensors = at(first.min(samples - 1));
        let end = ((g + 1) * self.bins * bin).min(samples);
        for k in (first + self.looks..end).step_by(self.looks) {
            tensors.widen(&at(k));
        }
        tensors
    }
}
