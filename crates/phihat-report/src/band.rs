//! Bounds around a run as a picture: a band of steps around a curve.

use phihat_design::{ClassBound, Tube, TubeJoint};

use crate::kit::number::rounded;

/// Bounds around a run, stated before it.
#[derive(Debug, Clone, Copy)]
pub enum Envelope<'a> {
    /// Those of its own motion.
    Tube(&'a Tube),
    /// Those of every motion of its class.
    Class(&'a ClassBound),
}

/// Parts of an envelope around one curve.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EnvelopeParts {
    /// Ends of a tube, per bin.
    pub tube: Option<BandEnds>,
    /// Level of a class bound, per joint.
    pub class: Option<fn(&ClassBound) -> &[f64]>,
}

impl Envelope<'_> {
    /// Name in a key.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Tube(_) => "tube",
            Self::Class(_) => "class bound",
        }
    }

    /// Band of a joint, up to the end of the run \[s\], in the units of its chart.
    pub(crate) fn band(
        self,
        parts: &EnvelopeParts,
        joint: usize,
        (end_s, scale): (f64, f64),
    ) -> Option<CurveBand> {
        match self {
            Self::Tube(tube) => {
                Some(CurveBand::of_tube(tube, tube.joints.get(joint)?, parts.tube?, scale))
            }
            Self::Class(class) => {
                let level = rounded(scale * parts.class?(class).get(joint)?);
                let (low, high) = (vec![-level], vec![level]);
                Some(CurveBand { t: vec![0.0, end_s], low, high }).filter(|_| level.is_finite())
            }
        }
    }
}

/// Steps kept of a tube: what is drawn is never narrower than the tube.
const STEPS_MAX: usize = 400;

/// A band, in the units of its chart: step `k` reaches from `t[k]` to `t[k + 1]` \[s\].
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct CurveBand {
    /// One entry more than there are steps.
    pub t: Vec<f64>,
    pub low: Vec<f64>,
    pub high: Vec<f64>,
}

/// Least and largest value of one quantity of a tube, per bin.
pub(crate) type BandEnds = fn(&TubeJoint) -> (&[f64], &[f64]);

impl CurveBand {
    /// A joint's band in a tube; neighbouring bins are put together where there are many, by the widest of them.
    fn of_tube(tube: &Tube, joint: &TubeJoint, ends: BandEnds, scale: f64) -> Self {
        let (low, high) = ends(joint);
        let bins = tube.bins();
        let each = bins.div_ceil(STEPS_MAX).max(1);
        let mut band = Self::default();
        for first in (0..bins).step_by(each) {
            let last = (first + each).min(bins);
            let least = low[first..last].iter().copied().fold(f64::INFINITY, f64::min);
            let most = high[first..last].iter().copied().fold(f64::NEG_INFINITY, f64::max);
            band.t.push(rounded(tube.start_of(first)));
            band.low.push(rounded(scale * least));
            band.high.push(rounded(scale * most));
        }
        band.t.push(rounded(tube.start_of(bins)));
        band
    }

    /// The steps that reach into a span of time, each `(from, to, low, high)`, cut to it.
    pub(crate) fn within(&self, (start, end): (f64, f64)) -> Vec<(f64, f64, f64, f64)> {
        let steps = self.t.windows(2).zip(self.low.iter().zip(&self.high));
        let cut = steps.map(|(t, (low, high))| (t[0].max(start), t[1].min(end), *low, *high));
        cut.filter(|(from, to, ..)| from < to).collect()
    }
}

/// `e`.
pub(crate) fn error(joint: &TubeJoint) -> (&[f64], &[f64]) {
    (&joint.error_low_rad, &joint.error_high_rad)
}

/// `ė`.
pub(crate) fn velocity(joint: &TubeJoint) -> (&[f64], &[f64]) {
    (&joint.velocity_low_rad_s, &joint.velocity_high_rad_s)
}
