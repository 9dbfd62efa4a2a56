//! `phihat.Plant`: a study's world, one sample at a time.

use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use phihat_session::OutsideRun;
use pyo3::prelude::*;

use crate::arrays::Batch;
use crate::run::Trace;
use crate::sample::Sample;
use crate::{failure, study};

/// A study's world, which waits for the torque of each sample.
#[pyclass(frozen, module = "phihat._phihat")]
#[derive(Debug)]
pub(crate) struct Plant {
    /// `None`: the record was taken.
    run: Mutex<Option<OutsideRun>>,
    #[pyo3(get)]
    joint_names: Vec<String>,
    #[pyo3(get)]
    period: f64,
    #[pyo3(get)]
    inertia: Vec<f64>,
    #[pyo3(get)]
    torque_max: Option<Vec<f64>>,
}

#[pymethods]
impl Plant {
    #[new]
    #[pyo3(signature = (path, document, name, inertia, command))]
    fn new(
        py: Python<'_>,
        path: Option<PathBuf>,
        document: Option<&str>,
        name: &str,
        inertia: Option<&Bound<'_, PyAny>>,
        command: String,
    ) -> PyResult<Self> {
        let (study, origin) = study::read(py, path.as_deref(), document, name)?;
        let joints = study.robot.joints.iter();
        let joint_names: Vec<String> = joints.map(|joint| joint.name.clone()).collect();
        let stated =
            inertia.map(|given| Batch::read("inertia", given, &joint_names)).transpose()?;
        let inertia = stated.map(|batch| batch.at(0).to_vec());
        let begun = py.detach(|| OutsideRun::new(study, &origin, inertia, command));
        let run = begun.map_err(|e| failure::session(py, &e))?;
        let study = run.study();
        let limits: Vec<Option<f64>> = (0..joint_names.len()).map(|i| study.limits(i).0).collect();
        let limited = limits.iter().any(Option::is_some);
        Ok(Self {
            period: study.control.period_ns as f64 * 1e-9,
            torque_max: limited
                .then(|| limits.iter().map(|most| most.unwrap_or(f64::INFINITY)).collect()),
            inertia: run.inertia.clone(),
            joint_names,
            run: Mutex::new(Some(run)),
        })
    }

    /// The sample that waits for its torque; of a run that is over, the last.
    #[getter]
    fn sample(&self, py: Python<'_>) -> PyResult<Py<Sample>> {
        self.with(py, |run| sample(py, run))?
    }

    /// True if no torque acts any more.
    #[getter]
    fn done(&self) -> bool {
        let held = self.run.lock().unwrap_or_else(PoisonError::into_inner);
        held.as_ref().is_none_or(|run| run.run.is_over())
    }

    /// Applies the torque of the sample that waits; returns the next one.
    fn step(&self, py: Python<'_>, tau: &Bound<'_, PyAny>) -> PyResult<Py<Sample>> {
        let torque = Batch::read("tau", tau, &self.joint_names)?;
        if !torque.axes.is_empty() {
            let limit = format!("({},)", self.joint_names.len());
            let message =
                format!("tau: more than one sample of torques; its shape must be {limit}");
            return Err(failure::argument(py, "tau", None, py.None(), &limit, &message));
        }
        self.with(py, |run| {
            // One torque per joint, as was just checked.
            run.run.step(torque.at(0)).map_err(|e| failure::internal(py, e))?;
            sample(py, run)
        })?
    }

    /// The record of a run that is over.
    fn trace(&self, py: Python<'_>) -> PyResult<Trace> {
        if !self.done() {
            let t = self.with(py, |run| run.run.t())?;
            let message = format!("the run is at t = {t} s: go on to its end, until `done`");
            return Err(failure::argument(py, "done", None, false, "True", &message));
        }
        let mut held = self.run.lock().unwrap_or_else(PoisonError::into_inner);
        let taken = held.take().and_then(|run| py.detach(|| run.end()));
        let (done, trace) = taken.ok_or_else(|| gone(py))?;
        Ok(Trace::new(done, trace))
    }
}

impl Plant {
    fn with<T>(&self, py: Python<'_>, look: impl FnOnce(&mut OutsideRun) -> T) -> PyResult<T> {
        let mut held = self.run.lock().unwrap_or_else(PoisonError::into_inner);
        held.as_mut().map(look).ok_or_else(|| gone(py))
    }
}

fn gone(py: Python<'_>) -> PyErr {
    let message = "the record of this run was taken: a new Plant begins a new run";
    failure::argument(py, "plant", None, py.None(), "a run whose record was not taken", message)
}

fn sample(py: Python<'_>, run: &OutsideRun) -> PyResult<Py<Sample>> {
    let (sensed, wanted) = (run.run.sensed(), run.run.wanted());
    let columns: [&mut dyn Iterator<Item = f64>; 6] = [
        &mut sensed.iter().map(|m| m.q),
        &mut sensed.iter().map(|m| m.dq),
        &mut sensed.iter().map(|m| m.tau_applied),
        &mut wanted.iter().map(|r| r.q),
        &mut wanted.iter().map(|r| r.dq),
        &mut wanted.iter().map(|r| r.ddq),
    ];
    Sample::new(py, run.run.t(), columns)
}
