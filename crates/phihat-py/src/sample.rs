//! `phihat.Sample`: inputs of a controller at one sample.

use numpy::PyArray1;
use pyo3::prelude::*;

type Array = Py<PyArray1<f64>>;

/// Inputs of a controller at one sample.
#[pyclass(frozen, get_all, module = "phihat")]
#[derive(Debug)]
pub(crate) struct Sample {
    /// Time since the start of the run [s].
    t: f64,
    /// Measured position [rad].
    q: Array,
    /// Measured velocity [rad/s].
    dq: Array,
    /// Desired position [rad].
    q_des: Array,
    /// Desired velocity [rad/s].
    dq_des: Array,
    /// Desired acceleration [rad/s^2].
    ddq_des: Array,
    /// Torque that acted since the sample before (mean) [N m].
    tau_applied: Array,
}

impl Sample {
    /// From its columns: measured position, velocity, torque; desired position, velocity, acceleration.
    pub(crate) fn new(
        py: Python<'_>,
        t: f64,
        columns: [&mut dyn Iterator<Item = f64>; 6],
    ) -> PyResult<Py<Self>> {
        let [q, dq, tau_applied, q_des, dq_des, ddq_des] =
            columns.map(|column| PyArray1::from_iter(py, column).unbind());
        Py::new(py, Self { t, q, dq, q_des, dq_des, ddq_des, tau_applied })
    }
}

#[pymethods]
impl Sample {
    fn __repr__(&self) -> String {
        format!("Sample(t={} s)", self.t)
    }
}
