//! `phihat.Gate`: the last thing before a torque leaves.

use numpy::PyArray1;
use phihat::{Command, GainError, Limits, Measurement, Outlet, Tank};
use pyo3::prelude::*;

use crate::arrays::per_joint;
use crate::failure;

/// A gate for an arm's torques.
#[pyclass(module = "phihat")]
#[derive(Debug)]
pub(crate) struct Gate {
    inner: phihat::Gate<f64, Vec<Outlet<f64>>>,
    measurements: Vec<Measurement<f64>>,
    commands: Vec<Command<f64>>,
    held: Vec<f64>,
}

#[pymethods]
impl Gate {
    #[new]
    #[pyo3(signature = (*, rate_hz, torque_max, torque_rate_max = None, energy_max_j = None, energy_window_s = 0.1))]
    fn new(
        py: Python<'_>,
        rate_hz: f64,
        torque_max: Vec<f64>,
        torque_rate_max: Option<Vec<f64>>,
        energy_max_j: Option<f64>,
        energy_window_s: f64,
    ) -> PyResult<Self> {
        let n = torque_max.len();
        let rates = torque_rate_max.unwrap_or_else(|| vec![f64::INFINITY; n]);
        if n == 0 || rates.len() != n {
            let limit = "one number per joint, as many in both";
            let message = format!(
                "torque_rate_max: {} numbers for {n} in torque_max; it must be {limit}",
                rates.len()
            );
            return Err(failure::argument(
                py,
                "torque_rate_max",
                None,
                rates.len(),
                limit,
                &message,
            ));
        }
        let period = 1.0 / rate_hz;
        let finite = |x: f64| (x != f64::INFINITY).then_some(x);
        let refused = |why: GainError| {
            let (field, value) = match why {
                GainError::NotPositive { gain: phihat::Gain::EnergyMax, value } => {
                    ("energy_max_j", value)
                }
                GainError::NotPositive { gain: phihat::Gain::EnergyWindow, value } => {
                    ("energy_window_s", value)
                }
                GainError::NotPositive { gain: phihat::Gain::TorqueMax, value } => {
                    ("torque_max", value)
                }
                GainError::NotPositive { gain: phihat::Gain::TorqueRateMax, value } => {
                    ("torque_rate_max", value)
                }
                _ => ("rate_hz", rate_hz),
            };
            let limit = "positive and finite";
            let message = format!("{field}: {value}; it must be {limit}");
            failure::argument(py, field, None, value, limit, &message)
        };
        let outlet = |(torque, rate): (&f64, &f64)| {
            Limits::new(finite(*torque), finite(*rate), period).map(Outlet::new).map_err(refused)
        };
        let outlets = torque_max.iter().zip(&rates).map(outlet).collect::<PyResult<Vec<_>>>()?;
        let tank =
            energy_max_j.and_then(finite).map(|most| Tank::new(most, energy_window_s, period));
        let tank = tank.transpose().map_err(refused)?;
        Ok(Self {
            inner: phihat::Gate::new(outlets, tank),
            measurements: vec![Measurement::default(); n],
            commands: vec![Command::default(); n],
            held: vec![0.0; n],
        })
    }

    /// Lets the torques of a sample out.
    fn release<'py>(
        &mut self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        tau: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let n = self.commands.len();
        let Self { inner, measurements, commands, held } = self;
        per_joint("q", q, n, |i, x| measurements[i].q = x)?;
        per_joint("tau", tau, n, |i, x| held[i] = x)?;
        for (command, tau) in commands.iter_mut().zip(held) {
            *command = Command { tau: *tau, ..Command::default() };
        }
        inner.release(measurements, commands);
        Ok(PyArray1::from_iter(py, commands.iter().map(|command| command.tau)))
    }

    /// From here on the rate counts from these torques.
    fn hold(&mut self, tau: &Bound<'_, PyAny>) -> PyResult<()> {
        let held = &mut self.held;
        per_joint("tau", tau, held.len(), |i, x| held[i] = x)?;
        self.inner.holding(&self.held);
        Ok(())
    }

    /// True if the torque limit or the energy acted on the last torque.
    #[getter]
    fn saturated<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        PyArray1::from_iter(py, self.commands.iter().map(|command| command.status.saturated))
    }
    /// True if the torque-rate limit acted on the last torque.
    #[getter]
    fn rate_limited<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        PyArray1::from_iter(py, self.commands.iter().map(|command| command.status.rate_limited))
    }
    /// True if the last torque was not finite, and was replaced by the one before it.
    #[getter]
    fn refused<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        PyArray1::from_iter(py, self.commands.iter().map(|command| command.status.refused))
    }
}
