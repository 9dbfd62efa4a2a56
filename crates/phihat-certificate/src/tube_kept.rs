//! A run against the tube that was promised for it.

use serde::Serialize;

use crate::extremes::{Extremes as _, larger, smaller};
use crate::{Tube, TubeJoint};

/// Record of one joint in a run, one entry per sample.
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

/// A recorded run beside the tube that was promised for it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TubeKept {
    /// When the steady part begins, by the tube \[s\].
    pub settle_s: f64,
    /// One entry per joint.
    pub joints: Vec<JointKept>,
    /// First point at which the run left its tube; `None`: it did not.
    pub left: Option<Left>,
}

/// One joint of a run beside its tube.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointKept {
    /// Joint name.
    pub name: String,
    /// Largest |e| from the tube's `settle_s` on \[rad\].
    pub error_peak_rad: f64,
    /// Largest |e| that the tube allows there \[rad\].
    pub error_bound_rad: f64,
    /// Largest |ė| there \[rad/s\].
    pub velocity_error_peak_rad_s: f64,
    /// Largest |ė| that the tube allows there \[rad/s\].
    pub velocity_error_bound_rad_s: f64,
    /// Smallest distance of any sample from the edge of the tube \[rad\]; negative outside.
    pub room_rad: f64,
}

/// The first thing that the tube excludes and the run did.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Left {
    /// Joint name.
    pub joint: String,
    /// Quantity that left the tube.
    pub quantity: Quantity,
    /// When \[s\]; the end of the run for what has no moment.
    pub t_s: f64,
    /// The value that left the tube, in the unit of the quantity.
    pub value: f64,
    /// The bound that it is beyond.
    pub bound: f64,
}

/// Quantity that can leave a tube.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// `e` \[rad\].
    Error,
    /// `ė` \[rad/s\].
    VelocityError,
    /// The commanded torque \[N·m\].
    Torque,
    /// Change of the commanded torque from one sample to the next \[N·m\].
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
    /// Compares a recorded run with the tube. Samples beyond the tube's last bin are not claimed, and not looked at.
    ///
    /// `None`: not the joints that the tube is about.
    pub fn kept_by(&self, t_ns: &[u64], runs: &[JointRun<'_>]) -> Option<TubeKept> {
        let mut watch = self.watch(runs.len())?;
        watch.block(self, t_ns, runs);
        Some(watch.kept(self))
    }

    /// To hold a run whose record comes in blocks against the tube; `None`: not as many joints.
    pub fn watch(&self, joints: usize) -> Option<TubeWatch> {
        let watched = |joint: &TubeJoint| WatchedSamples {
            kept: JointKept {
                name: joint.name.clone(),
                error_peak_rad: 0.0,
                error_bound_rad: joint.error_bound_rad,
                velocity_error_peak_rad_s: 0.0,
                velocity_error_bound_rad_s: joint.velocity_error_bound_rad_s,
                room_rad: f64::INFINITY,
            },
            left: None,
            tau: None,
            limited_samples: 0,
        };
        let all = || self.joints.iter().map(watched).collect();
        (joints == self.joints.len()).then(|| TubeWatch { joints: all() })
    }
}

/// Comparison of a run with its tube, up to the last block.
#[derive(Debug, Clone)]
pub struct TubeWatch {
    joints: Vec<WatchedSamples>,
}

#[derive(Debug, Clone)]
struct WatchedSamples {
    kept: JointKept,
    /// The first sample that is outside.
    left: Option<Left>,
    /// The command before.
    tau: Option<f64>,
    limited_samples: u64,
}

impl TubeWatch {
    /// Takes in the next samples of every joint.
    pub fn block(&mut self, tube: &Tube, t_ns: &[u64], runs: &[JointRun<'_>]) {
        let bins: Vec<usize> = t_ns.iter().map(|t| tube.bin_of(*t)).collect();
        let claimed = bins.partition_point(|bin| *bin < tube.bins());
        let part = ClaimedPart { tube, t_ns: &t_ns[..claimed], bins: &bins[..claimed] };
        for ((watched, joint), run) in self.joints.iter_mut().zip(&tube.joints).zip(runs) {
            part.measure(joint, run, &mut watched.kept);
            if watched.left.is_none() {
                watched.left = part.left(joint, run, watched.tau);
            }
            watched.tau = run.tau_command.last().copied().or(watched.tau);
            watched.limited_samples += run.limited_samples;
        }
    }

    /// The run beside its tube, after its last block. A limit that acted though none can is the last to be told: it has
    /// no moment.
    pub fn kept(self, tube: &Tube) -> TubeKept {
        let limited = |watched: &WatchedSamples| Left {
            joint: watched.kept.name.clone(),
            quantity: Quantity::LimitedSamples,
            t_s: tube.duration_s,
            value: watched.limited_samples as f64,
            bound: 0.0,
        };
        let left = |watched: &WatchedSamples| {
            let acted = tube.limits_silent && watched.limited_samples > 0;
            watched.left.clone().or_else(|| acted.then(|| limited(watched)))
        };
        let first = self.joints.iter().filter_map(left).min_by(|a, b| a.t_s.total_cmp(&b.t_s));
        TubeKept {
            settle_s: tube.settle_s,
            joints: self.joints.into_iter().map(|watched| watched.kept).collect(),
            left: first,
        }
    }
}

/// The claimed part of some samples.
struct ClaimedPart<'a> {
    tube: &'a Tube,
    t_ns: &'a [u64],
    bins: &'a [usize],
}

impl ClaimedPart<'_> {
    fn measure(&self, joint: &TubeJoint, run: &JointRun<'_>, kept: &mut JointKept) {
        let settle_ns = self.tube.settle_s * 1e9;
        let from = self.t_ns.partition_point(|t| (*t as f64) < settle_ns);
        let to = self.bins.len().min(run.e.len()).min(run.de.len());
        let steady = |values: &[f64]| {
            let sizes = values.get(from..to).unwrap_or(&[]).iter().map(|value| value.abs());
            sizes.largest()
        };
        kept.error_peak_rad = larger(kept.error_peak_rad, steady(run.e));
        kept.velocity_error_peak_rad_s = larger(kept.velocity_error_peak_rad_s, steady(run.de));
        let room = |(bin, e): (&usize, &f64)| {
            (joint.error_high_rad[*bin] - e).min(e - joint.error_low_rad[*bin])
        };
        let room = self.bins.iter().zip(run.e).map(room);
        kept.room_rad = smaller(kept.room_rad, room.least());
    }

    /// The first sample of a joint that is outside, `before` being the command before these.
    fn left(&self, joint: &TubeJoint, run: &JointRun<'_>, before: Option<f64>) -> Option<Left> {
        for (k, bin) in self.bins.iter().enumerate() {
            let left = |quantity, value, bound| {
                let t_s = self.t_ns[k] as f64 / 1e9;
                Some(Left { joint: joint.name.clone(), quantity, t_s, value, bound })
            };
            // A sample that is missing is outside: nobody saw it inside.
            let of = |column: &[f64]| column.get(k).copied().unwrap_or(f64::NAN);
            let (e, de) = (of(run.e), of(run.de));
            let (low, high) = (joint.error_low_rad[*bin], joint.error_high_rad[*bin]);
            if let Some(bound) = beyond(e, low, high) {
                return left(Quantity::Error, e, bound);
            }
            let (low, high) = (joint.velocity_low_rad_s[*bin], joint.velocity_high_rad_s[*bin]);
            if let Some(bound) = beyond(de, low, high) {
                return left(Quantity::VelocityError, de, bound);
            }
            let tau = of(run.tau_command);
            if let Some(bound) = beyond(tau, -joint.torque_max_nm, joint.torque_max_nm) {
                return left(Quantity::Torque, tau, bound);
            }
            let before = k.checked_sub(1).map_or(before, |k| Some(run.tau_command[k]));
            let step = before.map_or(0.0, |before| tau - before);
            let most = joint.torque_step_nm[*bin];
            if let Some(bound) = beyond(step, -most, most) {
                return left(Quantity::TorqueStep, step, bound);
            }
        }
        None
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
