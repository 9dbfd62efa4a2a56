//! The joints' laws out of gains of either kind, behind their limits.

use phihat::{Form, JointGains, Limits};
use phihat_design::GainsError;
use pyo3::prelude::*;

use crate::checks::{per_joint_values, period_ns};
use crate::failure;
use crate::gains::Gains;
use crate::position_gains::PositionGains;

/// One law per joint, ready to run.
pub(crate) struct Laws {
    pub(crate) names: Vec<String>,
    pub(crate) joints: Vec<JointGains<f64>>,
    pub(crate) period_ns: u64,
}

impl Laws {
    /// Torque and torque-rate limits are those given, one per joint, else those of the certificate.
    pub(crate) fn new(
        py: Python<'_>,
        gains: &Bound<'_, PyAny>,
        (torque_max, torque_rate_max): (Option<&[f64]>, Option<&[f64]>),
        form: Option<&str>,
    ) -> PyResult<Self> {
        let unlimited = Self::of(gains, form)?;
        let names = &unlimited.names;
        per_joint_values(py, "torque_max", torque_max.map(<[f64]>::len), names.len())?;
        per_joint_values(py, "torque_rate_max", torque_rate_max.map(<[f64]>::len), names.len())?;
        let period = unlimited.period_ns as f64 * 1e-9;
        let limited = |(i, law): (usize, &JointGains<f64>)| {
            let own = gains.cast::<Gains>().map_or((None, None), |gains| gains.get().limits(i));
            let of = |values: Option<&[f64]>, own: Option<f64>| match values {
                // Infinity says: no limit.
                Some(values) => Some(values[i]).filter(|x| !(x.is_infinite() && *x > 0.0)),
                None => own,
            };
            let (torque, rate) = (of(torque_max, own.0), of(torque_rate_max, own.1));
            let limits = Limits::new(torque, rate, period).map_err(|error| {
                failure::gains(py, &GainsError::Joint { joint: names[i].clone(), error })
            })?;
            Ok(law.with_limits(limits))
        };
        let joints = unlimited.joints.iter().enumerate().map(limited).collect::<PyResult<_>>()?;
        Ok(Self { joints, ..unlimited })
    }

    /// Without limits.
    fn of(gains: &Bound<'_, PyAny>, form: Option<&str>) -> PyResult<Self> {
        let py = gains.py();
        if let Ok(document) = gains.cast::<Gains>() {
            return Self::of_document(py, document.get(), form);
        }
        let Ok(gains) = gains.cast::<PositionGains>() else {
            let (found, limit) =
                (gains.get_type().name()?.to_string(), "phihat.Gains or phihat.PositionGains");
            let message = format!("gains: {found}; they must be {limit}");
            return Err(failure::argument(py, "gains", None, found, limit, &message));
        };
        if let Some(form) = form {
            let limit = "left out: phihat.PositionGains have one form";
            let message = format!("form: {form:?}; it must be {limit}");
            return Err(failure::argument(py, "form", None, form, limit, &message));
        }
        let PositionGains { names, laws, period_ns, .. } = gains.get();
        Ok(Self { names: names.clone(), joints: laws.clone(), period_ns: *period_ns })
    }

    fn of_document(py: Python<'_>, gains: &Gains, form: Option<&str>) -> PyResult<Self> {
        let form = match form {
            None => {
                let first = gains.inner.joints.first();
                first.map_or(Form::Observer, |joint| joint.form_or(Form::Observer))
            }
            Some("observer") => Form::Observer,
            Some("literal") => Form::Literal,
            Some("positions") => Form::Positions,
            Some(form) => {
                let limit = "\"observer\", \"literal\" or \"positions\"";
                let message = format!("form: {form:?}; it must be {limit}");
                return Err(failure::argument(py, "form", None, form, limit, &message));
            }
        };
        let names = gains.names();
        let period_ns = period_ns(py, gains.inner.rate_hz)?;
        let joints = gains.inner.joint_gains(&names, period_ns, form);
        Ok(Self { joints: joints.map_err(|e| failure::gains(py, &e))?, names, period_ns })
    }
}
