//! `phihat.Supervisor`: the law, and around it what a real arm needs.

use numpy::PyArray1;
use phihat::{
    ArmRules, ArmState, Command, JointMemory, JointOptions, JointRange, JointRules, Measurement,
    ModeRequest, MotionLimits, OptionError, Options, Reference, Report, Request, Sample, Stamp,
    supervise,
};
use pyo3::prelude::*;

use crate::arrays::per_joint;
use crate::checks::per_joint_values;
use crate::failure;
use crate::laws::Laws;

/// A controller under supervision.
#[pyclass(module = "phihat")]
#[derive(Debug)]
pub(crate) struct Supervisor {
    names: Vec<String>,
    arm: ArmRules<f64>,
    rules: Vec<JointRules<f64>>,
    state: ArmState,
    memories: Vec<JointMemory<f64>>,
    measurements: Vec<Measurement<f64>>,
    references: Vec<Reference<f64>>,
    preset: Vec<f64>,
    feed_forward: Vec<f64>,
    commands: Vec<Command<f64>>,
    report: Report,
    period_ns: u64,
}

/// Values per joint, in the order of the arguments: as many as joints.
fn lengths(py: Python<'_>, n: usize, given: [&Option<Vec<f64>>; 7]) -> PyResult<()> {
    let fields = [
        "velocity_max",
        "error_stop",
        "error_bound",
        "frozen_travel",
        "dead_zone",
        "oscillation",
        "first_motion",
    ];
    fields.into_iter().zip(given).try_for_each(|(field, values)| {
        per_joint_values(py, field, values.as_ref().map(Vec::len), n)
    })
}

impl Supervisor {
    /// A supervisor of an arm that is idle.
    fn idle(
        names: Vec<String>,
        (arm, rules): (ArmRules<f64>, Vec<JointRules<f64>>),
        period_ns: u64,
    ) -> Self {
        let n = names.len();
        let mut report = Report::default();
        report.brake = true;
        Self {
            rules,
            arm,
            names,
            state: ArmState::new(),
            memories: vec![JointMemory::new(); n],
            measurements: vec![Measurement::default(); n],
            references: vec![Reference::default(); n],
            preset: vec![0.0; n],
            feed_forward: vec![0.0; n],
            commands: vec![Command::default(); n],
            report,
            period_ns,
        }
    }
}

#[pymethods]
impl Supervisor {
    #[new]
    #[pyo3(signature = (
        gains, *, torque_max = None, torque_rate_max = None, velocity_max = None, position_range = None,
        soft_zone = 0.05, braking = 5.0, error_stop = None, frozen_travel = None, reference_limits = None,
        dead_zone = None, oscillation = None, first_motion = None, hold_samples = 5, stop_samples = 20,
        bad_samples = 5, blend = 0.5, start_mismatch_max = 0.05, saturation = None, brake_closing = None,
        error_bound = None, reference_box = None
    ))]
    #[expect(clippy::too_many_arguments, reason = "they are named in Python")]
    fn new(
        py: Python<'_>,
        gains: &Bound<'_, PyAny>,
        torque_max: Option<Vec<f64>>,
        torque_rate_max: Option<Vec<f64>>,
        velocity_max: Option<Vec<f64>>,
        position_range: Option<Vec<(f64, f64)>>,
        soft_zone: f64,
        braking: f64,
        error_stop: Option<Vec<f64>>,
        frozen_travel: Option<Vec<f64>>,
        reference_limits: Option<(f64, f64, f64)>,
        dead_zone: Option<Vec<f64>>,
        oscillation: Option<Vec<f64>>,
        first_motion: Option<Vec<f64>>,
        hold_samples: u32,
        stop_samples: u32,
        bad_samples: u32,
        blend: f64,
        start_mismatch_max: f64,
        saturation: Option<f64>,
        brake_closing: Option<f64>,
        error_bound: Option<Vec<f64>>,
        reference_box: Option<Vec<(f64, f64)>>,
    ) -> PyResult<Self> {
        let limits = (torque_max.as_deref(), torque_rate_max.as_deref());
        let Laws { names, joints: laws, period_ns } = Laws::new(py, gains, limits, None)?;
        let n = names.len();
        let options = Options {
            hold_samples,
            stop_samples,
            bad_samples,
            blend_s: blend,
            start_mismatch_max,
            saturation_s: saturation,
            brake_s: brake_closing,
            ..Options::new(period_ns)
        };
        lengths(
            py,
            n,
            [
                &velocity_max,
                &error_stop,
                &error_bound,
                &frozen_travel,
                &dead_zone,
                &oscillation,
                &first_motion,
            ],
        )?;
        per_joint_values(py, "reference_box", reference_box.as_ref().map(Vec::len), n)?;
        per_joint_values(py, "position_range", position_range.as_ref().map(Vec::len), n)?;
        let motion = |(velocity, acceleration, jerk)| MotionLimits { velocity, acceleration, jerk };
        let motion = reference_limits.map(motion);
        let arm = ArmRules::new(&options).map_err(|e| refused(py, &names, &e))?;
        let at = |values: &Option<Vec<f64>>, i: usize| values.as_ref().map(|values| values[i]);
        let rule = |i: usize| {
            let ends = position_range.as_ref().map(|ends| ends[i]);
            let joint = JointOptions {
                velocity_max: at(&velocity_max, i),
                range: ends
                    .filter(|(low, high)| low.is_finite() || high.is_finite())
                    .map(|(lower, upper)| JointRange { lower, upper, soft: soft_zone, braking }),
                error_stop: at(&error_stop, i),
                error_bound: at(&error_bound, i),
                reference_box: reference_box.as_ref().map(|ends| ends[i]),
                frozen_travel: at(&frozen_travel, i),
                motion,
                dead_zone: at(&dead_zone, i),
                oscillation: at(&oscillation, i),
                first_motion: at(&first_motion, i),
                ..JointOptions::default()
            };
            JointRules::new(i, &laws[i], &joint, &options).map_err(|e| refused(py, &names, &e))
        };
        let rules = (0..n).map(rule).collect::<PyResult<_>>()?;
        Ok(Self::idle(names, (arm, rules), period_ns))
    }

    /// Answers one period: the torque to apply until the next.
    #[pyo3(signature = (
        q, dq, q_des, dq_des, ddq_des, tau_applied = None, *, request, sequence, t_ns = None, now_ns = None,
        preset = None, feed_forward = None
    ))]
    #[expect(clippy::too_many_arguments, reason = "they are named in Python")]
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        dq: &Bound<'py, PyAny>,
        q_des: &Bound<'py, PyAny>,
        dq_des: &Bound<'py, PyAny>,
        ddq_des: &Bound<'py, PyAny>,
        tau_applied: Option<&Bound<'py, PyAny>>,
        request: &str,
        sequence: u64,
        t_ns: Option<u64>,
        now_ns: Option<u64>,
        preset: Option<&Bound<'py, PyAny>>,
        feed_forward: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let mode = match request {
            "idle" => ModeRequest::Idle,
            "arm" => ModeRequest::Arm,
            "hold" => ModeRequest::Hold,
            "track" => ModeRequest::Track,
            "stop" => ModeRequest::Stop,
            _ => {
                let limit = "\"idle\", \"arm\", \"hold\", \"track\" or \"stop\"";
                let message = format!("request: {request:?}; it must be {limit}");
                return Err(failure::argument(py, "request", None, request, limit, &message));
            }
        };
        let n = self.names.len();
        let (m, r) = (&mut self.measurements, &mut self.references);
        per_joint("q", q, n, |i, x| m[i].q = x)?;
        per_joint("dq", dq, n, |i, x| m[i].dq = x)?;
        per_joint("q_des", q_des, n, |i, x| r[i].q = x)?;
        per_joint("dq_des", dq_des, n, |i, x| r[i].dq = x)?;
        per_joint("ddq_des", ddq_des, n, |i, x| r[i].ddq = x)?;
        if let Some(tau) = tau_applied {
            per_joint("tau_applied", tau, n, |i, x| m[i].tau_applied = x)?;
        } else {
            let last = m.iter_mut().zip(&self.commands);
            last.for_each(|(measurement, command)| measurement.tau_applied = command.tau);
        }
        if let Some(torques) = preset {
            let to = &mut self.preset;
            per_joint("preset", torques, n, |i, x| to[i] = x)?;
        }
        if let Some(torques) = feed_forward {
            let to = &mut self.feed_forward;
            per_joint("feed_forward", torques, n, |i, x| to[i] = x)?;
        }
        let t_ns = t_ns.unwrap_or_else(|| sequence.wrapping_mul(self.period_ns));
        self.report = supervise(
            phihat::Rules { arm: &self.arm, joints: &self.rules },
            phihat::Memories { arm: &mut self.state, joints: &mut self.memories },
            &Sample {
                stamp: Stamp { sequence, t_ns },
                now_ns: now_ns.unwrap_or(t_ns),
                joints: &self.measurements,
            },
            &Request {
                mode,
                references: &self.references,
                preset: preset.is_some().then_some(&self.preset),
                feed_forward: feed_forward.is_some().then_some(&self.feed_forward),
            },
            &mut self.commands,
        );
        Ok(PyArray1::from_iter(py, self.commands.iter().map(|command| command.tau)))
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
    /// Mode of the arm: "idle", "armed", "holding", "tracking" or "safe-stop".
    #[getter]
    fn mode(&self) -> &'static str {
        self.report.mode.name()
    }
    /// Fault that stopped the arm, and its joint; None if there is none.
    #[getter]
    fn fault(&self) -> Option<(&'static str, String)> {
        let (fault, joint) = self.report.fault?;
        Some((fault.name(), self.names.get(joint).cloned().unwrap_or_default()))
    }
    /// Why the last request was not granted; None if it was.
    #[getter]
    fn refusal(&self) -> Option<&'static str> {
        self.report.refusal.map(phihat::Refusal::name)
    }
    /// Largest measured error of a joint at the last step, as a share of `error_bound`; 0 where there is none.
    #[getter]
    fn error_share(&self) -> f32 {
        self.report.error_share
    }
    /// Events at the last step.
    #[getter]
    fn events(&self) -> Vec<&'static str> {
        self.report.events.names().collect()
    }
    /// True if the brakes should be closed.
    #[getter]
    fn brake(&self) -> bool {
        self.report.brake
    }
    /// Samples missed in a row.
    #[getter]
    fn misses(&self) -> u32 {
        self.report.misses
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
}

fn refused(py: Python<'_>, names: &[String], error: &OptionError) -> PyErr {
    let (field, joint, value) = match error {
        OptionError::Value { option, value, joint, .. } => (*option, Some(*joint), *value),
        OptionError::Motion { joint, .. } => ("reference_limits", Some(*joint), f64::NAN),
        _ => ("gains", None, f64::NAN),
    };
    let joint = joint.and_then(|at| names.get(at)).map(String::as_str);
    failure::argument(py, field, joint, value, "see the message", &error.to_string())
}
