//! A study under a controller of somebody else's.

use std::path::Path;

use phihat_design::requested_gains;
use phihat_sim::{Stepped, Trace};
use phihat_study::Study;

use crate::design;
use crate::error::SessionError;
use crate::layout::OUTSIDE;
use crate::observer::{RunFigures, RunObserver};
use crate::record::Done;
use crate::session::run_info;
use crate::words;

/// A study's run whose torques somebody else tells, sample by sample. The study's supervisor, gains and design are not
/// asked; its limits, delay, sensors, faults and bounds are the same as for phihat's law.
#[derive(Debug)]
pub struct OutsideRun {
    study: Box<Study>,
    command: String,
    warnings: Vec<String>,
    /// Nominal inertia per joint \[kg·m²\] that the record's φ is about.
    pub inertia: Vec<f64>,
    /// The run: what was sensed and wanted, and the torque to be told.
    pub run: Stepped,
}

impl OutsideRun {
    /// Begins a run. `command` says in the record what drove it; `path` stands for the study in messages. Without an
    /// `inertia` \[kg·m²\] per joint it is that of the gains which the study states, else the middle of the arm's range.
    ///
    /// # Errors
    ///
    /// [`SessionError`]: the study cannot be simulated.
    pub fn new(
        mut study: Box<Study>,
        path: &Path,
        inertia: Option<Vec<f64>>,
        command: String,
    ) -> Result<Self, SessionError> {
        let stated = requested_gains(&study);
        let stated = stated.map(|gains| gains.joints.iter().map(|j| j.inertia_kg_m2).collect());
        let inertia = match inertia.or(stated) {
            Some(inertia) => inertia,
            None => design::arm(&study, path)?.nominal(),
        };
        let mut warnings = study.robot.warnings.clone();
        let lacks = |what: &str| format!("another controller drove this run: {what}");
        if std::mem::take(&mut study.sensor.velocity_filter_designed) {
            study.sensor.velocity_filter_hz = None;
            warnings.push(lacks("the velocity filter that a design would have chosen is left out"));
        }
        if study.supervisor.is_some() {
            warnings.push(lacks("the study's supervisor is not in it"));
        }
        let run = Stepped::new(&study, &inertia).map_err(|e| SessionError::at(path, e))?;
        Ok(Self { study, command, warnings, inertia, run })
    }

    /// The study.
    pub fn study(&self) -> &Study {
        &self.study
    }

    /// The record of a run that is over, with every signal of every joint; `None`: samples are still to come.
    pub fn end(self) -> Option<(Done, Trace)> {
        let Self { study, command, mut warnings, run, .. } = self;
        if !run.is_over() {
            return None;
        }
        let (trace, ended) = run.end();
        warnings.extend(ended.abort.as_ref().map(words::stopped));
        let mut seen = RunObserver::new(&study, None);
        seen.block(&trace);
        let RunFigures { metrics, drawing, tube } = seen.finish(&study.sha256);
        let divergence = ended.divergence;
        let run = run_info(&study, OUTSIDE, (command, warnings), divergence.as_ref());
        let abort = ended.abort;
        let done = Done { study, gains: None, run, drawing, metrics, tube, divergence, abort };
        Some((done, trace))
    }
}
