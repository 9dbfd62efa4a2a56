//! `phihat.Controller`: the law at work, one call per sample.

use numpy::PyArray1;
use phihat::{Command, JointGains, JointState, Measurement, Real as _, Reference, update_joints};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::per_joint;
use crate::failure;
use crate::gains::Gains;
use crate::laws::Laws;
use crate::position_gains::PositionGains;
use crate::raised;

/// Periods between two stamped samples, at most.
const GAP_MAX: u64 = 3;

/// The controller of an arm.
#[pyclass(module = "phihat")]
#[derive(Debug)]
pub(crate) struct Controller {
    names: Vec<String>,
    gains: Vec<JointGains<f64>>,
    states: Vec<JointState<f64>>,
    measurements: Vec<Measurement<f64>>,
    references: Vec<Reference<f64>>,
    commands: Vec<Command<f64>>,
    period_ns: u64,
    stamp: Option<u64>,
}

type Sample<'a, 'py> = [(&'static str, &'a Bound<'py, PyAny>); 5];

#[pymethods]
impl Controller {
    #[new]
    #[pyo3(signature = (gains = None, *, torque_max = None, torque_rate_max = None, form = None, **law))]
    fn new(
        py: Python<'_>,
        gains: Option<&Bound<'_, PyAny>>,
        torque_max: Option<Vec<f64>>,
        torque_rate_max: Option<Vec<f64>>,
        form: Option<&str>,
        law: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let gains = stated_or_given(py, gains, law)?;
        let limits = (torque_max.as_deref(), torque_rate_max.as_deref());
        let Laws { names, joints: laws, period_ns } = Laws::new(py, &gains, limits, form)?;
        let n = names.len();
        Ok(Self {
            names,
            gains: laws,
            states: vec![JointState::new(); n],
            measurements: vec![Measurement::default(); n],
            references: vec![Reference::default(); n],
            commands: vec![Command::default(); n],
            period_ns,
            stamp: None,
        })
    }

    /// Answers one sample: the torque to apply until the next.
    #[pyo3(signature = (q, dq, q_des, dq_des, ddq_des, tau_applied = None, t_ns = None))]
    #[expect(clippy::too_many_arguments, reason = "they are named in Python")]
    fn update<'py>(
        &mut self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        dq: &Bound<'py, PyAny>,
        q_des: &Bound<'py, PyAny>,
        dq_des: &Bound<'py, PyAny>,
        ddq_des: &Bound<'py, PyAny>,
        tau_applied: Option<&Bound<'py, PyAny>>,
        t_ns: Option<u64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let signals =
            [("q", q), ("dq", dq), ("q_des", q_des), ("dq_des", dq_des), ("ddq_des", ddq_des)];
        self.take(signals, tau_applied)?;
        if let Some(t) = t_ns {
            self.check_stamp(py, t)?;
        }
        update_joints(
            &self.gains,
            &mut self.states,
            &self.measurements,
            &self.references,
            &mut self.commands,
        );
        if self.commands.iter().any(|command| command.status.refused) {
            return Err(self.refused(py));
        }
        if t_ns.is_some() {
            self.stamp = t_ns;
        }
        Ok(PyArray1::from_iter(py, self.commands.iter().map(|command| command.tau)))
    }

    /// Takes over a moving or loaded arm: the next torque continues `tau`.
    #[pyo3(signature = (q, dq, q_des, dq_des, ddq_des, tau))]
    #[expect(clippy::too_many_arguments, reason = "they are named in Python")]
    fn resume<'py>(
        &mut self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        dq: &Bound<'py, PyAny>,
        q_des: &Bound<'py, PyAny>,
        dq_des: &Bound<'py, PyAny>,
        ddq_des: &Bound<'py, PyAny>,
        tau: &Bound<'py, PyAny>,
    ) -> PyResult<()> {
        let signals =
            [("q", q), ("dq", dq), ("q_des", q_des), ("dq_des", dq_des), ("ddq_des", ddq_des)];
        self.take(signals, Some(tau))?;
        let mut next = self.states.clone();
        for (i, state) in next.iter_mut().enumerate() {
            let (m, r) = (&self.measurements[i], &self.references[i]);
            if !self.gains[i].resume(state, m, r, m.tau_applied) {
                return Err(self.refused(py));
            }
        }
        self.states = next;
        self.stamp = None;
        Ok(())
    }

    /// Back to rest and zero knowledge of the arm.
    fn reset(&mut self) {
        self.states.fill(JointState::new());
        self.commands.fill(Command::default());
        self.stamp = None;
    }

    /// Joints, in order.
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        self.names.clone()
    }
    /// Time between samples [s].
    #[getter]
    fn period(&self) -> f64 {
        self.period_ns as f64 * 1e-9
    }
    /// The last torque [N m].
    #[getter]
    fn tau<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.commands.iter().map(|command| command.tau))
    }
    /// Estimate of the unknown dynamics [N m], contained in the last torque.
    #[getter]
    fn phi_hat<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.commands.iter().map(|command| command.phi_hat))
    }
    /// True if the torque limit acted on the last torque.
    #[getter]
    fn saturated<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        PyArray1::from_iter(py, self.commands.iter().map(|command| command.status.saturated))
    }
    /// True if the torque-rate limit acted on the last torque.
    #[getter]
    fn rate_limited<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        PyArray1::from_iter(py, self.commands.iter().map(|command| command.status.rate_limited))
    }
    /// Torque limit of each joint [N m]; infinite where there is none.
    #[getter]
    fn torque_max<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.gains.iter().map(|gains| gains.limits().torque()))
    }
}

/// Gains that were given, or those whose numbers were: of the law from positions where a `correction` is among them.
fn stated_or_given<'py>(
    py: Python<'py>,
    gains: Option<&Bound<'py, PyAny>>,
    law: Option<&Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyAny>> {
    let limit = "either gains, or the numbers of phihat.Gains or phihat.PositionGains";
    match (gains, law) {
        (Some(gains), None) => Ok(gains.clone()),
        (None, Some(law)) if law.contains("correction")? => {
            py.get_type::<PositionGains>().call((), Some(law))
        }
        (None, Some(law)) => py.get_type::<Gains>().call((), Some(law)),
        (Some(_), Some(law)) => {
            let more = law.keys().iter().map(|key| key.to_string()).collect::<Vec<_>>().join(", ");
            let message = format!("gains: given, and {more} beside them; it must be {limit}");
            Err(failure::argument(py, "gains", None, more, limit, &message))
        }
        (None, None) => {
            let message = format!("gains: none; it must be {limit}");
            Err(failure::argument(py, "gains", None, py.None(), limit, &message))
        }
    }
}

impl Controller {
    /// Reads a sample. Without `tau_applied`, what was commanded last is taken to have acted.
    fn take(
        &mut self,
        signals: Sample<'_, '_>,
        tau_applied: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let n = self.names.len();
        let [q, dq, q_des, dq_des, ddq_des] = signals;
        let (m, r) = (&mut self.measurements, &mut self.references);
        per_joint(q.0, q.1, n, |i, x| m[i].q = x)?;
        per_joint(dq.0, dq.1, n, |i, x| m[i].dq = x)?;
        per_joint(q_des.0, q_des.1, n, |i, x| r[i].q = x)?;
        per_joint(dq_des.0, dq_des.1, n, |i, x| r[i].dq = x)?;
        per_joint(ddq_des.0, ddq_des.1, n, |i, x| r[i].ddq = x)?;
        if let Some(tau) = tau_applied {
            return per_joint("tau_applied", tau, n, |i, x| m[i].tau_applied = x);
        }
        for (measurement, state) in m.iter_mut().zip(&self.states) {
            measurement.tau_applied = state.tau();
        }
        Ok(())
    }

    /// A stamp goes forward, by no more than [`GAP_MAX`] periods.
    fn check_stamp(&self, py: Python<'_>, t: u64) -> PyResult<()> {
        let Some(before) = self.stamp else { return Ok(()) };
        let most = GAP_MAX * self.period_ns;
        if t > before && t - before <= most {
            return Ok(());
        }
        let limit = format!("after {before} ns, by at most {most} ns ({GAP_MAX} periods)");
        let message = format!("t_ns: {t} ns; it must be {limit}");
        Err(failure::argument(py, "t_ns", None, t, &limit, &message))
    }

    /// The sample is not one of an arm: which value, and what torque to hold.
    fn refused(&self, py: Python<'_>) -> PyErr {
        let mut worst = ("sample", 0, f64::NAN);
        for (i, (m, r)) in self.measurements.iter().zip(&self.references).enumerate() {
            let signals = [
                ("q", m.q),
                ("dq", m.dq),
                ("tau_applied", m.tau_applied),
                ("q_des", r.q),
                ("dq_des", r.dq),
                ("ddq_des", r.ddq),
            ];
            if let Some((field, value)) =
                signals.into_iter().find(|(_, x)| f64::doubt([*x]).is_nan())
            {
                worst = (field, i, value);
                break;
            }
        }
        let (field, joint, value) = worst;
        let joint = &self.names[joint];
        let message = format!(
            "{field}: {value} at joint {joint}; the sample was refused: hold `.tau`, the last torque"
        );
        let carried = PyDict::new(py);
        let fill = || {
            carried.set_item("field", field)?;
            carried.set_item("joint", joint)?;
            carried.set_item("value", value)?;
            carried.set_item("limit", if value.is_finite() { "below 2^32" } else { "finite" })?;
            let held: Vec<f64> = self.states.iter().map(JointState::tau).collect();
            carried.set_item("tau", PyArray1::from_vec(py, held))
        };
        fill().map_or_else(|e| e, |()| raised::raise(py, "SampleRefused", &message, &carried))
    }
}
