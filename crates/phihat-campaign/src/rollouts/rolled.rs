//! Results of rollouts: figures of every run and joint, and the requested signals.

use phihat_sim::{JointMetrics, JointTrace};

use crate::sweep::SweepEnd;

use super::error::RolloutsError;

/// A signal of a joint.
#[derive(Debug)]
pub struct RolledSignal {
    /// Its name.
    pub name: &'static str,
    /// Function that returns its samples from the trace of a joint.
    pub of: fn(&JointTrace) -> &[f64],
}

macro_rules! signals {
    ($($field:ident),* $(,)?) => {
        [$(RolledSignal { name: stringify!($field), of: |joint| &joint.$field }),*]
    };
}

/// All signals of a joint, in SI units and radians.
pub static SIGNALS: [RolledSignal; 15] = signals![
    q,
    dq,
    ddq,
    q_desired,
    dq_desired,
    ddq_desired,
    e,
    e_integral,
    de,
    q_measured,
    dq_measured,
    tau_command,
    tau_applied,
    phi,
    phi_hat,
];

/// A signal by its name.
pub fn signal(name: &str) -> Option<&'static RolledSignal> {
    SIGNALS.iter().find(|signal| signal.name == name)
}

/// A figure of a joint over a run.
#[derive(Debug)]
pub struct JointFigure {
    /// Its name, as in `metrics.json`.
    pub name: &'static str,
    /// Function that returns it from the metrics of a joint.
    pub of: fn(&JointMetrics) -> f64,
}

macro_rules! figures {
    ($($field:ident),* $(,)?) => {
        [$(JointFigure { name: stringify!($field), of: |joint| joint.$field }),*]
    };
}

/// Figures that are stored for every run and joint.
pub static JOINT_FIGURES: [JointFigure; 10] = figures![
    error_rms_rad,
    error_peak_rad,
    error_steady_max_rad,
    error_integral_steady_max_rad_s,
    velocity_error_steady_max_rad_s,
    tau_max_nm,
    tau_step_max_nm,
    limited_steady_share,
    phi_max_nm,
    phi_error_steady_max_nm,
];

/// Signals to store, and the interval between stored samples.
#[derive(Debug, Clone)]
pub struct Keep {
    /// Their names.
    pub signals: Vec<String>,
    /// Every so many samples, the first one included.
    pub every: u64,
}

impl Default for Keep {
    fn default() -> Self {
        Self { signals: Vec::new(), every: 1 }
    }
}

impl Keep {
    pub(super) fn found(&self) -> Result<Vec<&'static RolledSignal>, RolloutsError> {
        if self.every == 0 {
            return Err(RolloutsError::Keep("every: 0; it must be 1 or more".to_owned()));
        }
        let find = |name: &String| {
            signal(name).ok_or_else(|| {
                let names: Vec<&str> = SIGNALS.iter().map(|signal| signal.name).collect();
                let names = names.join(", ");
                RolloutsError::Keep(format!("signals: there is no {name:?}; there are {names}"))
            })
        };
        self.signals.iter().map(find).collect()
    }
}

/// Results of all runs.
#[derive(Debug)]
pub struct Rolled {
    /// Runs.
    pub runs: usize,
    /// Joints.
    pub joints: usize,
    /// Number of stored samples of a run.
    pub kept: usize,
    /// End of each run.
    pub ended: Vec<SweepEnd>,
    /// True for a run that was within every bound of its study, to its end.
    pub within_spec: Vec<bool>,
    /// Number of samples of each run.
    pub samples: Vec<u64>,
    /// Largest error of the tip after `settle_s` \[m\]; no number where the robot names no tip.
    pub tip: Vec<f64>,
    /// [`JOINT_FIGURES`], each with one value per run and joint, run by run; for a run that ended early,
    /// over its samples up to its end.
    pub figures: Vec<Vec<f64>>,
    /// Requested signals, each with one value per run, stored sample and joint, in this order; NaN after a
    /// run's end.
    pub signals: Vec<Vec<f64>>,
    /// Number of runs that were simulated in lanes with others.
    pub in_lanes: usize,
}

impl Rolled {
    /// A figure by its name: one value per run and joint, run by run.
    pub fn figure(&self, name: &str) -> Option<&[f64]> {
        let at = JOINT_FIGURES.iter().position(|figure| figure.name == name)?;
        self.figures.get(at).map(Vec::as_slice)
    }

    /// Room for so many runs.
    pub(super) fn with_room(
        (runs, joints, kept): (usize, usize, usize),
        signals: usize,
    ) -> Result<Self, RolloutsError> {
        let long = runs.checked_mul(kept).and_then(|all| all.checked_mul(joints));
        let column = |length: Option<usize>| -> Result<Vec<f64>, RolloutsError> {
            let mut column = Vec::new();
            let room = length.map(|length| column.try_reserve_exact(length).is_ok());
            if let (Some(length), Some(true)) = (length, room) {
                column.resize(length, f64::NAN);
                return Ok(column);
            }
            let gigabytes = runs as f64 * kept as f64 * joints as f64 * signals as f64 * 8e-9;
            Err(RolloutsError::Keep(format!(
                "signals: {gigabytes:.1} GB do not fit into memory; keep fewer of them, or less often"
            )))
        };
        let figures = JOINT_FIGURES.iter().map(|_| column(runs.checked_mul(joints)));
        Ok(Self {
            runs,
            joints,
            kept,
            ended: vec![SweepEnd::Refused; runs],
            within_spec: vec![false; runs],
            samples: vec![0; runs],
            tip: vec![f64::NAN; runs],
            figures: figures.collect::<Result<_, _>>()?,
            signals: (0..signals).map(|_| column(long)).collect::<Result<_, _>>()?,
            in_lanes: 0,
        })
    }
}
