//! A study under a controller of somebody else's.

use std::path::Path;

use phihat_design::requested_gains;
use phihat_sim::{Abort, SimError, Stepped, Trace};
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
    /// Begins a run. `command` says in the record what drove it; `path` stands for the study in messages.
    /// Without an `inertia` \[kg·m²\] per joint it is that of the gains which the study states, else the
    /// middle of the arm's range.
    ///
    /// # Errors
    ///
    /// [`SessionError`]: the study cannot be simulated.
    pub fn new(
        study: Box<Study>,
        path: &Path,
        inertia: Option<Vec<f64>>,
        command: String,
    ) -> Result<Self, SessionError> {
        Self::begun((study, path), inertia, command, Stepped::new)
    }

    fn begun(
        (mut study, path): (Box<Study>, &Path),
        inertia: Option<Vec<f64>>,
        command: String,
        stepped: fn(&Study, &[f64]) -> Result<Stepped, SimError>,
    ) -> Result<Self, SessionError> {
        let stated = requested_gains(&study);
        let stated = stated.map(|gains| gains.joints.iter().map(|j| j.inertia_kg_m2).collect());
        let inertia = match inertia.or(stated) {
            Some(inertia) => inertia,
            None => design::arm(&study, path)?.nominal(),
        };
        let mut warnings = study.warnings();
        let lacks = |what: &str| format!("another controller drove this run: {what}");
        if std::mem::take(&mut study.sensor.velocity_filter_designed) {
            study.sensor.velocity_filter_hz = None;
            warnings.push(lacks("the velocity filter that a design would have chosen is left out"));
        }
        if study.supervisor.is_some() {
            warnings.push(lacks("the study's supervisor is not in it"));
        }
        let run = stepped(&study, &inertia).map_err(|e| SessionError::at(path, e))?;
        Ok(Self { study, command, warnings, inertia, run })
    }

    /// Begins a run behind a robot's interface whose rules are enforced elsewhere: limits of the study's
    /// controller, and the stop conditions of its profile, do not act here. What the profile adds, clamps and
    /// filters does. It has room for a block of its record: see [`Stepped::hand_over`].
    ///
    /// # Errors
    ///
    /// As of [`new`](Self::new).
    pub fn served(study: Box<Study>, path: &Path, command: String) -> Result<Self, SessionError> {
        let mut bare = study.clone();
        (bare.control.torque_max, bare.control.torque_rate_max) = (None, None);
        bare.interface.kept = false;
        let profile = &mut bare.interface.profile;
        (profile.torque_rate_max, profile.first_torque_max) = (None, None);
        profile.losses_max = None;
        let mut new = Self::begun((bare, path), None, command, Stepped::in_blocks)?;
        // What is recorded is the study as it was given.
        let (filter, designed) =
            (new.study.sensor.velocity_filter_hz, new.study.sensor.velocity_filter_designed);
        new.study = study;
        new.study.sensor.velocity_filter_hz = filter;
        new.study.sensor.velocity_filter_designed = designed;
        Ok(new)
    }

    /// The study.
    pub fn study(&self) -> &Study {
        &self.study
    }

    /// The record of a run that is over, with every signal of every joint; `None`: samples are still to come.
    pub fn end(self) -> Option<(Done, Trace)> {
        self.run.is_over().then(|| self.stop(None, Vec::new()))
    }

    /// The record of a run as far as it came: what stopped it, if the robot did, and what is to be said of it.
    pub fn stop(self, abort: Option<Abort>, more: Vec<String>) -> (Done, Trace) {
        let seen = RunObserver::new(&self.study, None);
        self.stop_seen(seen, abort, more)
    }

    /// The same of a run whose samples were seen up to those that it still holds, which are handed back.
    pub(crate) fn stop_seen(
        self,
        mut seen: RunObserver<'_>,
        abort: Option<Abort>,
        more: Vec<String>,
    ) -> (Done, Trace) {
        let Self { study, command, mut warnings, run, .. } = self;
        let (trace, mut ended) = run.end();
        ended.abort = ended.abort.or(abort);
        warnings.extend(more);
        warnings.extend(ended.abort.as_ref().map(words::stopped));
        if !trace.is_empty() {
            seen.block(&trace);
        }
        let RunFigures { metrics, drawing, tube } = seen.finish(&study.sha256);
        let divergence = ended.divergence;
        let run = run_info(&study, OUTSIDE, (command, warnings), divergence.as_ref());
        let abort = ended.abort;
        let done = Done {
            study,
            gains: None,
            designed_by: None,
            run,
            drawing,
            metrics,
            tube,
            divergence,
            abort,
        };
        (done, trace)
    }
}
