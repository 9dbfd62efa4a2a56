//! `phihat.rollouts`: many runs of a study, told run by run, as arrays.

use std::path::{Path, PathBuf};

use numpy::{IntoPyArray, PyArray1, PyArrayMethods};
use phihat_campaign::rollouts::{JOINT_FIGURES, Keep, Rolled, RolloutsError, RunNumbers};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::gains::Gains;
use crate::patience::patiently;
use crate::raised::plain;
use crate::{failure, json, study};

/// Arguments of rollouts: see `phihat.rollouts`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct RolloutsAsked {
    path: Option<PathBuf>,
    document: Option<String>,
    name: String,
    /// Name, paths, values run by run.
    numbers: Vec<(String, Vec<String>, Vec<f64>)>,
    seeds: Option<Vec<u64>>,
    runs: usize,
    gains: Option<Py<Gains>>,
    uncertified: bool,
}

/// Many runs of a study, ready to go.
#[pyclass(frozen, module = "phihat._phihat")]
#[derive(Debug)]
pub(crate) struct Rollouts {
    inner: phihat_campaign::rollouts::Rollouts,
}

#[pymethods]
impl Rollouts {
    #[new]
    fn new(py: Python<'_>, asked: RolloutsAsked) -> PyResult<Self> {
        let RolloutsAsked { path, document, name, numbers, seeds, runs, gains, uncertified } =
            asked;
        let (study, origin) = study::read(py, path.as_deref(), document.as_deref(), &name)?;
        let given = gains.map(|gains| (gains.get().inner.clone(), Path::new("gains.json")));
        let numbers = numbers.into_iter();
        let numbers = numbers.map(|(name, paths, values)| RunNumbers { name, paths, values });
        let told = (numbers.collect(), seeds);
        let made = move || {
            let input = (study, origin.as_path());
            phihat_campaign::rollouts::Rollouts::new(input, given, told, runs, uncertified)
        };
        let inner = patiently(py, made)?.map_err(|why| refused(py, &why))?;
        Ok(Self { inner })
    }

    /// The gains of all runs, but of those whose study states its own.
    #[getter]
    fn gains(&self) -> Gains {
        Gains { inner: self.inner.gains().clone() }
    }
    /// Joints, in order.
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        self.inner.joints()
    }
    /// Time between samples of the study [s].
    #[getter]
    fn period(&self) -> f64 {
        self.inner.period_ns() as f64 * 1e-9
    }

    /// The document of the study that a run is.
    fn study<'py>(&self, py: Python<'py>, run: usize) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, &self.inner.study(run))
    }

    /// Does all runs; Python looks on twenty times a second, which ends them on a signal or on what `progress` raises.
    #[pyo3(signature = (signals, every, threads, progress))]
    fn run<'py>(
        &self,
        py: Python<'py>,
        signals: Vec<String>,
        every: u64,
        threads: Option<u16>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let keep = Keep { signals, every };
        let (mut raised, mut shown) = (None::<PyErr>, None);
        let mut watch = |done: u64, all: u64| {
            let looked = Python::attach(|py| {
                py.check_signals()?;
                if let Some(progress) = progress.as_ref().filter(|_| shown != Some(done)) {
                    shown = Some(done);
                    progress.call1(py, (done, all))?;
                }
                Ok(())
            });
            looked.map_err(|why| raised = Some(why)).is_ok()
        };
        let rolled = py.detach(|| self.inner.run(&keep, threads, &mut watch));
        match (rolled, raised) {
            (_, Some(why)) => Err(why),
            (Err(why), None) => Err(refused(py, &why)),
            (Ok(rolled), None) => arrays(py, rolled, keep.signals),
        }
    }
}

fn arrays(py: Python<'_>, rolled: Rolled, signals: Vec<String>) -> PyResult<Bound<'_, PyDict>> {
    let shaped =
        |values: Vec<f64>, shape: Vec<usize>| PyArray1::from_vec(py, values).reshape(shape);
    let (runs, joints, kept) = (rolled.runs, rolled.joints, rolled.kept);
    let told = PyDict::new(py);
    let figures = PyDict::new(py);
    for (figure, values) in JOINT_FIGURES.iter().zip(rolled.figures) {
        figures.set_item(figure.name, shaped(values, vec![runs, joints])?)?;
    }
    let kept_signals = PyDict::new(py);
    for (name, values) in signals.into_iter().zip(rolled.signals) {
        kept_signals.set_item(name, shaped(values, vec![runs, kept, joints])?)?;
    }
    let ended: Vec<u8> = rolled.ended.iter().map(|end| *end as u8).collect();
    told.set_item("figures", figures)?;
    told.set_item("signals", kept_signals)?;
    told.set_item("ended", ended.into_pyarray(py))?;
    told.set_item("within_spec", rolled.within_spec.into_pyarray(py))?;
    told.set_item("samples", rolled.samples.into_pyarray(py))?;
    told.set_item("tip_error_steady_max_m", rolled.tip.into_pyarray(py))?;
    told.set_item("in_lanes", rolled.in_lanes)?;
    Ok(told)
}

fn refused(py: Python<'_>, why: &RolloutsError) -> PyErr {
    let message = why.to_string();
    match why {
        RolloutsError::Session(why) => failure::session(py, why),
        RolloutsError::Value { name, value, limit, .. } => {
            failure::argument(py, name, None, *value, limit, &message)
        }
        RolloutsError::Key { name, .. } => {
            failure::argument(py, name, None, py.None(), "a number of the study", &message)
        }
        RolloutsError::Count { name, found, runs } => {
            failure::argument(py, name, None, *found, &format!("{runs}"), &message)
        }
        RolloutsError::Keep(_) => {
            failure::argument(py, "signals", None, py.None(), "signals of a trace", &message)
        }
        _ => plain(py, "Error", &message),
    }
}
