//! `phihat.PositionGains`: gains of the law whose observer sees the position alone.

use phihat::{Gain, GainError, InnovationSection, JointGains, PositionDesign};
use phihat_design::GainsError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::checks::{per_joint_values, period_ns};
use crate::failure;
use crate::raised::raise;

/// Gains of an arm's joints for the law from positions.
#[pyclass(frozen, module = "phihat")]
#[derive(Debug)]
pub(crate) struct PositionGains {
    /// Joints, in order.
    #[pyo3(get, name = "joint_names")]
    pub(crate) names: Vec<String>,
    /// Rate of the loop that the gains are for [Hz].
    #[pyo3(get)]
    rate_hz: f64,
    /// Nominal inertia of each joint [kg m^2].
    #[pyo3(get)]
    inertia: Vec<f64>,
    /// K_p of each joint [1/s^2].
    #[pyo3(get)]
    kp: Vec<f64>,
    /// K_d of each joint [1/s].
    #[pyo3(get)]
    kd: Vec<f64>,
    /// Correction by an innovation of each joint's position.
    #[pyo3(get)]
    correction: Vec<Vec<f64>>,
    /// Share of the way to the wanted torque per sample, of each joint [1].
    #[pyo3(get)]
    share: Vec<f64>,
    /// Transport delay of each joint [samples].
    #[pyo3(get)]
    delay_samples: Vec<i64>,
    /// Correction by an innovation of each joint's velocity; None: it is not used.
    #[pyo3(get)]
    velocity_correction: Option<Vec<Vec<f64>>>,
    /// Sections of each joint's filter on the innovation: rates and weights; None: there is none.
    innovation_filter: Option<Vec<Vec<FilterSectionNumbers>>>,
    /// Cut-off of the low-pass on the torque command [Hz]; None: none.
    #[pyo3(get)]
    torque_filter_hz: Option<f64>,
    pub(crate) laws: Vec<JointGains<f64>>,
    pub(crate) period_ns: u64,
}

/// A section as it is stated, by any sequences: `(c_0, c_1), (b_0, b_1)`.
type FilterSectionNumbers = [[f64; 2]; 2];

/// And as it is told: tuples.
type ToldSection = ((f64, f64), (f64, f64));

#[pymethods]
impl PositionGains {
    #[new]
    #[pyo3(signature = (
        *, joint_names, rate_hz, inertia, kp, kd, correction, share, delay_samples,
        velocity_correction = None, innovation_filter = None, torque_filter_hz = None
    ))]
    #[expect(clippy::too_many_arguments, reason = "they are named in Python")]
    fn new(
        py: Python<'_>,
        joint_names: Vec<String>,
        rate_hz: f64,
        inertia: Vec<f64>,
        kp: Vec<f64>,
        kd: Vec<f64>,
        correction: Vec<Vec<f64>>,
        share: Vec<f64>,
        delay_samples: Vec<i64>,
        velocity_correction: Option<Vec<Vec<f64>>>,
        innovation_filter: Option<Vec<Vec<FilterSectionNumbers>>>,
        torque_filter_hz: Option<f64>,
    ) -> PyResult<Self> {
        if joint_names.is_empty() {
            let (limit, message) = ("at least one name", "joint_names: there is none");
            return Err(failure::argument(py, "joint_names", None, 0, limit, message));
        }
        for (field, found) in [
            ("inertia", Some(inertia.len())),
            ("kp", Some(kp.len())),
            ("kd", Some(kd.len())),
            ("correction", Some(correction.len())),
            ("share", Some(share.len())),
            ("delay_samples", Some(delay_samples.len())),
            ("velocity_correction", velocity_correction.as_ref().map(Vec::len)),
            ("innovation_filter", innovation_filter.as_ref().map(Vec::len)),
        ] {
            per_joint_values(py, field, found, joint_names.len())?;
        }
        let mut gains = Self {
            names: joint_names,
            rate_hz,
            inertia,
            kp,
            kd,
            correction,
            share,
            delay_samples,
            velocity_correction,
            innovation_filter,
            torque_filter_hz,
            laws: Vec::new(),
            period_ns: period_ns(py, rate_hz)?,
        };
        gains.laws = (0..gains.names.len()).map(|i| gains.law(py, i)).collect::<PyResult<_>>()?;
        Ok(gains)
    }

    /// Sections of each joint's filter on the innovation; None: there is none.
    #[getter]
    fn innovation_filter(&self) -> Option<Vec<Vec<ToldSection>>> {
        let told = |own: &FilterSectionNumbers| {
            let [[c0, c1], [b0, b1]] = *own;
            ((c0, c1), (b0, b1))
        };
        let joints = self.innovation_filter.as_ref()?.iter();
        Some(joints.map(|sections| sections.iter().map(told).collect()).collect())
    }

    fn __repr__(&self) -> String {
        format!("PositionGains({} joints, {} Hz)", self.names.len(), self.rate_hz)
    }
}

impl PositionGains {
    /// The law of a joint, without limits.
    fn law(&self, py: Python<'_>, i: usize) -> PyResult<JointGains<f64>> {
        let (joint, delay) = (&self.names[i], self.delay_samples[i]);
        let design = PositionDesign {
            inertia: self.inertia[i],
            kp: self.kp[i],
            kd: self.kd[i],
            correction: &self.correction[i],
            velocity_correction: self.velocity_correction.as_ref().map_or(&[], |of| &of[i]),
            share: self.share[i],
            delay: usize::try_from(delay).map_err(|_| {
                let message = format!("joint {joint}: a delay of {delay} samples; {DELAYS}");
                failure::argument(py, "delay_samples", Some(joint), delay, DELAYS, &message)
            })?,
            period: self.period_ns as f64 * 1e-9,
        };
        let gains = JointGains::from_positions(&design);
        let stated = self.innovation_filter.as_ref().map_or(&[][..], |of| &of[i]);
        let section =
            |own: &FilterSectionNumbers| InnovationSection { rates: own[0], weights: own[1] };
        let sections: Vec<InnovationSection> = stated.iter().map(section).collect();
        let gains = if sections.is_empty() {
            gains
        } else {
            gains.and_then(|gains| gains.with_innovation_filter(&sections))
        };
        let gains = gains.and_then(|gains| gains.with_torque_filter(self.torque_filter_hz));
        gains.map_err(|error| refused(py, joint, error))
    }
}

const DELAYS: &str = "0 to 4 samples are possible";

/// An exception that says which argument of [`PositionGains`] cannot be.
fn refused(py: Python<'_>, joint: &str, error: GainError) -> PyErr {
    let (field, value, limit) = match error {
        GainError::NotPositive { gain, value } => {
            (keyword(gain), Some(value), "positive and finite")
        }
        GainError::NotFinite { gain, value } => (keyword(gain), Some(value), "finite"),
        GainError::Share { value } => ("share", Some(value), "above 0, at most 1"),
        GainError::Delay { samples } => ("delay_samples", Some(samples as f64), DELAYS),
        GainError::Corrections { position: 3..=5, .. } => {
            ("velocity_correction", None, "as many as correction has, or none")
        }
        GainError::Corrections { .. } | GainError::Order { .. } => {
            ("correction", None, "3 to 5 numbers: two more than the order")
        }
        GainError::UnstableEstimator { .. } => ("correction", None, "a stable observer"),
        GainError::Sections { count } => {
            ("innovation_filter", Some(count as f64), "one or two sections, or none")
        }
        GainError::UnstableSection { .. } => ("innovation_filter", None, "stable sections"),
        _ => ("gains", None, "see the message"),
    };
    let carried = PyDict::new(py);
    let fill = || {
        carried.set_item("field", field)?;
        carried.set_item("joint", joint)?;
        carried.set_item("value", value)?;
        carried.set_item("limit", limit)
    };
    let message = GainsError::Joint { joint: joint.to_owned(), error }.to_string();
    fill().map_or_else(|why| why, |()| raise(py, "GainsError", &message, &carried))
}

/// The argument that states a gain.
fn keyword(gain: Gain) -> &'static str {
    match gain {
        Gain::Inertia => "inertia",
        Gain::Kp => "kp",
        Gain::Kd => "kd",
        Gain::Period => "rate_hz",
        Gain::Share => "share",
        Gain::Correction(_) => "correction",
        Gain::VelocityCorrection(_) => "velocity_correction",
        Gain::Section(_) => "innovation_filter",
        Gain::TorqueFilter => "torque_filter_hz",
        // Of no argument here.
        _ => "gains",
    }
}
