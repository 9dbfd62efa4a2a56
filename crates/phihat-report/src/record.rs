//! Data that a page is made from.

use phihat_design::{Gains, Verdict};
use phihat_sim::{ContactRecord, Metrics};
use serde::{Deserialize, Serialize};

use crate::band::Envelope;
use crate::drawing::Drawing;
use crate::tube::TubeRun;

/// Everything a page is made from: recorded data only.
#[derive(Debug, Clone, Copy)]
pub struct Record<'a> {
    /// Origin of the run, and the command that makes it again.
    pub run: &'a RunInfo,
    /// The study file as it was read.
    pub study_text: &'a str,
    /// The gains that ran; `None`: another controller did.
    pub gains: Option<&'a Gains>,
    /// Samples that are drawn.
    pub drawing: &'a Drawing,
    /// The figures of the run.
    pub metrics: &'a Metrics,
    /// The run beside the tube that its gains carry.
    pub tube: Option<&'a TubeRun>,
}

/// Measurements of a run, whatever law drove it.
#[derive(Debug, Clone, Copy)]
pub struct RunMeasurements<'a> {
    /// Samples that are drawn.
    pub drawing: &'a Drawing,
    /// Its figures.
    pub metrics: &'a Metrics,
    /// Bounds that were stated before it.
    pub envelope: Option<Envelope<'a>>,
}

impl<'a> Record<'a> {
    pub(crate) fn measured(&self) -> RunMeasurements<'a> {
        let own = self.gains.filter(|gains| gains.study_sha256 == self.run.study_sha256);
        let certificate = own.and_then(|gains| gains.certificate.as_ref());
        let tube = certificate.and_then(|all| all.tube.as_ref()).map(Envelope::Tube);
        let class = certificate.and_then(|all| all.class.as_deref()).map(Envelope::Class);
        RunMeasurements { drawing: self.drawing, metrics: self.metrics, envelope: tube.or(class) }
    }
}

/// Origin of a run: what ran, where, under which seed.
#[derive(Serialize, Deserialize, Clone, Debug, PartialEq)]
pub struct RunInfo {
    /// Name of the study.
    pub study: String,
    /// The study's one line for people.
    pub title: String,
    /// SHA-256 of the study's text, hexadecimal.
    pub study_sha256: String,
    /// Seed of everything random.
    pub seed: u64,
    /// Name of the robot.
    pub robot: String,
    /// The robot in words.
    pub robot_description: String,
    /// Source of the robot's numbers.
    pub robot_provenance: String,
    /// Version of phihat.
    pub phihat_version: String,
    /// Compiler or target that built it.
    pub toolchain: String,
    /// Form of the law: `observer`, `literal` or `positions`; `outside`: another controller's.
    pub form: String,
    /// Loop rate \[Hz\].
    pub rate_hz: f64,
    /// Delay from sample to acting torque \[samples\].
    pub delay_samples: u32,
    /// Contents of the world: label, and value with its unit.
    pub world: Vec<(String, String)>,
    /// The command that makes this page again.
    pub command: String,
    /// Warnings to read before believing the figures.
    pub warnings: Vec<String>,
    /// Bound on the error as it was checked for this run; `None`: the certificate was not checked again.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bound: Option<RecordedBound>,
    /// Contacts and payload; `None`: they were not watched.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<ContactRecord>,
}

impl RunInfo {
    /// The other end of a link, of a drive.
    pub(crate) fn driven(&self) -> Option<&str> {
        self.world.iter().find(|(label, _)| label == "driven").map(|(_, value)| value.as_str())
    }

    /// Returns true if `φ` was recorded as a torque of the arm; false of a drive of a robot, where it is the
    /// difference of noisy readings.
    pub fn knows_phi(&self) -> bool {
        self.driven().is_none_or(|on| on.ends_with("sim"))
    }
}

/// Bound on the error of a run with its standing, as a check that shares no code with its finder left it.
#[derive(Serialize, Deserialize, Clone, Debug, PartialEq)]
pub struct RecordedBound {
    /// Standing of the bound.
    pub verdict: Verdict,
    /// Bound on `|e|` of each joint \[rad\] ([m] for a prismatic joint), the wider one of two derivations; empty: there
    /// is none.
    pub error_bound_rad: Vec<f64>,
    /// Scope of the bound, or why there is none.
    pub words: String,
}
