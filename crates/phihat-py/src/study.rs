//! Studies: a file, or a document made in Python.

use phihat::{Form, VelocitySource};
use std::path::{Path, PathBuf};

use phihat_study::{Study, StudyError};
use pyo3::prelude::*;
use serde_json::json;

use crate::{failure, json};

/// Reads a study from its file, or from the JSON text of its document, whose name is then `name`.
pub(crate) fn read(
    py: Python<'_>,
    path: Option<&Path>,
    document: Option<&str>,
    name: &str,
) -> PyResult<(Box<Study>, PathBuf)> {
    let origin = path.map_or_else(|| PathBuf::from(format!("{name}.toml")), Path::to_owned);
    let study = match path {
        Some(path) => Study::read(path).map(Box::new),
        None => from_text(&text(py, document.unwrap_or("{}"))?, &origin),
    };
    let document = path.is_none();
    let refuse = |e: StudyError| {
        let own = document && e.file() == origin.display().to_string();
        if own { failure::study_document(py, &e) } else { failure::study(py, &e) }
    };
    let mut study = study.map_err(refuse)?;
    phihat_sim::derive_substeps(&mut study);
    Ok((study, origin))
}

fn from_text(text: &str, origin: &Path) -> Result<Box<Study>, StudyError> {
    Study::from_text(text, &origin.display().to_string(), Path::new("")).map(Box::new)
}

/// A study's text from the JSON text of its document.
fn text(py: Python<'_>, document: &str) -> PyResult<String> {
    let refuse = |why: String| {
        let message = format!("study: not a study's document: {why}");
        failure::argument(py, "study", None, "a document", "tables, numbers, strings", &message)
    };
    let document: serde_json::Value =
        serde_json::from_str(document).map_err(|e| refuse(e.to_string()))?;
    toml::to_string(&document).map_err(|e| refuse(e.to_string()))
}

/// A study resolved against its robot, as one document, and the robot.
#[pyfunction]
#[pyo3(signature = (path, document, name))]
pub(crate) fn study_document<'py>(
    py: Python<'py>,
    path: Option<PathBuf>,
    document: Option<&str>,
    name: &str,
) -> PyResult<(Bound<'py, PyAny>, crate::robot::Robot)> {
    let (study, _) = read(py, path.as_deref(), document, name)?;
    let as_written: toml::Table =
        toml::from_str(&study.text).map_err(|e| failure::internal(py, e))?;
    let payload = study.world.payload.as_ref().map(|p| {
        json!({ "frame": p.frame, "mass_kg": p.mass, "com_m": p.com, "inertia_kg_m2": p.inertia })
    });
    let push = |p: &phihat_study::Push| {
        json!({ "joint": p.joint, "torque_nm": p.torque, "start_s": p.start,
        "duration_s": p.duration })
    };
    let document = json!({
        "name": study.name,
        "title": study.title,
        "as_written": as_written,
        "duration_s": study.duration,
        "settle_s": study.spec.settle,
        "error_bound_rad": study.spec.error_bound,
        "period_ns": study.control.period_ns,
        "delay_samples": study.control.delay_samples,
        "form": match study.control.form {
            Form::Observer => "observer",
            Form::Literal => "literal",
            Form::Positions => "positions",
        },
        "torque_max_nm": study.control.torque_max,
        "torque_rate_max_nm_s": study.control.torque_rate_max,
        "encoder_bits": study.sensor.encoder_bits,
        "velocity_measured": study.sensor.velocity == VelocitySource::Measured,
        "velocity_filter_hz": study.sensor.velocity_filter_hz,
        "gravity_m_s2": study.world.gravity,
        "robot_friction": study.world.robot_friction,
        "extra_coulomb_nm": study.world.extra_coulomb,
        "extra_viscous_nm_s_rad": study.world.extra_viscous,
        "drive_bandwidth_hz": study.world.drive_bandwidth_hz,
        "payload": payload,
        "pushes": study.world.pushes.iter().map(push).collect::<Vec<_>>(),
        "substeps": study.world.substeps,
    });
    let robot = crate::robot::Robot::new(study.robot, study.world.gravity);
    Ok((json::to_python(py, &document)?, robot))
}
