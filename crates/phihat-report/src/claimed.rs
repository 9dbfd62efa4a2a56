//! Bound of a run as its gains claim it: around one motion, or for every motion of a class.

use crate::class::ClassRun;
use crate::record::Record;
use crate::tube::TubeRun;

/// Bound that gains claim for a run, and what the run makes of it.
#[derive(Debug, Clone, PartialEq)]
pub struct ClaimedBound {
    /// True if the claim is about this run.
    pub promised: bool,
    /// True if the run left it all the same.
    pub broken: bool,
    /// Result of the run against the bound, in a sentence without its full stop.
    pub sentence: String,
    /// Bound on `|e|` \[rad, m\] per joint: in the steady part around one motion, always for a class.
    pub error_bound_rad: Vec<f64>,
    /// Motions of the class; `None`: the bound is about the motion of the run.
    pub motions: Option<String>,
}

/// The bound that the gains of a run claim for it; `None`: they claim none for an arm as a whole.
pub fn claimed_bound(record: &Record<'_>) -> Option<ClaimedBound> {
    let certificate = record.gains?.certificate.as_ref()?;
    let joints = 0..record.metrics.joints.len();
    let bounds = joints.map(|i| Some(certificate.error_bound(i)?.error_bound_rad));
    let error_bound_rad = bounds.collect::<Option<Vec<f64>>>()?;
    if let Some(run) = record.tube {
        let (promised, broken) = (run.no_promise.is_none(), run.broken().is_some());
        let sentence = TubeRun::sentence(run);
        return Some(ClaimedBound { promised, broken, sentence, error_bound_rad, motions: None });
    }
    let run = ClassRun::of(record)?;
    let (promised, broken) = (run.no_promise().is_none(), run.broken());
    let (sentence, motions) = (run.sentence(), Some(run.limits()));
    Some(ClaimedBound { promised, broken, sentence, error_bound_rad, motions })
}
