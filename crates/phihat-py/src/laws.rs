//! The joints' laws out of a gains document, behind their limits.

use phihat::{Form, JointGains, Limits};
use phihat_design::GainsError;
use pyo3::prelude::*;

use crate::failure;
use crate::gains::Gains;

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
        gains: &Gains,
        (torque_max, torque_rate_max): (Option<&[f64]>, Option<&[f64]>),
        form: &str,
    ) -> PyResult<Self> {
        let names = gains.names();
        let form = match form {
            "observer" => Form::Observer,
            "literal" => Form::Literal,
            _ => {
                let limit = "\"observer\" or \"literal\"";
                let message = format!("form: {form:?}; it must be {limit}");
                return Err(failure::argument(py, "form", None, form, limit, &message));
            }
        };
        let period_ns = period_ns(py, gains.inner.rate_hz)?;
        let laws = gains.inner.joint_gains(&names, period_ns, form);
        let laws = laws.map_err(|e| failure::gains(py, &e))?;
        per_joint_values(py, "torque_max", torque_max.map(<[f64]>::len), names.len())?;
        per_joint_values(py, "torque_rate_max", torque_rate_max.map(<[f64]>::len), names.len())?;
        let limited = |(i, law): (usize, &JointGains<f64>)| {
            let own = gains.limits(i);
            let of = |values: Option<&[f64]>, own: Option<f64>| match values {
                // Infinity says: no limit.
                Some(values) => Some(values[i]).filter(|x| !(x.is_infinite() && *x > 0.0)),
                None => own,
            };
            let (torque, rate) = (of(torque_max, own.0), of(torque_rate_max, own.1));
            let limits = Limits::new(torque, rate, period_ns as f64 * 1e-9).map_err(|error| {
                failure::gains(py, &GainsError::Joint { joint: names[i].clone(), error })
            })?;
            Ok(law.with_limits(limits))
        };
        let joints = laws.iter().enumerate().map(limited).collect::<PyResult<_>>()?;
        Ok(Self { names, joints, period_ns })
    }
}

/// Refuses an argument that has not one value per joint.
pub(crate) fn per_joint_values(
    py: Python<'_>,
    field: &str,
    found: Option<usize>,
    joints: usize,
) -> PyResult<()> {
    let Some(found) = found.filter(|found| *found != joints) else { return Ok(()) };
    let limit = format!("{joints} values, one per joint");
    let message = format!("{field}: {found} values; it must be {limit}");
    Err(failure::argument(py, field, None, found, &limit, &message))
}

fn period_ns(py: Python<'_>, rate_hz: f64) -> PyResult<u64> {
    let period = 1e9 / rate_hz;
    if !(1.0..=1e10).contains(&period) {
        let limit = "0.1 Hz to 1 GHz";
        let message = format!("rate_hz: {rate_hz} Hz; it must be {limit}");
        return Err(failure::argument(py, "rate_hz", None, rate_hz, limit, &message));
    }
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "checked just now: a moderate positive number"
    )]
    let nanoseconds = period.round() as u64;
    Ok(nanoseconds)
}
