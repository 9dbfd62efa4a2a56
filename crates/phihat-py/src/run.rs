//! `phihat.design`, `phihat.simulate`, and the trace that a run leaves.

use std::path::{Path, PathBuf};
use std::sync::PoisonError;

use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use phihat_campaign::faults::FaultsOptions;
use phihat_compare::CompareOptions;
use phihat_design::Outcome;
use phihat_paper::ReproduceOptions;
use phihat_session::{Done, Session, SessionError, TraceKind, budget, designed_for};
use phihat_sim::JointTrace;
use phihat_synthesis::{Advice, BudgetSearch};
use pyo3::prelude::*;

use crate::gains::Gains;
use crate::own_law::{Declared, Raised, entry};
use crate::patience::patiently;
use crate::raised::plain;
use crate::{failure, json, study};

/// Finds gains for a study's specification.
#[pyfunction]
#[pyo3(signature = (path, document, name))]
pub(crate) fn design(
    py: Python<'_>,
    path: Option<PathBuf>,
    document: Option<&str>,
    name: &str,
) -> PyResult<Gains> {
    let (study, origin) = study::read(py, path.as_deref(), document, name)?;
    let designed = move || {
        let arm = phihat_session::arm(&study, &origin)?;
        let outcome = designed_for(&study, &arm, &origin, Advice::Clauses)?;
        let told = match &outcome {
            Outcome::Designed(_) => None,
            Outcome::Infeasible(_) => {
                Some(budget(&study, &arm, &origin, (&outcome, BudgetSearch::Nothing), &mut ())?)
            }
        };
        Ok((outcome, told))
    };
    match patiently(py, designed)?.map_err(|e: SessionError| failure::session(py, &e))? {
        (Outcome::Designed(gains), _) => Ok(Gains { inner: *gains }),
        (Outcome::Infeasible(no), told) => Err(failure::infeasible(py, &no, told.as_ref())),
    }
}

/// Runs a study's closed loop.
#[pyfunction]
#[pyo3(signature = (path, document, name, gains, uncertified))]
pub(crate) fn simulate(
    py: Python<'_>,
    path: Option<PathBuf>,
    document: Option<&str>,
    name: &str,
    gains: Option<&Gains>,
    uncertified: bool,
) -> PyResult<Trace> {
    let (study, origin) = study::read(py, path.as_deref(), document, name)?;
    let given = gains.map(|gains| (gains.inner.clone(), Path::new("gains.json")));
    let run = move || Ok(Box::new(Session::new(study, &origin, given, uncertified)?.run(|_| ())));
    let ran = patiently(py, run)?.map_err(|e: SessionError| failure::session(py, &e))?;
    let (done, trace) = *ran;
    Ok(Trace { done: Box::new(done), trace })
}

/// Reads the record of a run.
#[pyfunction]
pub(crate) fn recorded(py: Python<'_>, folder: PathBuf) -> PyResult<Trace> {
    let read = py.detach(|| phihat_session::recorded(&folder));
    let (done, trace) = read.map_err(|e| failure::session(py, &e))?;
    Ok(Trace { done: Box::new(done), trace })
}

/// Makes the page of a recorded trace again.
#[pyfunction]
pub(crate) fn report(py: Python<'_>, trace: PathBuf, page: PathBuf) -> PyResult<()> {
    let made = py.detach(|| phihat_session::report_again(&trace, &page));
    made.map(|_| ()).map_err(|e| failure::session(py, &e))
}

/// Arguments of a fault matrix: the keyword arguments of `phihat.faults`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct FaultsAsked {
    studies: Vec<PathBuf>,
    orders: Vec<usize>,
    seeds: u16,
    quick: bool,
    only: Option<String>,
    threads: Option<u16>,
    out: Option<PathBuf>,
}

/// Runs a fault matrix; its answer, as in faults.json.
#[pyfunction]
pub(crate) fn faults(py: Python<'_>, asked: FaultsAsked) -> PyResult<Bound<'_, PyAny>> {
    let FaultsAsked { studies, orders, seeds, quick, only, threads, out } = asked;
    let options =
        FaultsOptions { studies, orders, seeds, quick, only, threads, out, ..Default::default() };
    let answer = py.detach(|| options.run(&mut ())).map_err(|e| failure::campaign(py, e))?;
    json::to_python(py, &answer.summary)
}

/// Arguments of a comparison: the keyword arguments of `phihat.compare`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct CompareAsked {
    studies: Vec<PathBuf>,
    laws: Vec<Declared>,
    only: Vec<String>,
    worlds: Vec<String>,
    seeds: Option<u16>,
    quick: bool,
    fresh: bool,
    threads: Option<u16>,
    out: Option<PathBuf>,
}

/// Compares rivals; the answer, as in compare.json.
#[pyfunction]
pub(crate) fn compare(py: Python<'_>, asked: CompareAsked) -> PyResult<Bound<'_, PyAny>> {
    let CompareAsked { studies, laws, only, worlds, seeds, quick, fresh, threads, out } = asked;
    let raised = Raised::default();
    let laws = laws.into_iter().map(|law| entry(law, &raised)).collect();
    let options = CompareOptions { studies, laws, only, worlds, quick, seeds, fresh, threads, out };
    let answer = py.detach(|| options.run(&mut ())).map_err(|e| failure::campaign(py, e))?;
    if let Some(why) = raised.lock().unwrap_or_else(PoisonError::into_inner).take() {
        return Err(why);
    }
    json::to_python(py, &answer.comparison)
}

/// Reproduces the paper; the answer, as in reproduction.json.
#[pyfunction]
#[pyo3(signature = (only, quick, threads, out))]
pub(crate) fn reproduce(
    py: Python<'_>,
    only: Option<String>,
    quick: bool,
    threads: Option<u16>,
    out: Option<PathBuf>,
) -> PyResult<Bound<'_, PyAny>> {
    let default = ReproduceOptions::default();
    let options = ReproduceOptions { quick, only, threads, out: out.unwrap_or(default.out) };
    let answer = py.detach(|| options.run(None, &mut ())).map_err(|e| failure::campaign(py, e))?;
    json::to_python(py, &answer.reproduction)
}

/// The record of a run.
#[pyclass(frozen, module = "phihat")]
#[derive(Debug)]
pub(crate) struct Trace {
    done: Box<Done>,
    trace: phihat_sim::Trace,
}

impl Trace {
    pub(crate) fn new(done: Done, trace: phihat_sim::Trace) -> Self {
        Self { done: Box::new(done), trace }
    }
}

#[pymethods]
impl Trace {
    /// A signal of every joint: samples down, joints across.
    fn column<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let of: fn(&JointTrace) -> &[f64] = match name {
            "q" => |j| &j.q,
            "dq" => |j| &j.dq,
            "ddq" => |j| &j.ddq,
            "q_desired" => |j| &j.q_desired,
            "dq_desired" => |j| &j.dq_desired,
            "ddq_desired" => |j| &j.ddq_desired,
            "e" => |j| &j.e,
            "e_integral" => |j| &j.e_integral,
            "de" => |j| &j.de,
            "q_measured" => |j| &j.q_measured,
            "dq_measured" => |j| &j.dq_measured,
            "tau_command" => |j| &j.tau_command,
            "tau_applied" => |j| &j.tau_applied,
            "phi" => |j| &j.phi,
            "phi_hat" => |j| &j.phi_hat,
            "error_share" => |j| &j.error_share,
            _ => return Err(failure::internal(py, format!("no column {name}"))),
        };
        self.table(py, |joint, k| of(joint)[k])
    }

    /// True if the samples have the shares of a certified bound.
    #[getter]
    fn bounded(&self) -> bool {
        self.trace.is_bounded()
    }

    /// A flag of every joint: samples down, joints across.
    fn flag<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray2<bool>>> {
        let of: fn(&JointTrace) -> &[bool] = match name {
            "saturated" => |j| &j.saturated,
            "rate_limited" => |j| &j.rate_limited,
            _ => return Err(failure::internal(py, format!("no flag {name}"))),
        };
        self.table(py, |joint, k| of(joint)[k])
    }

    /// Time of each sample [s].
    #[getter]
    fn t<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let seconds: Vec<f64> = self.trace.t_ns.iter().map(|t| *t as f64 * 1e-9).collect();
        seconds.into_pyarray(py)
    }
    /// Time between samples [s].
    #[getter]
    fn period(&self) -> f64 {
        self.trace.period_ns as f64 * 1e-9
    }
    /// Joints, in order.
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        self.trace.joints.iter().map(|joint| joint.name.clone()).collect()
    }
    /// The gains that ran.
    #[getter]
    fn gains(&self, py: Python<'_>) -> PyResult<Gains> {
        let none = || plain(py, "Error", "another controller drove this run: it has no gains");
        let inner = self.done.gains.clone().ok_or_else(none)?;
        Ok(Gains { inner })
    }
    /// The figures of the run, as in metrics.json.
    #[getter]
    fn metrics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, &self.done.figures())
    }
    /// True if every bound of the study was satisfied, and the run came to its end.
    #[getter]
    fn within_spec(&self) -> bool {
        self.done.good()
    }
    /// When [s] and at which joint the run diverged; None if it did not.
    #[getter]
    fn divergence(&self) -> Option<(f64, String)> {
        self.done.divergence.as_ref().map(|d| (d.t, d.joint.clone()))
    }
    /// The supervisor's mode at each sample; None where there was no supervisor.
    #[getter]
    fn mode(&self) -> Option<Vec<&'static str>> {
        let modes = &self.trace.supervision.as_ref()?.mode;
        Some(modes.iter().map(|mode| mode.name()).collect())
    }
    /// Events of the supervisor at each sample; None where there was no supervisor.
    #[getter]
    fn events(&self) -> Option<Vec<Vec<&'static str>>> {
        let events = &self.trace.supervision.as_ref()?.events;
        Some(events.iter().map(|events| events.names().collect()).collect())
    }
    /// Fault that had stopped the arm at each sample, if any; None where there was no supervisor.
    #[getter]
    fn fault(&self) -> Option<Vec<Option<&'static str>>> {
        let faults = &self.trace.supervision.as_ref()?.fault;
        Some(faults.iter().map(|fault| fault.map(phihat::Fault::name)).collect())
    }
    /// Origin of the run, as in run.json.
    #[getter]
    fn run<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, &self.done.run)
    }
    /// The report's page.
    fn page(&self, py: Python<'_>) -> String {
        py.detach(|| phihat_report::page(&self.done.record()))
    }
    /// Writes study, gains, origin, metrics and trace into a folder.
    fn write(&self, py: Python<'_>, folder: PathBuf, csv: bool) -> PyResult<()> {
        let kind = TraceKind::csv(csv);
        let written = py.detach(|| self.done.write(&self.trace, &folder, kind));
        written.map_err(|e| failure::session(py, &e))
    }
    /// Writes the report's page, and its figures beside it.
    fn write_report(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let written = py.detach(|| phihat_session::write_report(&self.done.record(), &path));
        written.map(|_| ()).map_err(|e| failure::session(py, &e))
    }
}

impl Trace {
    fn table<'py, T: numpy::Element>(
        &self,
        py: Python<'py>,
        at: impl Fn(&JointTrace, usize) -> T,
    ) -> PyResult<Bound<'py, PyArray2<T>>> {
        let (joints, samples) = (&self.trace.joints, self.trace.len());
        let rows = (0..samples).flat_map(|k| joints.iter().map(move |joint| (joint, k)));
        let values: Vec<T> = rows.map(|(joint, k)| at(joint, k)).collect();
        PyArray1::from_vec(py, values).reshape([samples, joints.len()])
    }
}
