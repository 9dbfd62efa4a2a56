//! Structure of a segment: a branch that arms share, or a product that need not be computed.

use crate::description::JointMotion;
use crate::segment::Segment;

/// Rotation of the first screw.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Tilt {
    /// Not at all.
    Level,
    /// By a quarter turn.
    Up,
    /// By a quarter turn the other way.
    Down,
    /// By some angle.
    Any,
}

/// Structure of a segment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct SegmentShape {
    pub(crate) tilt: Tilt,
    /// True if there is an `a`.
    pub(crate) reaches: bool,
    /// True if there is a `d`, constant or not.
    pub(crate) slides: bool,
}

impl SegmentShape {
    /// Common structure of the same segment of several arms.
    pub(crate) fn shared(segments: &[&Segment]) -> Self {
        let turned = |cos: f64, sin: f64| {
            segments.iter().all(|s| {
                (s.cos_alpha.to_bits(), s.sin_alpha.to_bits()) == (cos.to_bits(), sin.to_bits())
            })
        };
        let tilt = match () {
            () if turned(1.0, 0.0) => Tilt::Level,
            () if turned(0.0, 1.0) => Tilt::Up,
            () if turned(0.0, -1.0) => Tilt::Down,
            () => Tilt::Any,
        };
        let any = |of: &dyn Fn(&Segment) -> f64| !segments.iter().all(|s| of(s).abs() <= 0.0);
        Self {
            tilt,
            reaches: any(&|s| s.a),
            slides: any(&|s| s.d) || segments.iter().any(|s| s.motion == JointMotion::Prismatic),
        }
    }
}
