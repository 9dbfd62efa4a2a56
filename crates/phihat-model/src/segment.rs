//! One body of the compiled form.

use crate::description::JointMotion;

/// One body of the compiled form: how it sits on its parent, and its matter in its own frame.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Segment {
    pub(crate) motion: JointMotion,
    /// Coordinate index; meaningless for [`Motion::Fixed`].
    pub(crate) joint: usize,
    /// Index of the parent segment; `None`: the base.
    pub(crate) parent: Option<usize>,
    /// True if some segment hangs on this one; the first that does is the next in order.
    pub(crate) bears: bool,
    /// True if more than one segment does.
    pub(crate) forks: bool,
    /// Coordinates of this segment and all that hangs on it.
    pub(crate) coordinates: (usize, usize),
    pub(crate) cos_alpha: f64,
    pub(crate) sin_alpha: f64,
    pub(crate) a: f64,
    /// `d₀` \[m\].
    pub(crate) d: f64,
    pub(crate) m: f64,
    pub(crate) h: [f64; 3],
    /// Inertia about the origin: `xx, yy, zz, xy, xz, yz`.
    pub(crate) i: [f64; 6],
    /// Second moments `½ tr(I) 1 − I`, in the same order.
    pub(crate) sigma: [f64; 6],
}
