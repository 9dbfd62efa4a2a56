//! The record of a run: every signal of every joint at every control sample.

use core::ops::Range;

use phihat::{Command, Events, Fault, Measurement, Mode, Reference, Report};

/// Signals of one joint, one entry per sample; all vectors have the same length.
///
/// At sample `k` (time `t_k = k·T`): what was measured, what was wanted, what was commanded, and the
/// torque that acted over the interval `[t_k, t_{k+1})`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct JointTrace {
    /// Joint name, as in the robot description.
    pub name: String,
    /// True position `q` \[rad\] (m for prismatic joints, here and below).
    pub q: Vec<f64>,
    /// True velocity `q̇` \[rad/s\].
    pub dq: Vec<f64>,
    /// True acceleration `q̈` at the start of the interval \[rad/s²\].
    pub ddq: Vec<f64>,
    /// Desired position \[rad\].
    pub q_desired: Vec<f64>,
    /// Desired velocity \[rad/s\].
    pub dq_desired: Vec<f64>,
    /// Desired acceleration \[rad/s²\].
    pub ddq_desired: Vec<f64>,
    /// True position error `e = q − q_d` \[rad\].
    pub e: Vec<f64>,
    /// Integral of the error since the start of the run, `∫e` \[rad·s\].
    pub e_integral: Vec<f64>,
    /// True velocity error `ė` \[rad/s\].
    pub de: Vec<f64>,
    /// Measured position, after the encoder \[rad\].
    pub q_measured: Vec<f64>,
    /// Measured or differenced velocity that the controller saw \[rad/s\].
    pub dq_measured: Vec<f64>,
    /// Commanded torque, after the controller's own limits \[N·m\].
    pub tau_command: Vec<f64>,
    /// Torque that acted at the joint (delayed, driven, limited) \[N·m\].
    pub tau_applied: Vec<f64>,
    /// Lumped unknown dynamics `φ = τ_applied − M̄ q̈` \[N·m\].
    pub phi: Vec<f64>,
    /// Estimate of φ, `φ̂`, which is *added* to the torque \[N·m\].
    pub phi_hat: Vec<f64>,
    /// True if the torque limit acted on this command.
    pub saturated: Vec<bool>,
    /// True if the torque-rate limit acted on this command.
    pub rate_limited: Vec<bool>,
    /// Measured `|e|` as a share of its certified bound, 0 where that bound is not claimed (a supervisor neither holds
    /// nor tracks, or no sample came); empty: there is no bound. [`ErrorShares`](crate::ErrorShares) fills it.
    pub error_share: Vec<f64>,
}

/// The record of a whole run: every signal of every joint at every sample.
///
/// # Example
///
/// ```
/// # use phihat::{Form, JointDesign, JointGains};
/// # use phihat_sim::Simulation;
/// use phihat_sim::Trace;
/// use phihat_study::Study;
///
/// # let text = r#"
/// #     duration_s = 2.0
/// #     [robot]
/// #     name = "planar3r"
/// #     [spec]
/// #     settle_s = 1.0
/// #     error_bound_rad = 2e-3
/// #     [gains]
/// #     order = 1
/// #     bandwidth_rad_s = 20.0
/// #     estimator_bandwidth_rad_s = 70.0
/// #     inertia_kg_m2 = [0.42, 0.18, 0.14]
/// #     [reference]
/// #     kind = "sines"
/// #     center = "ready"
/// #     fade_in_s = 1.0
/// #     [[reference.sine]]
/// #     amplitude_rad = 0.2
/// #     frequency_hz = 0.3
/// # "#;
/// # let study = Study::from_text(text, "demo.toml", "".as_ref())?;
/// # let gains = JointDesign {
/// #     inertia: 0.2, kp: 400.0, kd: 40.0, a: &[70.0], period: 1e-3, form: Form::Observer,
/// # };
/// # let law = vec![JointGains::new(&gains)?; 3];
/// # let trace = Simulation::new(&study, &law)?.run(|_| ()).trace;
/// // φ̂ is the estimate of φ: after the start it is near.
/// let (joint, from) = (&trace.joints[0], trace.index_at(1.0));
/// let sum: f64 = (from..trace.len()).map(|k| (joint.phi[k] - joint.phi_hat[k]).powi(2)).sum();
/// assert!((sum / (trace.len() - from) as f64).sqrt() < 0.5); // N·m, rms
///
/// // As Parquet and back: the same bits; so it is as CSV.
/// let mut file = Vec::new();
/// trace.write_parquet(&mut file)?;
/// assert!(Trace::read(bytes::Bytes::from(file), &study)? == trace);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Trace {
    /// Sample period \[ns\].
    pub period_ns: u64,
    /// Time of each sample \[ns\] since the start.
    pub t_ns: Vec<u64>,
    /// One entry per joint, in the robot's order.
    pub joints: Vec<JointTrace>,
    /// Record of the supervisor, where the study has one.
    pub supervision: Option<Supervision>,
}

/// Record of an arm's supervisor; one entry per sample.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Supervision {
    /// The mode.
    pub mode: Vec<Mode>,
    /// Events of the sample.
    pub events: Vec<Events>,
    /// Fault that stopped the arm, until it is armed again.
    pub fault: Vec<Option<Fault>>,
    /// True if the brakes are requested.
    pub brake: Vec<bool>,
}

/// `∫e` of a joint so far, by the trapezoid rule.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Integral {
    /// `e` of the sample before, and `∫e` up to it.
    before: Option<(f64, f64)>,
}

impl Integral {
    fn with(&mut self, e: f64, period: f64) -> f64 {
        let sum = self.before.map_or(0.0, |(before, sum)| sum + 0.5 * period * (before + e));
        self.before = Some((e, sum));
        sum
    }
}

impl Supervision {
    pub(crate) fn push(&mut self, report: &Report) {
        self.mode.push(report.mode);
        self.events.push(report.events);
        self.fault.push(report.fault.map(|(fault, _)| fault));
        self.brake.push(report.brake);
    }
}

impl Trace {
    /// An empty record with room for a run.
    pub fn new(names: &[String], period_ns: u64, samples: u64) -> Self {
        let room = usize::try_from(samples).unwrap_or(0).min(1 << 24);
        let joint = |name: &String| {
            let mut joint = JointTrace { name: name.clone(), ..JointTrace::default() };
            for column in &COLUMNS {
                (column.get_mut)(&mut joint).reserve_exact(room);
            }
            joint.saturated.reserve_exact(room);
            joint.rate_limited.reserve_exact(room);
            joint
        };
        let joints = names.iter().map(joint).collect();
        Self { period_ns, t_ns: Vec::with_capacity(room), joints, supervision: None }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.t_ns.len()
    }

    /// Returns true if the samples have the shares of a certified bound.
    pub fn is_bounded(&self) -> bool {
        self.joints.first().is_some_and(|joint| !joint.error_share.is_empty())
    }

    /// Returns true if there is no sample.
    pub fn is_empty(&self) -> bool {
        self.t_ns.is_empty()
    }

    /// First sample at or after a time \[s\].
    pub fn index_at(&self, t: f64) -> usize {
        self.t_ns.partition_point(|at| (*at as f64) < t * 1e9)
    }

    /// The first value that is no number, as a run that diverged may leave it: time \[s\], joint, column.
    pub fn not_finite(&self) -> Option<(f64, &str, &'static str)> {
        self.joints.iter().find_map(|joint| {
            COLUMNS.iter().find_map(|column| {
                let at = (column.get)(joint).iter().position(|value| !value.is_finite())?;
                Some((*self.t_ns.get(at)? as f64 * 1e-9, joint.name.as_str(), column.name))
            })
        })
    }

    /// Opens a sample with the true state.
    pub(crate) fn state(&mut self, t_ns: u64, q: &[f64], dq: &[f64]) {
        self.t_ns.push(t_ns);
        for (i, joint) in self.joints.iter_mut().enumerate() {
            joint.q.push(q[i]);
            joint.dq.push(dq[i]);
        }
    }

    /// The samples go, the room for them stays.
    pub(crate) fn clear(&mut self) {
        self.t_ns.clear();
        for joint in &mut self.joints {
            for column in &COLUMNS {
                (column.get_mut)(joint).clear();
            }
            joint.saturated.clear();
            joint.rate_limited.clear();
            joint.error_share.clear();
        }
        if let Some(Supervision { mode, events, fault, brake }) = &mut self.supervision {
            mode.clear();
            events.clear();
            fault.clear();
            brake.clear();
        }
    }

    /// Adds all samples of another trace of the same arm.
    pub fn extend(&mut self, other: &Self) {
        self.append(other, 0..other.len());
    }

    /// Adds some samples of another trace of the same arm.
    pub(crate) fn append(&mut self, other: &Self, samples: Range<usize>) {
        self.period_ns = other.period_ns;
        self.t_ns.extend_from_slice(&other.t_ns[samples.clone()]);
        self.joints.resize_with(other.joints.len(), JointTrace::default);
        for (joint, other) in self.joints.iter_mut().zip(&other.joints) {
            joint.name.clone_from(&other.name);
            for column in &COLUMNS {
                let values = &(column.get)(other)[samples.clone()];
                (column.get_mut)(joint).extend_from_slice(values);
            }
            joint.saturated.extend_from_slice(&other.saturated[samples.clone()]);
            joint.rate_limited.extend_from_slice(&other.rate_limited[samples.clone()]);
            if !other.error_share.is_empty() {
                joint.error_share.extend_from_slice(&other.error_share[samples.clone()]);
            }
        }
        let Some(other) = &other.supervision else { return };
        let Supervision { mode, events, fault, brake } = self.supervision.get_or_insert_default();
        mode.extend_from_slice(&other.mode[samples.clone()]);
        events.extend_from_slice(&other.events[samples.clone()]);
        fault.extend_from_slice(&other.fault[samples.clone()]);
        brake.extend_from_slice(&other.brake[samples]);
    }

    /// Closes one joint's sample. `acted`: acceleration at its start, mean torque, and `φ`.
    pub(crate) fn answer(
        &mut self,
        joint: usize,
        integral: &mut Integral,
        measurement: &Measurement<f64>,
        (reference, command): (&Reference<f64>, &Command<f64>),
        acted: (f64, f64, f64),
    ) {
        let period = self.period_ns as f64 * 1e-9;
        let joint = &mut self.joints[joint];
        let last = joint.q.len() - 1;
        let e = joint.q[last] - reference.q;
        joint.de.push(joint.dq[last] - reference.dq);
        joint.e.push(e);
        joint.e_integral.push(integral.with(e, period));
        joint.q_desired.push(reference.q);
        joint.dq_desired.push(reference.dq);
        joint.ddq_desired.push(reference.ddq);
        joint.q_measured.push(measurement.q);
        joint.dq_measured.push(measurement.dq);
        joint.tau_command.push(command.tau);
        joint.phi_hat.push(command.phi_hat);
        joint.saturated.push(command.status.saturated);
        joint.rate_limited.push(command.status.rate_limited);
        let (ddq, tau_applied, phi) = acted;
        joint.ddq.push(ddq);
        joint.tau_applied.push(tau_applied);
        joint.phi.push(phi);
    }
}

/// One numeric signal: its name in files, with the unit, and where it lives.
pub(crate) struct TraceColumn {
    pub(crate) name: &'static str,
    pub(crate) get: fn(&JointTrace) -> &Vec<f64>,
    pub(crate) get_mut: fn(&mut JointTrace) -> &mut Vec<f64>,
}

macro_rules! columns {
    ($($name:literal => $field:ident),* $(,)?) => {
        [$(TraceColumn { name: $name, get: |j| &j.$field, get_mut: |j| &mut j.$field }),*]
    };
}

/// The numeric signals, in the order of the files.
pub(crate) const COLUMNS: [TraceColumn; 15] = columns![
    "q_rad" => q,
    "dq_rad_s" => dq,
    "ddq_rad_s2" => ddq,
    "q_desired_rad" => q_desired,
    "dq_desired_rad_s" => dq_desired,
    "ddq_desired_rad_s2" => ddq_desired,
    "e_rad" => e,
    "e_integral_rad_s" => e_integral,
    "de_rad_s" => de,
    "q_measured_rad" => q_measured,
    "dq_measured_rad_s" => dq_measured,
    "tau_command_nm" => tau_command,
    "tau_applied_nm" => tau_applied,
    "phi_nm" => phi,
    "phi_hat_nm" => phi_hat,
];
