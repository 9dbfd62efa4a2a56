//! `phihat.bound`: a motion beside the class of motions that gains are certified for.

use std::path::{Path, PathBuf};

use phihat_session::MotionBound;
use phihat_sim::SampledMotion;
use pyo3::prelude::*;

use crate::arrays::Batch;
use crate::gains::Gains;
use crate::patience::patiently;
use crate::{failure, json, study};

/// Compares a motion with the class of motions of gains, as a document.
#[pyfunction]
#[pyo3(signature = (gains, t, q, path, document, name))]
pub(crate) fn bound<'py>(
    py: Python<'py>,
    gains: &Gains,
    t: Vec<f64>,
    q: &Bound<'py, PyAny>,
    path: Option<PathBuf>,
    document: Option<&str>,
    name: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let own = gains.inner.clone();
    let names: Vec<String> = own.joints.iter().map(|joint| joint.name.clone()).collect();
    let batch = Batch::read("q", q, &names)?;
    if batch.axes != [t.len()] {
        let limit = format!("({}, {}), a row per time", t.len(), names.len());
        let message = format!("q: it must be of shape {limit}");
        return Err(failure::argument(py, "q", None, batch.axes, &limit, &message));
    }
    let grow = t.windows(2).all(|pair| pair[0] < pair[1]) && t.iter().all(|t| t.is_finite());
    if !grow || t.len() < 2 || t[0].abs() > 0.0 {
        let limit = "at least two times that begin at 0 and grow";
        let message = format!("t: it must be {limit}");
        return Err(failure::argument(py, "t", None, t, limit, &message));
    }
    let rows: Vec<Vec<f64>> = (0..t.len()).map(|k| batch.at(k).to_vec()).collect();
    let motion = SampledMotion::new(&t, &rows);
    let stated = path.is_some() || document.is_some();
    let study = stated.then(|| study::read(py, path.as_deref(), document, name)).transpose()?;
    let compared = move || {
        let study = study.as_ref().map(|(study, _)| &**study);
        MotionBound::of(&motion, (&own, Path::new("gains.json")), study)
    };
    let found = patiently(py, compared)?.map_err(|why| failure::session(py, &why))?;
    json::to_python(py, &found)
}
