//! A run against the tube that was promised for it.

use serde::Serialize;

use crate::extremes::Extremes as _;
use crate::{Tube, TubeJoint};

/// What a run recorded of one joint, one entry per sample.
#[derive(Debug, Clone, Copy)]
pub struct JointRun<'a> {
    /// True position error `e` \[rad\].
    pub e: &'a [f64],
    /// True velocity error `ė` \[rad/s\].
    pub de: &'a [f64],
    /// Commanded torque \[N·m\].
    pub tau_command: &'a [f64],
    /// Samples in which the torque limit or the torque-rate limit acted.
    pub limited_samples: u64,
}

/// A run beside its tube.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TubeKept {
    /// When the steady part begins, by the tube \[s\].
    pub settle_s: f64,
    /// One entry per joint.
    pub joints: Vec<JointKept>,
    /// Where the run left its tube first; `None`: nowhere.
    pub left: Option<Left>,
}

/// One joint of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointKept {
    /// Joint name.
    pub name: String,
    /// Largest |e| from the tube's `settle_s` on \[rad\].
    pub error_max_rad: f64,
    /// What the tube allows there \[rad\].
    pub error_tube_rad: f64,
    /// Largest |ė| there \[rad/s\].
    pub velocity_error_max_rad_s: f64,
    /// What the tube allows there \[rad/s\].
    pub velocity_error_tube_rad_s: f64,
    /// Smallest distance of any sample from the edge of the tube \[rad\]; negative outside.
    pub room_rad: f64,
}

/// The first thing that the tube excludes and the run did.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Left {
    /// Joint name.
    pub joint: String,
    /// What left it.
    pub quantity: Quantity,
    /// When \[s\]; the end of the run for what has no moment.
    pub t_s: f64,
    /// The value, in the unit of the quantity.
    pub value: f64,
    /// The bound that it is beyond.
    pub bound: f64,
}

/// What can leave a tube.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// `e` \[rad\].
    Error,
    /// `ė` \[rad/s\].
    VelocityError,
    /// The commanded torque \[N·m\].
    Torque,
    /// Its change from one sample to the next \[N·m\].
    TorqueStep,
    /// Samples in which a limit acted, though none can.
    LimitedSamples,
}

impl Quantity {
    /// Symbol, unit, and what a unit of it is in SI.
    pub fn words(self) -> (&'static str, &'static str, f64) {
        match self {
            Self::Error => ("e", "mrad", 1e-3),
            Self::VelocityError => ("ė", "mrad/s", 1e-3),
            Self::Torque => ("|τ|", "N·m", 1.0),
            Self::TorqueStep => ("|Δτ|", "N·m/sample", 1.0),
            Self::LimitedSamples => ("limits acting", "samples", 1.0),
        }
    }
}

impl Tube {
    /// A run beside the tube. Samples beyond the tube's last bin are not claimed, and not looked at.
    ///
    /// `None`: not the joints that the tube is about.
    pub fn kept_by(&self, t_ns: &[u64], runs: &[JointRun<'_>]) -> Option<TubeKept> {
        if runs.len() != self.joints.len() {
            return None;
        }
        let bins: Vec<usize> = t_ns.iter().map(|t| self.bin_of(*t)).collect();
        let claimed = bins.partition_point(|bin| *bin < self.bins());
        let watch = Watch { tube: self, t_ns: &t_ns[..claimed], bins: &bins[..claimed] };
        let pairs = || self.joints.iter().zip(runs);
        let first = pairs().filter_map(|(joint, run)| watch.left(joint, run));
        Some(TubeKept {
            settle_s: self.settle_s,
            joints: pairs().map(|(joint, run)| watch.kept(joint, run)).collect(),
            left: first.min_by(|a, b| a.t_s.total_cmp(&b.t_s)),
        })
    }
}

/// The claimed part of a run's time.
struct Watch<'a> {
    tube: &'a Tube,
    t_ns: &'a [u64],
    bins: &'a [usize],
}

impl Watch<'_> {
    fn kept(&self, joint: &TubeJoint, run: &JointRun<'_>) -> JointKept {
        let settle_ns = self.tube.settle_s * 1e9;
        let from = self.t_ns.partition_point(|t| (*t as f64) < settle_ns);
        let to = self.bins.len().min(run.e.len()).min(run.de.len());
        let steady = |values: &[f64]| largest(values.get(from..to).unwrap_or(&[]));
        let room = |(bin, e): (&usize, &f64)| {
            (joint.error_high_rad[*bin] - e).min(e - joint.error_low_rad[*bin])
        };
        let room = self.bins.iter().zip(run.e).map(room);
        JointKept {
            name: joint.name.clone(),
            error_max_rad: steady(run.e),
            error_tube_rad: joint.error_max_rad,
            velocity_error_max_rad_s: steady(run.de),
            velocity_error_tube_rad_s: joint.velocity_error_max_rad_s,
            room_rad: room.least(),
        }
    }

    /// The first sample of a joint that is outside; what has no tube of its own is looked at last.
    fn left(&self, joint: &TubeJoint, run: &JointRun<'_>) -> Option<Left> {
        let left = |quantity, k: usize, value, bound| Left {
            joint: joint.name.clone(),
            quantity,
            t_s: self.t_ns.get(k).map_or(self.tube.duration_s, |t| *t as f64 / 1e9),
            value,
            bound,
        };
        for (k, bin) in self.bins.iter().enumerate() {
            let (e, de) = (run.e.get(k)?, run.de.get(k)?);
            let (low, high) = (joint.error_low_rad[*bin], joint.error_high_rad[*bin]);
            if let Some(bound) = beyond(*e, low, high) {
                return Some(left(Quantity::Error, k, *e, bound));
            }
            let (low, high) = (joint.velocity_low_rad_s[*bin], joint.velocity_high_rad_s[*bin]);
            if let Some(bound) = beyond(*de, low, high) {
                return Some(left(Quantity::VelocityError, k, *de, bound));
            }
            let Some(tau) = run.tau_command.get(k) else { continue };
            if let Some(bound) = beyond(*tau, -joint.torque_max_nm, joint.torque_max_nm) {
                return Some(left(Quantity::Torque, k, *tau, bound));
            }
            let step = if k == 0 { 0.0 } else { tau - run.tau_command[k - 1] };
            if let Some(bound) = beyond(step, -joint.torque_step_max_nm, joint.torque_step_max_nm) {
                return Some(left(Quantity::TorqueStep, k, step, bound));
            }
        }
        (self.tube.limits_silent && run.limited_samples > 0).then(|| {
            left(Quantity::LimitedSamples, self.bins.len(), run.limited_samples as f64, 0.0)
        })
    }
}

/// The end that a value is beyond; NaN is beyond both.
fn beyond(value: f64, low: f64, high: f64) -> Option<f64> {
    if value >= low && value <= high {
        None
    } else if value < low {
        Some(low)
    } else {
        Some(high)
    }
}

fn largest(values: &[f64]) -> f64 {
    let larger = |most: f64, value: &f64| {
        if most.is_nan() || value.abs() <= most { most } else { value.abs() }
    };
    values.iter().fold(0.0, larger)
}
