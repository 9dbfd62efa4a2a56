//! `phihat.drive`: a robot that Python code talks to.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::PoisonError;
use std::sync::atomic::{AtomicBool, Ordering};

use numpy::IntoPyArray;
use phihat::Released;
use phihat_drive::{
    Adds, CheckName, Clock, DriveError, DriveOptions, Facts, Link, LinkFault, Prepared, Readiness,
    Standing, Stops, Tells, Wait, prepare_on,
};
use phihat_session::{Leave, RunOptions, TraceKind, Watch};
use phihat_sim::Sample;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::own_law::{Raised, kept};
use crate::patience::signals;
use crate::raised::plain;
use crate::run::Trace;
use crate::{failure, json};

/// Arguments of a drive: the keyword arguments of `phihat.drive`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct DriveAsked {
    study: PathBuf,
    gains: Option<PathBuf>,
    reference: Option<PathBuf>,
    out: Option<PathBuf>,
    log: Option<PathBuf>,
    csv: bool,
    accept: Vec<String>,
    link: DeclaredLink,
}

/// A link as its author declares it.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct DeclaredLink {
    object: Py<PyAny>,
    name: String,
    joint_names: Vec<String>,
    period: f64,
    adds_gravity: bool,
}

/// Checks, drives, and reads the record back; with `drive.json` and whether all was well.
#[pyfunction]
pub(crate) fn drive(
    py: Python<'_>,
    asked: DriveAsked,
) -> PyResult<(Trace, Bound<'_, PyAny>, bool, PathBuf)> {
    let DriveAsked { study, gains, reference, out, log, csv, accept, link } = asked;
    let accept = accept.iter().map(|word| check(py, word)).collect::<PyResult<_>>()?;
    let run =
        RunOptions { study, gains, out, log, trace: TraceKind::csv(csv), ..RunOptions::default() };
    let options = DriveOptions { run, accept, reference, ..DriveOptions::default() };
    let raised = Raised::default();
    let link = Box::new(OwnLink::new(py, link, &raised)?);
    let prepared = prepared(py, &options, link, &raised)?;
    let folder = prepared.folder.clone();
    let (document, good) = driven(py, prepared, &raised)?;
    let document = json::to_python(py, &document)?;
    Ok((read_back(py, &folder)?, document, good, folder))
}

/// Every check; nothing moves.
#[inline(never)]
fn prepared(
    py: Python<'_>,
    options: &DriveOptions,
    link: Box<OwnLink>,
    raised: &Raised,
) -> PyResult<Box<Prepared>> {
    let prepared = py.detach(|| prepare_on(options, link).map(Box::new));
    let prepared = prepared.map_err(|why| refused(py, why, raised))?;
    taken(raised).map_or(Ok(prepared), Err)
}

/// Drives; `drive.json`, and whether all was well.
#[inline(never)]
fn driven(
    py: Python<'_>,
    prepared: Box<Prepared>,
    raised: &Raised,
) -> PyResult<(serde_json::Value, bool)> {
    let (folder, stop) = (prepared.folder.clone(), AtomicBool::new(false));
    let page = folder.join("report.html");
    let leave = Leave { folder: &folder, page: Some(&page) };
    let mut watch = Interrupted { stop: &stop, raised: Arc::clone(raised) };
    let driven = py.detach(|| {
        prepared.drive(leave, &mut watch, &stop).map(|driven| (driven.good(), driven.document))
    });
    let (good, document) = driven.map_err(|why| refused(py, why, raised))?;
    taken(raised).map_or(Ok((document, good)), Err)
}

#[inline(never)]
fn read_back(py: Python<'_>, folder: &Path) -> PyResult<Trace> {
    let read = py.detach(|| phihat_session::recorded(folder));
    let (done, trace) = read.map_err(|e| failure::session(py, &e))?;
    Ok(Trace::new(done, trace))
}

fn check(py: Python<'_>, word: &str) -> PyResult<CheckName> {
    let known: Vec<_> = CheckName::ALL.iter().map(|check| check.word()).collect();
    let known = known.join(", ");
    let message = format!("accept: {word:?} is no check; there are {known}");
    CheckName::of(word).ok_or_else(|| failure::argument(py, "accept", None, word, &known, &message))
}

fn taken(raised: &Raised) -> Option<PyErr> {
    raised.lock().unwrap_or_else(PoisonError::into_inner).take()
}

/// Exception of the link, or the reason why nothing was driven, with the valid values.
fn refused(py: Python<'_>, why: DriveError, raised: &Raised) -> PyErr {
    if let Some(raised) = taken(raised) {
        return raised;
    }
    match why {
        DriveError::Session(why) => failure::session(py, &why),
        DriveError::Refused(checks) => {
            let refusing = checks.iter().filter(|check| check.refuses());
            let line = |check: &phihat_drive::Check| {
                let valid = check.valid.as_deref().unwrap_or_default();
                format!("{}: {}; valid: {valid}", check.name.word(), check.found)
            };
            let words: Vec<String> = refusing.map(line).collect();
            let text = format!(
                "nothing was driven: {} (to go on in spite of a check, name it in accept)",
                words.join("; ")
            );
            plain(py, "Error", &text)
        }
        other => plain(py, "Error", &other.to_string()),
    }
}

/// Ctrl-C is a safe stop, after which the record is written and the exception raised.
struct Interrupted<'a> {
    stop: &'a AtomicBool,
    raised: Raised,
}

impl Watch for Interrupted<'_> {
    fn progress(&mut self, _: u64, _: u64) {
        if let Err(why) = Python::attach(signals) {
            kept(&self.raised, why);
            self.stop.store(true, Ordering::SeqCst);
        }
    }
}

/// A robot that Python code talks to.
struct OwnLink {
    object: Py<PyAny>,
    facts: Facts,
    raised: Raised,
    /// Samples that came or were lost.
    samples: u64,
    /// Torques sent last \[N·m\].
    sent: Vec<f64>,
    /// Error in sending, which the next wait reports.
    broken: Option<LinkFault>,
}

/// Position and velocity of each joint, and the torque that acted, where it is known.
type JointReport = (Vec<f64>, Vec<f64>, Option<Vec<f64>>);

impl OwnLink {
    fn new(py: Python<'_>, declared: DeclaredLink, raised: &Raised) -> PyResult<Self> {
        let DeclaredLink { object, name, joint_names, period, adds_gravity } = declared;
        let width = joint_names.len();
        if !(period.is_finite() && period >= 1e-6) {
            let limit = "seconds, at least 1e-6";
            let message = format!("link.period: {period}; it must be {limit}");
            return Err(failure::argument(py, "link.period", None, period, limit, &message));
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive")]
        let period_ns = (period * 1e9).round() as u64;
        let facts = Facts {
            name,
            clock: Clock::LockStep,
            period_ns,
            width,
            joints: Some(joint_names),
            adds: Adds { gravity: adds_gravity, friction: None },
            stops: Stops::default(),
            tells: Tells { echo: false, losses: true, truth: false },
        };
        let (raised, sent) = (Arc::clone(raised), vec![0.0; width]);
        Ok(Self { object, facts, raised, samples: 0, sent, broken: None })
    }

    /// Reads a sample of the robot; `None`: this sample is lost.
    fn read(&self, py: Python<'_>) -> PyResult<Option<JointReport>> {
        let answer = self.object.bind(py).call_method0("read")?;
        if answer.is_none() {
            return Ok(None);
        }
        let list = |i: usize| -> PyResult<Vec<f64>> { answer.get_item(i)?.extract() };
        let told: JointReport = match answer.len()? {
            2 => (list(0)?, list(1)?, None),
            3 => (list(0)?, list(1)?, Some(list(2)?)),
            other => {
                let why = format!("link.read(): {other} values; q, dq or q, dq, tau are valid");
                return Err(PyValueError::new_err(why));
            }
        };
        let width = self.facts.width;
        for (what, values) in
            [("q", Some(&told.0)), ("dq", Some(&told.1)), ("tau", told.2.as_ref())]
        {
            if let Some(found) = values.map(Vec::len).filter(|found| *found != width) {
                let why = format!("link.read(): {what} has {found} values for {width} joints");
                return Err(PyValueError::new_err(why));
            }
        }
        Ok(Some(told))
    }

    /// Does something with the object; what it raises is raised again once the record is written.
    fn call<T>(&self, body: impl FnOnce(Python<'_>) -> PyResult<T>) -> Result<T, LinkFault> {
        Python::attach(body).map_err(|why| {
            kept(&self.raised, why);
            LinkFault::Stopped("its Python code raised an exception")
        })
    }
}

impl Link for OwnLink {
    fn facts(&self) -> &Facts {
        &self.facts
    }

    fn standing(&self) -> Option<Standing> {
        let first = self.call(|py| self.read(py)).ok()?;
        Some(first.map_or_else(
            || {
                let readiness = Readiness::Busy("its first sample did not come".to_owned());
                Standing { q: Vec::new(), readiness }
            },
            |(q, ..)| Standing { q, readiness: Readiness::Ready },
        ))
    }

    fn start(&mut self) -> Result<(), LinkFault> {
        self.samples = 0;
        Ok(())
    }

    fn wait(&mut self, sample: &mut Sample) -> Wait {
        if let Some(why) = self.broken.take() {
            return Wait::Fault(why);
        }
        let t_ns = self.samples * self.facts.period_ns;
        let told = match self.call(|py| self.read(py)) {
            Ok(told) => told,
            Err(why) => return Wait::Fault(why),
        };
        self.samples += 1;
        sample.accepted.clone_from(&self.sent);
        let Some((q, dq, tau)) = told else { return Wait::Lost { t_ns } };
        (sample.sequence, sample.t_ns) = (self.samples, t_ns);
        let tau = tau.as_ref().unwrap_or(&self.sent);
        for (joint, ((q, dq), tau)) in sample.joints.iter_mut().zip(q.iter().zip(&dq).zip(tau)) {
            (joint.q, joint.dq, joint.tau_applied) = (*q, *dq, *tau);
        }
        Wait::Fresh { t_ns }
    }

    fn send(&mut self, tau: Released<'_, f64>) {
        self.sent.copy_from_slice(tau.tau());
        let written = self.call(|py| {
            let tau = tau.tau().to_vec().into_pyarray(py);
            self.object.bind(py).call_method1("write", (tau,)).map(|_| ())
        });
        self.broken = written.err();
    }

    fn finish(&mut self, _: Released<'_, f64>) -> Result<(), LinkFault> {
        self.call(|py| {
            let object = self.object.bind(py);
            if object.hasattr("finish")? {
                object.call_method0("finish").map(|_| ())
            } else {
                Ok(())
            }
        })
    }

    fn recover(&mut self) -> Result<(), LinkFault> {
        Err(LinkFault::NoRecovery)
    }
}
