//! Figures of a run: one row per joint.

use core::convert::Infallible;

use phihat::Mode;
use phihat_model::JointKind;
use phihat_study::{RequestedMode, Study, requested};
use serde::{Deserialize, Serialize};

use crate::recorder::Recorder;
use crate::tip::{TipMeasured, TipMetrics};
use crate::trace::{JointTrace, Supervision, Trace};

/// Figures of one joint over a run. "Steady" means: after `Spec::settle`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointMetrics {
    /// Joint name.
    pub name: String,
    /// True for a prismatic joint: then rad reads m, and N·m reads N.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub slides: bool,
    /// Root mean square of `e` over the steady part \[rad\].
    pub error_rms_rad: f64,
    /// Largest |e| of the whole run \[rad\].
    #[serde(alias = "error_max_rad")]
    pub error_peak_rad: f64,
    /// Largest |e| of the steady part \[rad\].
    pub error_steady_max_rad: f64,
    /// The study's bound on the steady |e|, if it states one \[rad\].
    #[serde(alias = "error_spec_rad")]
    pub error_bound_rad: Option<f64>,
    /// Largest |∫e| of the steady part \[rad·s\].
    pub error_integral_steady_max_rad_s: f64,
    /// The study's bound on it \[rad·s\].
    #[serde(alias = "error_integral_spec_rad_s")]
    pub error_integral_bound_rad_s: Option<f64>,
    /// Largest |ė| of the steady part \[rad/s\].
    pub velocity_error_steady_max_rad_s: f64,
    /// The study's bound on it \[rad/s\].
    #[serde(alias = "velocity_error_spec_rad_s")]
    pub velocity_error_bound_rad_s: Option<f64>,
    /// Largest |τ_applied| \[N·m\].
    pub tau_max_nm: f64,
    /// The torque limit in force \[N·m\].
    pub tau_limit_nm: Option<f64>,
    /// Largest change of the commanded torque from one sample to the next \[N·m\].
    pub tau_step_max_nm: f64,
    /// The torque-rate limit in force, per sample \[N·m\].
    pub tau_step_limit_nm: Option<f64>,
    /// Samples whose command met the torque limit.
    pub saturated_samples: u64,
    /// Samples whose command met the torque-rate limit.
    pub rate_limited_samples: u64,
    /// Samples of the steady part whose command met the torque limit.
    pub saturated_steady_samples: u64,
    /// Samples of the steady part whose command met the torque-rate limit.
    pub rate_limited_steady_samples: u64,
    /// Share of the samples of the steady part whose command met either.
    pub limited_steady_share: f64,
    /// Largest |φ| \[N·m\].
    pub phi_max_nm: f64,
    /// Largest |φ − φ̂| of the steady part \[N·m\].
    pub phi_error_steady_max_nm: f64,
}

/// When and why a supervisor stopped the arm for the first time, and how it stood at the end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Stopped {
    /// When \[s\].
    pub t_s: f64,
    /// The fault, by its name; `None`: somebody asked for the stop.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fault: Option<String>,
    /// When the brakes were asked for \[s\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub brake_s: Option<f64>,
    /// The mode at the end, by its name.
    pub mode: String,
}

impl Stopped {
    /// One sentence, for people.
    pub fn sentence(&self) -> String {
        let why = self
            .fault
            .as_ref()
            .map_or_else(|| "asked for".to_owned(), |fault| fault.replace('-', " "));
        let brake = self
            .brake_s
            .map_or_else(String::new, |t| format!("; the brakes were asked for at t = {t:.3} s"));
        format!("STOPPED at t = {:.3} s: {why}{brake}; in {} at the end", self.t_s, self.mode)
    }
}

/// Figures of a run, joint by joint: what a person reads first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Metrics {
    /// Simulated time \[s\].
    pub duration_s: f64,
    /// Start of the steady part \[s\].
    pub settle_s: f64,
    /// Number of control samples.
    pub samples: u64,
    /// Number of control samples of the steady part.
    pub steady_samples: u64,
    /// Share of the commands of all joints in the steady part that met a limit: no claim about gains speaks of these.
    pub limited_steady_share: f64,
    /// Samples of the steady part in which the arm had to follow its motion and did not: its supervisor had
    /// stopped it, or never let it begin.
    #[serde(default)]
    pub untracked_steady_samples: u64,
    /// The supervisor stopped the arm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stopped: Option<Box<Stopped>>,
    /// True if every stated bound is satisfied on every joint, and the arm followed its motion.
    pub within_spec: bool,
    /// One entry per joint, in the robot's order.
    pub joints: Vec<JointMetrics>,
    /// The tip of the arm; `None` in records of before, and where the robot names no tip.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tip: Option<TipMetrics>,
}

impl Metrics {
    /// Figures of a trace against a study's bounds and limits.
    pub fn of(trace: &Trace, study: &Study) -> Self {
        let mut measured = Measured::new(study);
        measured.block(trace);
        measured.metrics()
    }
}

/// Figures of a run whose record comes in blocks.
#[derive(Debug, Clone)]
pub struct Measured {
    metrics: Metrics,
    tip: Option<TipMeasured>,
    sums: Vec<Sums>,
    /// Start of the steady part \[ns\].
    settle_ns: f64,
    period_ns: u64,
    wanted: u64,
    /// Requests to a supervised arm, each with its start time \[s\]; empty: to track.
    requests: Vec<(f64, RequestedMode)>,
}

/// Sums over the samples of a joint so far.
#[derive(Debug, Clone, Default)]
struct Sums {
    /// Of `e²` over the steady part.
    squares: f64,
    /// Commands of the steady part that met either limit.
    limited: u64,
    /// The command before.
    tau: Option<f64>,
}

impl Measured {
    /// Figures before the first sample of a study's run.
    pub fn new(study: &Study) -> Self {
        let joints: Vec<_> = (0..study.robot.joints.len()).map(|i| unmeasured(study, i)).collect();
        let metrics = Metrics {
            duration_s: 0.0,
            settle_s: study.spec.settle,
            samples: 0,
            steady_samples: 0,
            limited_steady_share: 0.0,
            untracked_steady_samples: 0,
            stopped: None,
            within_spec: false,
            joints,
            tip: None,
        };
        Self {
            tip: TipMeasured::new(study),
            sums: vec![Sums::default(); metrics.joints.len()],
            settle_ns: study.spec.settle * 1e9,
            period_ns: study.control.period_ns,
            wanted: crate::simulation::samples(study.duration, study.control.period_ns),
            requests: study.supervisor.as_ref().map_or_else(Vec::new, |s| s.requests.clone()),
            metrics,
        }
    }

    /// Takes in the next samples.
    pub fn block(&mut self, trace: &Trace) {
        let first = trace.t_ns.partition_point(|t| (*t as f64) < self.settle_ns);
        self.metrics.samples += trace.len() as u64;
        self.metrics.steady_samples += (trace.len() - first) as u64;
        if let Some(supervision) = &trace.supervision {
            stopped(&mut self.metrics.stopped, &trace.t_ns, supervision);
            let modes = trace.t_ns.iter().zip(&supervision.mode).skip(first);
            let untracked = modes.filter(|(t, mode)| **mode != Mode::Tracking && self.tracks(**t));
            self.metrics.untracked_steady_samples += untracked.count() as u64;
        }
        let joints = self.metrics.joints.iter_mut().zip(&mut self.sums);
        for ((metrics, sums), joint) in joints.zip(&trace.joints) {
            metrics.add(sums, joint, first);
        }
        if let Some(tip) = &mut self.tip {
            tip.block(trace, first);
        }
    }

    /// Returns true if a supervised arm is requested to follow its motion at a time \[ns\].
    fn tracks(&self, t_ns: u64) -> bool {
        let asked = requested(&self.requests, t_ns as f64 * 1e-9);
        self.requests.is_empty() || asked == Some(RequestedMode::Track)
    }

    /// Metrics from figures that were computed elsewhere, over so many samples and so many steady ones among
    /// them. `joint` sets the figures of a joint, and returns `Σ e²` of the steady part and the number of its
    /// commands that met a limit; `tip`: error, steady error, steady angle.
    pub(crate) fn taken(
        mut self,
        (samples, steady): (u64, u64),
        joint: impl Fn(usize, &mut JointMetrics) -> (f64, u64),
        tip: [f64; 3],
    ) -> Metrics {
        (self.metrics.samples, self.metrics.steady_samples) = (samples, steady);
        for (i, (metrics, sums)) in self.metrics.joints.iter_mut().zip(&mut self.sums).enumerate() {
            (sums.squares, sums.limited) = joint(i, metrics);
        }
        if let Some(own) = &mut self.tip {
            let own = &mut own.metrics;
            [own.error_peak_m, own.error_steady_max_m, own.angle_steady_max_rad] = tip;
        }
        self.metrics()
    }

    /// The figures of all samples so far.
    pub fn metrics(self) -> Metrics {
        let Self { mut metrics, sums, tip, .. } = self;
        metrics.tip = tip.map(|tip| tip.metrics);
        let steady = metrics.steady_samples.max(1) as f64;
        for (joint, sums) in metrics.joints.iter_mut().zip(sums) {
            joint.error_rms_rad = (sums.squares / steady).sqrt();
            joint.limited_steady_share = sums.limited as f64 / steady;
        }
        let shares = metrics.joints.iter().map(|joint| joint.limited_steady_share);
        metrics.limited_steady_share = shares.sum::<f64>() / metrics.joints.len().max(1) as f64;
        metrics.duration_s = metrics.samples as f64 * self.period_ns as f64 * 1e-9;
        let complete = metrics.steady_samples > 0 && metrics.samples >= self.wanted;
        let tip = metrics.tip.as_ref().is_none_or(TipMetrics::within_spec);
        metrics.within_spec = metrics.untracked_steady_samples == 0
            && complete
            && tip
            && metrics.joints.iter().all(JointMetrics::within_spec);
        metrics
    }
}

/// Takes in what the supervisor did in the next samples.
fn stopped(known: &mut Option<Box<Stopped>>, t_ns: &[u64], supervision: &Supervision) {
    let seconds = |k: usize| t_ns[k] as f64 * 1e-9;
    let first = || supervision.mode.iter().position(|mode| *mode == Mode::SafeStop);
    let from = match known {
        Some(_) => Some(0),
        None => first(),
    };
    let (Some(from), Some(last)) = (from, supervision.mode.last()) else { return };
    let own = known.get_or_insert_with(|| {
        let fault = supervision.fault[from].map(|fault| fault.name().to_owned());
        Box::new(Stopped { t_s: seconds(from), fault, brake_s: None, mode: String::new() })
    });
    let asked = || (from..t_ns.len()).find(|k| supervision.brake[*k]).map(seconds);
    own.brake_s = own.brake_s.or_else(asked);
    last.name().clone_into(&mut own.mode);
}

impl Recorder for Measured {
    type Error = Infallible;

    fn take(&mut self, block: &mut Trace) -> Result<(), Infallible> {
        self.block(block);
        Ok(())
    }
}

impl JointMetrics {
    /// More samples, those from `first` on of the steady part.
    fn add(&mut self, sums: &mut Sums, joint: &JointTrace, first: usize) {
        let steady = |values: &'_ [f64], most: &mut f64| {
            raise(most, values.get(first..).unwrap_or(&[]).iter().copied());
        };
        steady(&joint.e, &mut self.error_steady_max_rad);
        steady(&joint.e_integral, &mut self.error_integral_steady_max_rad_s);
        steady(&joint.de, &mut self.velocity_error_steady_max_rad_s);
        raise(&mut self.error_peak_rad, joint.e.iter().copied());
        raise(&mut self.tau_max_nm, joint.tau_applied.iter().copied());
        raise(&mut self.phi_max_nm, joint.phi.iter().copied());
        let misfit = joint.phi.iter().zip(&joint.phi_hat).skip(first).map(|(a, b)| a - b);
        raise(&mut self.phi_error_steady_max_nm, misfit);
        let before = sums.tau.into_iter().chain(joint.tau_command.iter().copied());
        let after = joint.tau_command.iter().skip(usize::from(sums.tau.is_none()));
        raise(&mut self.tau_step_max_nm, before.zip(after).map(|(before, tau)| tau - before));
        sums.tau = joint.tau_command.last().copied().or(sums.tau);
        let errors = joint.e.get(first..).unwrap_or(&[]);
        sums.squares = errors.iter().fold(sums.squares, |sum, e| sum + e * e);
        let count = |flags: &[bool]| flags.iter().filter(|f| **f).count() as u64;
        let after = |flags: &[bool]| count(flags.get(first..).unwrap_or(&[]));
        self.saturated_samples += count(&joint.saturated);
        self.rate_limited_samples += count(&joint.rate_limited);
        self.saturated_steady_samples += after(&joint.saturated);
        self.rate_limited_steady_samples += after(&joint.rate_limited);
        let either = joint.saturated.iter().zip(&joint.rate_limited).skip(first);
        sums.limited += either.filter(|(torque, rate)| **torque || **rate).count() as u64;
    }

    /// Returns true if every bound that the study states is satisfied on this joint.
    pub fn within_spec(&self) -> bool {
        // Written so that NaN does not pass.
        let holds = |value: f64, bound: Option<f64>| bound.is_none_or(|bound| value <= bound);
        holds(self.error_steady_max_rad, self.error_bound_rad)
            && holds(self.error_integral_steady_max_rad_s, self.error_integral_bound_rad_s)
            && holds(self.velocity_error_steady_max_rad_s, self.velocity_error_bound_rad_s)
    }
}

/// A joint of which nothing is known yet, beside its bounds and limits.
fn unmeasured(study: &Study, i: usize) -> JointMetrics {
    let per = |values: &Option<Vec<f64>>| values.as_ref().and_then(|v| v.get(i)).copied();
    let (torque_max, torque_rate_max) = study.limits(i);
    let period = study.control.period_ns as f64 * 1e-9;
    JointMetrics {
        name: study.robot.joints[i].name.clone(),
        slides: study.robot.joints[i].kind == JointKind::Prismatic,
        error_rms_rad: 0.0,
        error_peak_rad: 0.0,
        error_steady_max_rad: 0.0,
        error_bound_rad: per(&study.spec.error_bound),
        error_integral_steady_max_rad_s: 0.0,
        error_integral_bound_rad_s: per(&study.spec.error_integral_bound),
        velocity_error_steady_max_rad_s: 0.0,
        velocity_error_bound_rad_s: per(&study.spec.velocity_error_bound),
        tau_max_nm: 0.0,
        tau_limit_nm: torque_max,
        tau_step_max_nm: 0.0,
        tau_step_limit_nm: torque_rate_max.map(|rate| rate * period),
        saturated_samples: 0,
        rate_limited_samples: 0,
        saturated_steady_samples: 0,
        rate_limited_steady_samples: 0,
        limited_steady_share: 0.0,
        phi_max_nm: 0.0,
        phi_error_steady_max_nm: 0.0,
    }
}

/// Raises a largest absolute value; NaN if there is one.
pub(crate) fn raise(most: &mut f64, values: impl Iterator<Item = f64>) {
    let larger = |most: f64, value: f64| if value.abs() <= most { most } else { value.abs() };
    *most =
        values.fold(*most, |most, value| if most.is_nan() { most } else { larger(most, value) });
}
