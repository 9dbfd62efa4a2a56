//! The run beside the tube that was promised for it.

use phihat_design::{Gains, JointRun, Left, Tube, TubeKept, TubeWatch};
use phihat_sim::{JointTrace, Trace};
use serde::Serialize;

use crate::kit::number::{number, stated};
use crate::kit::text::line;
use crate::kit::unit_of;
use crate::promise::no_promise;

/// A run against its tube.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TubeRun {
    /// Figures side by side, and where the run left.
    #[serde(flatten)]
    pub kept: TubeKept,
    /// Why the tube is no promise for this run; `None`: it is one.
    pub no_promise: Option<String>,
    /// True if the joint that left is prismatic.
    #[serde(skip)]
    pub slides: bool,
}

/// A run that is held against the tube that its gains carry, as its record goes by.
#[derive(Debug, Clone)]
pub struct TubeSeen<'a> {
    gains: &'a Gains,
    tube: &'a Tube,
    watch: TubeWatch,
}

impl<'a> TubeSeen<'a> {
    /// A tube to watch, before the first sample; `None`: the gains carry no tube for so many joints.
    #[must_use]
    pub fn new(gains: &'a Gains, joints: usize) -> Option<Self> {
        let tube = gains.certificate.as_ref()?.tube.as_ref()?;
        Some(Self { gains, tube, watch: tube.watch(joints)? })
    }

    /// Compares the next samples with the tube.
    pub fn block(&mut self, trace: &Trace) {
        let limited = |joint: &JointTrace| -> u64 {
            let limited = joint.saturated.iter().zip(&joint.rate_limited);
            limited.filter(|(torque, rate)| **torque || **rate).count() as u64
        };
        let joints = trace.joints.iter().map(|joint| JointRun {
            e: &joint.e,
            de: &joint.de,
            tau_command: &joint.tau_command,
            limited_samples: limited(joint),
        });
        let runs: Vec<_> = joints.collect();
        self.watch.block(self.tube, &trace.t_ns, &runs);
    }

    /// The run against its tube, after its last block, in a run of a study with this SHA-256.
    #[must_use]
    pub fn run(self, study_sha256: &str) -> TubeRun {
        let no_promise = no_promise(self.gains, study_sha256, true);
        let kept = self.watch.kept(self.tube);
        let slides = kept.left.as_ref().is_some_and(|left| self.gains.slides(&left.joint));
        TubeRun { kept, no_promise, slides }
    }
}

impl TubeRun {
    /// The first thing that the promise excludes and that happened all the same.
    pub fn broken(&self) -> Option<&Left> {
        self.kept.left.as_ref().filter(|_| self.no_promise.is_none())
    }

    /// Result of the run against its tube, in one sentence.
    pub fn sentence(&self) -> String {
        match (&self.kept.left, &self.no_promise) {
            (None, None) => {
                "every sample of every joint stayed inside its tube, from t = 0".to_owned()
            }
            (None, Some(why)) => {
                format!("inside the tube, which is no promise for this run: {}", line(why))
            }
            (Some(left), None) => {
                format!(
                    "the certificate is broken: please report. {}",
                    left_words(left, self.slides)
                )
            }
            (Some(left), Some(why)) => {
                format!(
                    "{}; it is no promise for this run: {}",
                    left_words(left, self.slides),
                    line(why)
                )
            }
        }
    }
}

/// "joint2 left the tube at t = 0.25 s: e = 4.1 mrad, beyond 3.9 mrad"
fn left_words(left: &Left, slides: bool) -> String {
    let (symbol, unit, si) = left.quantity.words();
    let unit = unit_of(unit, slides);
    let (value, bound) = (number(left.value / si), number(left.bound / si));
    let t = stated(left.t_s);
    format!(
        "{} left the tube at t = {t} s: {symbol} = {value} {unit}, beyond {bound} {unit}",
        line(&left.joint)
    )
}
