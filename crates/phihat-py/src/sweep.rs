//! `phihat.sweep`: the sweeps of `phihat sweep`, whole or a shard, and shards put together.

use std::path::PathBuf;

use phihat_campaign::sweep::{SweepAnswer, SweepOptions, SweptWhole};
use phihat_session::Watch;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::{failure, json};

/// Arguments of a sweep: the keyword arguments of `phihat.sweep`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct SweepAsked {
    study: PathBuf,
    gains: Option<PathBuf>,
    vary: Vec<String>,
    runs: u64,
    seed: u64,
    shard: Option<String>,
    fresh: bool,
    uncertified: bool,
    threads: Option<u16>,
    out: Option<PathBuf>,
}

impl SweepAsked {
    fn options(self) -> SweepOptions {
        let Self { study, gains, vary, runs, seed, shard, fresh, uncertified, threads, out } = self;
        SweepOptions { study, gains, vary, runs, seed, shard, fresh, uncertified, threads, out }
    }
}

/// Tells Python how far a sweep is; what that raises is kept until the end.
struct SweepProgress {
    progress: Option<Py<PyAny>>,
    raised: Option<PyErr>,
}

impl Watch for SweepProgress {
    fn progress(&mut self, done: u64, all: u64) {
        let Some(progress) = &self.progress else { return };
        if let Err(why) = Python::attach(|py| progress.call1(py, (done, all))) {
            self.raised.get_or_insert(why);
        }
    }
}

/// Folder of the results; those of a shard go into a folder of its own in it.
#[pyfunction]
pub(crate) fn sweep_folder(py: Python<'_>, asked: SweepAsked) -> PyResult<PathBuf> {
    asked.options().folder().map_err(|why| failure::campaign(py, why))
}

/// Runs a sweep, or a shard of one; its folder, and the answer of a whole one, as in sweep.json.
#[pyfunction]
#[pyo3(signature = (asked, progress))]
pub(crate) fn sweep(
    py: Python<'_>,
    asked: SweepAsked,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'_, PyDict>> {
    let options = asked.options();
    let mut told = SweepProgress { progress, raised: None };
    let answer = py.detach(|| options.run(&mut told)).map_err(|why| failure::campaign(py, why))?;
    if let Some(why) = told.raised {
        return Err(why);
    }
    match answer {
        SweepAnswer::Whole(whole) => swept(py, &whole),
        SweepAnswer::Shard { folder, .. } => {
            let told = PyDict::new(py);
            told.set_item("folder", folder)?;
            told.set_item("sweep", py.None())?;
            Ok(told)
        }
    }
}

/// Puts shards together; the answer, as in sweep.json.
#[pyfunction]
#[pyo3(signature = (folders, out))]
pub(crate) fn merge(
    py: Python<'_>,
    folders: Vec<PathBuf>,
    out: Option<PathBuf>,
) -> PyResult<Bound<'_, PyDict>> {
    let merged = py.detach(|| phihat_campaign::sweep::merge(&folders, out.as_deref()));
    swept(py, &merged.map_err(|why| failure::campaign(py, why))?)
}

fn swept<'py>(py: Python<'py>, whole: &SweptWhole) -> PyResult<Bound<'py, PyDict>> {
    let told = PyDict::new(py);
    told.set_item("folder", &whole.folder)?;
    told.set_item("report", &whole.page)?;
    told.set_item("sweep", json::to_python(py, &whole.summary)?)?;
    Ok(told)
}
