//! The tube as data: an envelope that a study's run keeps from its start.

use core::fmt;

use serde::{Deserialize, Serialize};

use crate::TubeTip;
use crate::extremes::{Extremes as _, larger};
use crate::outward;

/// Nanoseconds of a second.
const NANO: f64 = 1e9;

/// An envelope of the error of one study's run, from `t = 0`.
///
/// # Claim
///
/// For every payload of the set and every dry-friction level of its interval, constants of the run, and for any phase
/// of the encoders, the study's run from its start keeps `e` and `ė` inside the bins at all samples.
///
/// # Not claimed
///
/// Whatever the certificate lists as not counted; another study, another start.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tube {
    /// Length of a bin \[s\]: bin `b` holds the samples with `b·bin_s ≤ t < (b+1)·bin_s`.
    pub bin_s: f64,
    /// Length of the run \[s\].
    pub duration_s: f64,
    /// When the steady part begins \[s\].
    pub settle_s: f64,
    /// Into how many slices, of mass and of where its centre is, the payloads were divided.
    pub slices: u32,
    /// The payloads.
    pub payload: TubePayloadSet,
    /// Lowest and highest level of dry friction \[N·m\] per joint.
    pub coulomb_nm: (Vec<f64>, Vec<f64>),
    /// Quantum of the position \[rad\] per joint; 0: exact.
    pub quantum_rad: Vec<f64>,
    /// One entry per joint, in the robot's order.
    pub joints: Vec<TubeJoint>,
    /// No torque limit and no torque-rate limit can act anywhere along it.
    pub limits_silent: bool,
    /// Bounds on the tip of the arm that follow; older documents have none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tip: Option<TubeTip>,
}

/// Bodies of which one is welded to a frame of the arm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TubePayloadSet {
    /// Frame (link) name.
    pub frame: String,
    /// Smallest and largest mass \[kg\].
    pub mass_kg: (f64, f64),
    /// Box of the centre of mass \[m\], in the frame's axes.
    pub com_m: [(f64, f64); 3],
    /// Radius of gyration \[m\]: no second moment about the centre of mass is larger than mass times its square.
    pub gyration_m: f64,
}

/// In words: `0 … 1 kg on panda_link8, centre of mass in ±0.05 × ±0.05 × 0 … 0.1 m, radius of gyration up to 0.05 m`.
impl fmt::Display for TubePayloadSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (low, high) = self.mass_kg;
        if high <= 0.0 {
            return f.write_str("none");
        }
        let range = |(low, high): (f64, f64)| match high - low {
            width if width <= 0.0 => format!("{low}"),
            _ if low.to_bits() == (-high).to_bits() => format!("±{high}"),
            _ => format!("{low} … {high}"),
        };
        let [x, y, z] = self.com_m.map(range);
        write!(
            f,
            "{} kg on {}, centre of mass in {x} × {y} × {z} m",
            range((low, high)),
            self.frame
        )?;
        if self.gyration_m > 0.0 {
            write!(f, ", radius of gyration up to {} m", self.gyration_m)
        } else {
            f.write_str(", a point mass")
        }
    }
}

impl From<&phihat_study::PayloadSet> for TubePayloadSet {
    fn from(set: &phihat_study::PayloadSet) -> Self {
        Self {
            frame: set.frame.clone(),
            mass_kg: set.mass,
            com_m: set.com,
            gyration_m: set.gyration,
        }
    }
}

/// One joint's part of the envelope; the lists have one entry per bin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TubeJoint {
    /// Joint name.
    pub name: String,
    /// Least `e` \[rad\].
    pub error_low_rad: Vec<f64>,
    /// Largest `e` \[rad\].
    pub error_high_rad: Vec<f64>,
    /// Least `ė` \[rad/s\].
    pub velocity_low_rad_s: Vec<f64>,
    /// Largest `ė` \[rad/s\].
    pub velocity_high_rad_s: Vec<f64>,
    /// Largest |e| of the bins from `settle_s` on \[rad\].
    #[serde(alias = "error_max_rad")]
    pub error_bound_rad: f64,
    /// Largest |ė| of the bins from `settle_s` on \[rad/s\].
    #[serde(alias = "velocity_error_max_rad_s")]
    pub velocity_error_bound_rad_s: f64,
    /// Largest commanded torque of the whole run \[N·m\].
    pub torque_max_nm: f64,
    /// Largest change of the commanded torque from one sample to the next \[N·m\], per bin.
    pub torque_step_nm: Vec<f64>,
    /// The same of the whole run.
    pub torque_step_max_nm: f64,
    /// The same of the bins from `settle_s` on.
    pub torque_step_steady_max_nm: f64,
}

impl Tube {
    /// The first bin that ends after the settling time; the last one where none does.
    pub(crate) fn first_steady(&self) -> usize {
        let bins = self.bins();
        let before = |bin: &usize| (bin + 1) as f64 * self.bin_s <= self.settle_s + 1e-12;
        (0..bins).take_while(before).count().min(bins.saturating_sub(1))
    }

    /// Largest `∫|e| dt` of a joint over the run, bin by bin \[rad·s\].
    pub fn error_integral(&self, joint: usize) -> f64 {
        let joint = &self.joints[joint];
        let bins = joint.error_low_rad.iter().zip(&joint.error_high_rad);
        bins.map(|(low, high)| self.bin_s * low.abs().max(high.abs())).sum()
    }

    /// This tube, steady from a time \[s\] on: its largest errors are those of the bins that end later, of the last bin
    /// where none does.
    #[must_use]
    pub fn steady_from(mut self, settle_s: f64) -> Self {
        self.settle_s = settle_s;
        let (first, bins) = (self.first_steady(), self.bins());
        let largest = |low: &[f64], high: &[f64]| {
            let ends = low.iter().zip(high).skip(first);
            ends.map(|(low, high)| larger(low.abs(), high.abs())).largest()
        };
        for joint in &mut self.joints {
            joint.error_bound_rad = largest(&joint.error_low_rad, &joint.error_high_rad);
            joint.velocity_error_bound_rad_s =
                largest(&joint.velocity_low_rad_s, &joint.velocity_high_rad_s);
            let steps = joint.torque_step_nm.iter().copied();
            joint.torque_step_steady_max_nm = steps.clone().skip(first).largest();
            joint.torque_step_max_nm = steps.largest();
        }
        let off: Vec<_> = (first..bins).filter_map(|bin| self.tip_in_bin(bin)).collect();
        if let Some(tip) = &mut self.tip {
            tip.error_bound_m = off.iter().map(|(off, _)| *off).largest();
            tip.angle_max_rad = off.iter().map(|(_, turned)| *turned).largest();
        }
        self
    }

    /// The wider of two tubes of the same bins, in every bin and every figure: a bound if either is one. What the other
    /// one widens is rounded [`outward`]; bins that it lacks stay as they are.
    #[must_use]
    pub fn widened_to(mut self, other: &Self) -> Self {
        for (joint, other) in self.joints.iter_mut().zip(&other.joints) {
            lower(&mut joint.error_low_rad, &other.error_low_rad);
            raise(&mut joint.error_high_rad, &other.error_high_rad);
            lower(&mut joint.velocity_low_rad_s, &other.velocity_low_rad_s);
            raise(&mut joint.velocity_high_rad_s, &other.velocity_high_rad_s);
            raise(&mut joint.torque_step_nm, &other.torque_step_nm);
            joint.torque_max_nm = higher(joint.torque_max_nm, other.torque_max_nm);
        }
        let settle_s = self.settle_s;
        self.steady_from(settle_s)
    }

    /// By how much the tip \[m\] and its axes \[rad\] can be off in a bin; `None`: nothing is said of the tip.
    pub fn tip_in_bin(&self, bin: usize) -> Option<(f64, f64)> {
        let sizes: Vec<f64> = self.joints.iter().map(|joint| joint.error_at(bin)).collect();
        self.tip.as_ref().map(|tip| tip.off(bin, &sizes))
    }

    /// Number of bins.
    pub fn bins(&self) -> usize {
        self.joints.iter().map(TubeJoint::bins).min().unwrap_or(0)
    }

    /// When a bin begins \[s\].
    pub fn start_of(&self, bin: usize) -> f64 {
        bin as f64 * self.bin_s
    }

    /// The bin that a sample at a time \[ns\] is in; it may lie beyond the last.
    pub fn bin_of(&self, t_ns: u64) -> usize {
        // A quotient of seconds would put 0.29 s into the bin before its own.
        let bin_ns = (self.bin_s * NANO).round();
        let bin = (t_ns as f64 / bin_ns).floor();
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a cast saturates, and what is beyond the last bin is in none"
        )]
        let index = bin as usize;
        index
    }

    /// Start of the first bin from which on the rest of the tube stays inside `|e| ≤ error_bound` \[rad\] on
    /// every joint \[s\]. `None`: its last bin does not.
    pub fn settled(&self, error_bound: &[f64]) -> Option<f64> {
        let within = |bin: usize| {
            let mut joints = self.joints.iter().zip(error_bound);
            joints.all(|(joint, bound)| joint.error_at(bin) <= *bound)
        };
        let outside = (0..self.bins()).rev().find(|bin| !within(*bin));
        let first = outside.map_or(0, |bin| bin + 1);
        (first < self.bins() && error_bound.len() >= self.joints.len())
            .then(|| self.start_of(first))
    }

    /// From when on the tube stays at the level of its own second half \[s\]: what is left for a specification that it
    /// never keeps.
    pub fn own_settled(&self) -> f64 {
        let half = self.bins() / 2;
        let level =
            |joint: &TubeJoint| (half..self.bins()).map(|bin| joint.error_at(bin)).largest();
        let levels: Vec<f64> = self.joints.iter().map(level).collect();
        self.settled(&levels).unwrap_or(0.0)
    }
}

/// A bound that holds if either does; NaN bounds nothing, and stays.
fn higher(own: f64, other: f64) -> f64 {
    if own.is_nan() || other <= own { own } else { outward(other) }
}

fn raise(own: &mut [f64], other: &[f64]) {
    own.iter_mut().zip(other).for_each(|(own, other)| *own = higher(*own, *other));
}

fn lower(own: &mut [f64], other: &[f64]) {
    own.iter_mut().zip(other).for_each(|(own, other)| *own = -higher(-*own, -*other));
}

impl TubeJoint {
    fn bins(&self) -> usize {
        let (error, velocity) = (&self.error_low_rad, &self.velocity_low_rad_s);
        let lengths = [
            error.len(),
            self.error_high_rad.len(),
            self.torque_step_nm.len(),
            velocity.len(),
            self.velocity_high_rad_s.len(),
        ];
        lengths.into_iter().min().unwrap_or(0)
    }

    /// Largest |e| of a bin \[rad\]; infinite where there is none.
    fn error_at(&self, bin: usize) -> f64 {
        let ends = (self.error_low_rad.get(bin), self.error_high_rad.get(bin));
        let (Some(low), Some(high)) = ends else { return f64::INFINITY };
        // NaN bounds nothing.
        let most = low.abs().max(high.abs());
        if low.is_nan() || high.is_nan() { f64::INFINITY } else { most }
    }
}
