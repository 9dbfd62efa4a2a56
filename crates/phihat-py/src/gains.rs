//! `phihat.Gains`: the gains document.

use std::path::PathBuf;

use maud::html;
use phihat_design::export::{Target, export};
use phihat_design::{JointCertificate, JointRecord};
use phihat_model::input;
use phihat_report::kit::number::number;
use phihat_report::kit::{MILLI, unit_of};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::checks::{per_joint_values, period_ns};
use crate::{arrays, failure, json};

/// Names of the coupled gains' matrices, as in gains.json, in the order of the document.
const KEYS: [&str; 7] = [
    "error_rad_per_nm",
    "velocity_rad_s_per_nm",
    "acceleration_rad_s2_per_nm",
    "torque_step_nm_per_nm",
    "encoder_error_rad_per_rad",
    "encoder_velocity_per_s",
    "encoder_torque_step_nm_per_rad",
];

/// Gains of an arm's joints, as in gains.json, with what is certified about them.
#[pyclass(frozen, module = "phihat")]
#[derive(Debug)]
pub(crate) struct Gains {
    pub(crate) inner: phihat_design::Gains,
}

impl Gains {
    pub(crate) fn names(&self) -> Vec<String> {
        self.inner.joints.iter().map(|joint| joint.name.clone()).collect()
    }

    /// One figure of every joint's certificate.
    fn certified<T>(&self, figure: impl Fn(&JointCertificate) -> Option<T>) -> Option<Vec<T>> {
        self.inner.certificate.as_ref()?.joints.iter().map(figure).collect()
    }

    /// Torque and torque-rate limit of a joint that the certificate is about.
    pub(crate) fn limits(&self, joint: usize) -> (Option<f64>, Option<f64>) {
        let certificate = self.inner.certificate.as_ref();
        certificate.and_then(|c| c.joints.get(joint)).map_or((None, None), |joint| joint.limits)
    }

    fn column(&self, of: impl Fn(&JointRecord) -> f64) -> Vec<f64> {
        self.inner.joints.iter().map(of).collect()
    }
}

#[pymethods]
impl Gains {
    /// Gains from their numbers; a controller checks them.
    #[new]
    #[pyo3(signature = (*, rate_hz, inertia, kp, kd, a, joint_names = None, torque_filter_hz = None))]
    #[expect(clippy::too_many_arguments, reason = "they are named in Python")]
    fn new(
        py: Python<'_>,
        rate_hz: f64,
        inertia: Vec<f64>,
        kp: Vec<f64>,
        kd: Vec<f64>,
        a: Vec<Vec<f64>>,
        joint_names: Option<Vec<String>>,
        torque_filter_hz: Option<f64>,
    ) -> PyResult<Self> {
        let n = inertia.len();
        if n == 0 {
            let (limit, message) = ("at least one number", "inertia: there is none");
            return Err(failure::argument(py, "inertia", None, 0, limit, message));
        }
        for (field, found) in [
            ("kp", Some(kp.len())),
            ("kd", Some(kd.len())),
            ("a", Some(a.len())),
            ("joint_names", joint_names.as_ref().map(Vec::len)),
        ] {
            per_joint_values(py, field, found, n)?;
        }
        let numbered = || (1..=n).map(|i| format!("joint_{i}")).collect();
        let names = joint_names.unwrap_or_else(numbered);
        let joint = |((i, name), a): ((usize, String), Vec<f64>)| JointRecord {
            name,
            inertia_kg_m2: inertia[i],
            kp_per_s2: kp[i],
            kd_per_s: kd[i],
            a,
            observer: None,
        };
        let joints = names.into_iter().enumerate().zip(a).map(joint).collect();
        // A period is whole nanoseconds.
        let period = period_ns(py, rate_hz)?;
        let gains = phihat_design::Gains::stated(joints, 1e9 / period as f64, "stated in Python");
        let gains = Self { inner: phihat_design::Gains { torque_filter_hz, ..gains } };
        // What the core would refuse is refused here, by joint and gain.
        let checked = gains.inner.joint_gains(&gains.names(), period, phihat::Form::Observer);
        checked.map_err(|e| failure::gains(py, &e))?;
        Ok(gains)
    }

    /// Reads a gains document (JSON).
    #[staticmethod]
    fn from_file(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let text = input::text(&path, input::DOCUMENT_MAX).map_err(|e| {
            let path = path.display().to_string();
            let message = format!("{path}: cannot be read: {e}");
            failure::argument(py, "path", None, path, "a readable file", &message)
        })?;
        Self::from_json(py, &text)
    }

    /// Reads a gains document from its text.
    #[staticmethod]
    fn from_json(py: Python<'_>, text: &str) -> PyResult<Self> {
        let inner = phihat_design::Gains::from_json(text).map_err(|e| failure::gains(py, &e))?;
        Ok(Self { inner })
    }

    /// The document's text.
    fn to_json(&self, py: Python<'_>) -> PyResult<String> {
        self.inner.to_json().map_err(|e| failure::gains(py, &e))
    }

    /// Checks every claim of the certificate again, from these gains alone.
    fn verify(&self, py: Python<'_>) -> PyResult<()> {
        let Some(certificate) = &self.inner.certificate else {
            let message = "these gains carry no certificate";
            let limit = "gains that were designed";
            return Err(failure::argument(py, "certificate", None, py.None(), limit, message));
        };
        py.detach(|| certificate.verify(&self.inner)).map_err(|why| failure::refuted(py, &why))
    }

    /// The text of these gains for ROS 2 ("ros"), C ("c-header") or a table ("csv").
    fn export(&self, py: Python<'_>, format: &str) -> PyResult<String> {
        let target = match format {
            "ros" => Target::Ros,
            "c-header" => Target::CHeader,
            "csv" => Target::Csv,
            _ => {
                let limit = "\"ros\", \"c-header\" or \"csv\"";
                let message = format!("format: {format:?}; it must be {limit}");
                return Err(failure::argument(py, "format", None, format, limit, &message));
            }
        };
        py.detach(|| export(&self.inner, target)).map_err(|e| {
            let message = e.to_string();
            failure::argument(
                py,
                "gains",
                None,
                py.None(),
                "gains that the target can run",
                &message,
            )
        })
    }

    /// Joints, in order.
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        self.names()
    }
    /// Rate of the loop that the gains are for [Hz].
    #[getter]
    fn rate_hz(&self) -> f64 {
        self.inner.rate_hz
    }
    /// Method by which the gains were computed, in words.
    #[getter]
    fn method(&self) -> &str {
        &self.inner.method
    }
    /// Name of the study that the gains were made from.
    #[getter]
    fn study(&self) -> &str {
        &self.inner.study
    }
    /// Nominal inertia of each joint [kg m^2].
    #[getter]
    fn inertia(&self) -> Vec<f64> {
        self.column(|joint| joint.inertia_kg_m2)
    }
    /// K_p of each joint [1/s^2].
    #[getter]
    fn kp(&self) -> Vec<f64> {
        self.column(|joint| joint.kp_per_s2)
    }
    /// K_d of each joint [1/s].
    #[getter]
    fn kd(&self) -> Vec<f64> {
        self.column(|joint| joint.kd_per_s)
    }
    /// Estimator coefficients a_0 ... of each joint.
    #[getter]
    fn a(&self) -> Vec<Vec<f64>> {
        self.inner.joints.iter().map(|joint| joint.a.clone()).collect()
    }
    /// The certificate as a document; None if there is none.
    #[getter]
    fn certificate<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.inner.certificate.as_ref().map(|c| json::to_python(py, c)).transpose()
    }
    /// Range of true over nominal inertia in which each joint's loop is stable; None without certificate.
    #[getter]
    fn window(&self) -> Option<Vec<(f64, f64)>> {
        self.certified(|joint| joint.window.as_ref().map(|window| (window.low, window.high)))
    }
    /// Coupled gains at frozen postures, each a matrix with a row per joint that moves and a column per joint
    /// that is hit; None where nothing is claimed.
    #[getter]
    fn coupled<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let certificate = self.inner.certificate.as_ref();
        let Some(coupled) = certificate.and_then(|c| c.coupled.as_ref()) else { return Ok(None) };
        let matrices = PyDict::new(py);
        for (key, rows) in KEYS.iter().zip(coupled.matrices().map(|(_, rows)| rows)) {
            let values = rows.iter().flatten().copied().collect();
            matrices.set_item(key, arrays::shaped(py, values, &[rows.len(), rows.len()])?)?;
        }
        Ok(Some(matrices))
    }
    /// Certified bound on |e| of each joint [rad]; None if nothing is certified about it.
    #[getter]
    fn error_bound(&self) -> Option<Vec<f64>> {
        let certificate = self.inner.certificate.as_ref()?;
        let bound = |joint| certificate.error_bound(joint).map(|bound| bound.error_bound_rad);
        (0..certificate.joints.len()).map(bound).collect()
    }

    fn __repr__(&self) -> String {
        let certified = if self.inner.certificate.is_some() { ", certified" } else { "" };
        let (n, rate) = (self.inner.joints.len(), self.inner.rate_hz);
        format!("Gains({n} joints, {rate} Hz{certified})")
    }

    /// Table for notebooks: the law of every joint, and its certified bounds.
    fn _repr_html_(&self) -> String {
        let certificate = self.inner.certificate.as_ref();
        let rows = self.inner.joints.iter().enumerate().map(|(i, joint)| {
            let slides = self.inner.slides(&joint.name);
            let bound = certificate.and_then(|certificate| certificate.error_bound(i));
            let error = bound.map(|bound| {
                format!("{} {}", number(MILLI * bound.error_bound_rad), unit_of("mrad", slides))
            });
            let inertia = format!("{} {}", number(joint.inertia_kg_m2), unit_of("kg·m²", slides));
            (&joint.name, inertia, joint, error)
        });
        html! {
            p { (self.__repr__()) }
            table {
                tr { @for head in ["joint", "M̄", "K_p [1/s²]", "K_d [1/s]", "m", "|e| promised"] { th { (head) } } }
                @for (name, inertia, joint, error) in rows {
                    tr {
                        td { (name) }
                        td { (inertia) }
                        td { (number(joint.kp_per_s2)) }
                        td { (number(joint.kd_per_s)) }
                        td { (joint.order()) }
                        td { (error.as_deref().unwrap_or("–")) }
                    }
                }
            }
        }
        .into_string()
    }
}
