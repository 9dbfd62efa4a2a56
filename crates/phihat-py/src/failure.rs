//! Errors of the Rust half as exceptions of `phihat._errors`, with what they carry.

use phihat_design::budget::Budget;
use phihat_design::{GainsError, Infeasible};
use phihat_model::{RobotError, input};
use phihat_session::SessionError;
use phihat_study::StudyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::json;
pub(crate) use crate::raised::internal;
use crate::raised::{plain, raise};

/// One value of one argument that cannot be; `joint` names the joint where one is meant.
pub(crate) fn argument(
    py: Python<'_>,
    field: &str,
    joint: Option<&str>,
    value: impl for<'py> IntoPyObject<'py>,
    limit: &str,
    message: &str,
) -> PyErr {
    let carried = PyDict::new(py);
    let fill = || {
        carried.set_item("field", field)?;
        carried.set_item("joint", joint)?;
        carried.set_item("value", value)?;
        carried.set_item("limit", limit)
    };
    fill().map_or_else(|why| why, |()| raise(py, "ArgumentError", message, &carried))
}

pub(crate) fn robot(py: Python<'_>, error: &RobotError) -> PyErr {
    let carried = PyDict::new(py);
    let (field, joint) = match error {
        RobotError::Joint { joint, .. }
        | RobotError::NoInertia { joint, .. }
        | RobotError::Lock { joint, .. } => (None, Some(joint)),
        RobotError::Value { key, .. } => (Some(key), None),
        _ => (None, None),
    };
    let fill = || {
        carried.set_item("field", field)?;
        carried.set_item("joint", joint)
    };
    fill().map_or_else(|why| why, |()| raise(py, "RobotError", &error.to_string(), &carried))
}

pub(crate) fn study(py: Python<'_>, error: &StudyError) -> PyErr {
    let carried = PyDict::new(py);
    let fill = || {
        carried.set_item("field", error.key())?;
        carried.set_item("file", error.file())?;
        carried.set_item("line", error.line())?;
        carried.set_item("column", error.column())?;
        carried.set_item("limit", error.help())
    };
    fill().map_or_else(|why| why, |()| raise(py, "StudyError", &error.to_string(), &carried))
}

/// Error in a document: without file and line, but with the path of the key.
pub(crate) fn study_document(py: Python<'_>, error: &StudyError) -> PyErr {
    let carried = PyDict::new(py);
    let fill = || {
        carried.set_item("field", error.key())?;
        carried.set_item("limit", error.help())
    };
    let help = error.help().map(|help| format!("; {help}")).unwrap_or_default();
    let message = format!("study{}: {}{help}", subscripts(error.key()), error.message());
    fill().map_or_else(|why| why, |()| raise(py, "StudyError", &message, &carried))
}

/// `gains.kp[2]` as Python writes it: `["gains"]["kp"][2]`.
fn subscripts(key: &str) -> String {
    let part = |part: &str| {
        let (name, index) = part.split_at(part.find('[').unwrap_or(part.len()));
        format!("[{name:?}]{index}")
    };
    key.split('.').filter(|name| !name.is_empty()).map(part).collect()
}

pub(crate) fn gains(py: Python<'_>, error: &GainsError) -> PyErr {
    let carried = PyDict::new(py);
    let fill = || match error {
        GainsError::Joint { joint, error } => {
            carried.set_item("joint", joint)?;
            if let phihat::GainError::NotPositive { gain, value } = error {
                carried.set_item("field", gain.to_string())?;
                carried.set_item("value", value)?;
                carried.set_item("limit", "positive and finite")?;
            }
            Ok(())
        }
        GainsError::Rate { found, expected } => {
            carried.set_item("field", "rate_hz")?;
            carried.set_item("value", found)?;
            carried.set_item("limit", expected)
        }
        _ => Ok(()),
    };
    fill().map_or_else(|why: PyErr| why, |()| raise(py, "GainsError", &error.to_string(), &carried))
}

/// Why a study cannot be taken further.
pub(crate) fn session(py: Python<'_>, error: &SessionError) -> PyErr {
    match error {
        SessionError::Study(why) => study(py, why),
        SessionError::Infeasible { no, budget, .. } => infeasible(py, no, budget.as_deref()),
        other => plain(py, "Error", &input::plain(&other.to_string())),
    }
}

/// Why a campaign, a comparison or a reproduction cannot be done.
pub(crate) fn campaign(py: Python<'_>, error: impl core::fmt::Display) -> PyErr {
    let text = input::plain(&error.to_string());
    plain(py, "Error", text.strip_prefix("error: ").unwrap_or(&text))
}

pub(crate) fn infeasible(py: Python<'_>, no: &Infeasible, budget: Option<&Budget>) -> PyErr {
    let carried = PyDict::new(py);
    let clause = |c: &phihat_design::Clause| {
        let joint = c.joint.as_ref().map_or_else(String::new, |j| format!(" (joint {j})"));
        let possible = c.possible.map_or_else(|| "nothing".to_owned(), |p| format!("{p:.4e}"));
        format!("{}{joint}: {:.4e} is wanted, {possible} is possible", c.key, c.wanted)
    };
    let text: Vec<String> = no.clauses.iter().map(clause).collect();
    let message = format!("no gains keep every clause: {}", text.join("; "));
    let fill = || {
        carried.set_item("clauses", json::to_python(py, &no.clauses)?)?;
        carried.set_item("budget", budget.map(|told| json::to_python(py, told)).transpose()?)
    };
    fill().map_or_else(|why| why, |()| raise(py, "Infeasible", &message, &carried))
}

pub(crate) fn refuted(py: Python<'_>, why: &phihat_design::claims::Refutation) -> PyErr {
    let carried = PyDict::new(py);
    let fill = || {
        carried.set_item("claim", &why.claim)?;
        carried.set_item("inequality", &why.inequality)?;
        carried.set_item("left", why.left)?;
        carried.set_item("right", why.right)
    };
    fill().map_or_else(|e| e, |()| raise(py, "Refuted", &why.to_string(), &carried))
}
