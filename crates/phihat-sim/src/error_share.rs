//! Distance of the measured errors to their certified bounds, sample by sample.

use phihat::{Events, Mode};
use serde::Serialize;

use crate::trace::Trace;

/// Shares of certified bounds that the measured errors of an arm take up, and the largest of each joint so far.
#[derive(Debug, Clone)]
pub struct ErrorShares {
    /// Bound on the measured `|e|` per joint \[rad\]: that on the true one and the largest error of a reading.
    bounds: Vec<f64>,
    largest: Vec<Option<LargestShare>>,
}

/// Largest measured error of a joint beside its bound.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LargestShare {
    /// The joint.
    pub joint: String,
    /// `|e|` over its bound.
    pub share: f64,
    /// Time of the sample \[s\].
    pub at_s: f64,
    /// `|e|`, measured \[rad\] (m for a joint that slides).
    pub error_rad: f64,
    /// Its bound \[rad\] (m).
    pub bound_rad: f64,
}

impl ErrorShares {
    /// Of an arm whose measured errors are within these bounds \[rad\], one per joint in the robot's order.
    pub fn new(bounds: Vec<f64>) -> Self {
        let largest = vec![None; bounds.len()];
        Self { bounds, largest }
    }

    /// Sets [`error_share`](crate::JointTrace::error_share) of the next samples: `|q_measured − q_d|` over its bound
    /// while the supervisor holds or tracks and the sample came (always, where there is no supervisor), else 0.
    pub fn fill(&mut self, trace: &mut Trace) {
        let Trace { t_ns, joints, supervision, .. } = trace;
        let claimed = |k: usize| {
            supervision.as_ref().is_none_or(|own| {
                matches!(own.mode.get(k), Some(Mode::Holding | Mode::Tracking))
                    && own.events.get(k).is_some_and(|events| !events.contains(Events::MISSED))
            })
        };
        for ((joint, bound), largest) in joints.iter_mut().zip(&self.bounds).zip(&mut self.largest)
        {
            joint.error_share.clear();
            for (k, (q, desired)) in joint.q_measured.iter().zip(&joint.q_desired).enumerate() {
                let error = if claimed(k) { (q - desired).abs() } else { 0.0 };
                let share = error / bound;
                joint.error_share.push(share);
                if share > largest.as_ref().map_or(0.0, |before| before.share) {
                    *largest = Some(LargestShare {
                        joint: joint.name.clone(),
                        share,
                        at_s: t_ns.get(k).map_or(0.0, |t_ns| *t_ns as f64 / 1e9),
                        error_rad: error,
                        bound_rad: *bound,
                    });
                }
            }
        }
    }

    /// The largest of each joint that had one.
    pub fn joints(&self) -> impl Iterator<Item = &LargestShare> {
        self.largest.iter().flatten()
    }

    /// The largest of all joints.
    pub fn largest(&self) -> Option<&LargestShare> {
        self.joints().max_by(|a, b| a.share.total_cmp(&b.share))
    }
}
