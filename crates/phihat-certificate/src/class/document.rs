//! The bound for a class of motions as data.

use serde::{Deserialize, Serialize};

use crate::{FrozenPayload, TubePayloadSet};

/// Bounds on the error of every motion of a class, for all time.
///
/// # Claim
///
/// Let `q_d` stay in the box, with `|q̇_d|`, `|q̈_d|`, `|q⃛_d|` at most the class's, joint by joint; it need not be
/// known in advance. Let the arm start at rest on it, held by the torque that balances it, with position and first
/// reading off by at most `reading_rad`. For every payload of the set, forces of any course in time with
/// `|f_i| ≤ force_nm_i`, and reading errors of any sequence with `|n_i| ≤ reading_rad_i`, at all times
///
/// ```text
/// |e_i| ≤ error_bound_rad_i,            |ė_i| ≤ velocity_error_bound_rad_s_i,
/// |τ_i,k − τ_i,k−1| ≤ torque_step_nm_i,   |τ_i| ≤ torque_nm_i
/// ```
///
/// as long as no limit acts, and none can where `torque_step_nm` and `torque_nm` are within the limits.
///
/// With a supervisor ([`Self::is_supervised`]) the same holds from each start of its law on, for every sequence of
/// requests and of references, as long as the mode is holding or tracking: it keeps the reference in the class. The
/// start may then be out of balance by `start_nm`, for at most `start_s` before the law's first sample. Samples come in
/// time, and no fault is reported; in a safe stop the claim ends.
///
/// With [`signals`](Self::signals) the same holds with these imperfections of stiction, sampling and commands.
///
/// # Not claimed
///
/// The maxima over box and payloads are the largest of a search (assumption C8 of docs/theory/class.md), not proved.
/// What the certificate lists as not counted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClassBound {
    /// Box of the reference \[rad\]: low and high ends per joint.
    pub box_rad: (Vec<f64>, Vec<f64>),
    /// Largest `|q̇_d|` \[rad/s\] per joint.
    pub speed_max_rad_s: Vec<f64>,
    /// Largest `|q̈_d|` \[rad/s²\] per joint.
    pub acceleration_max_rad_s2: Vec<f64>,
    /// Largest `|q⃛_d|` \[rad/s³\] per joint.
    pub jerk_max_rad_s3: Vec<f64>,
    /// The payloads.
    pub payload: TubePayloadSet,
    /// Level of forces of any course in time \[N·m\] per joint: dry friction, pushes.
    pub force_nm: Vec<f64>,
    /// Torque by which a start may be out of balance \[N·m\] per joint; empty: by none, and no supervisor.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub start_nm: Vec<f64>,
    /// Time for which it may be so before the first sample of the law \[s\].
    #[serde(default, skip_serializing_if = "is_zero")]
    pub start_s: f64,
    /// Largest error of a reading \[rad\] per joint.
    pub reading_rad: Vec<f64>,
    /// Imperfections that it counts beside forces and errors of readings; `None`: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub signals: Option<ClassSignals>,
    /// Bound on `|e|` \[rad\] per joint.
    #[serde(alias = "error_rad")]
    pub error_bound_rad: Vec<f64>,
    /// Bound on `|ė|` \[rad/s\] per joint.
    #[serde(alias = "velocity_error_rad_s")]
    pub velocity_error_bound_rad_s: Vec<f64>,
    /// Bound on the change of the commanded torque per sample \[N·m\], per joint.
    pub torque_step_nm: Vec<f64>,
    /// Bound on the torque \[N·m\] per joint.
    pub torque_nm: Vec<f64>,
    /// Bound on `|e|` of an arm whose posture were frozen \[rad\] per joint: informs.
    #[serde(alias = "frozen_error_rad")]
    pub frozen_error_bound_rad: Vec<f64>,
    /// Spectral radius of the matrix by which an error adds to itself: the class closes where it is below 1.
    pub spectral_radius: f64,
    /// Postures at which the loop was summed up.
    pub postures: u32,
    /// Points of class and payloads at which torque rates were looked at.
    pub points: u32,
    /// Search by which the postures were found, in words.
    pub source: String,
    /// Postures that set the error of a joint.
    pub witnesses: Vec<ClassWitness>,
    /// The same laws at other paces; informs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub paces: Vec<ClassPace>,
    /// Parts of the bounds on error and torque step, effect by effect; inform.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<ClassPart>,
}

/// Part of the bounds for a class that one effect makes, at the postures that set them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClassPart {
    /// Effect, in words.
    pub name: String,
    /// Part of the bound on `|e|` \[rad\] per joint.
    pub error_bound_rad: Vec<f64>,
    /// Part of the bound on the change of the commanded torque per sample \[N·m\], per joint.
    pub torque_step_nm: Vec<f64>,
}

/// Imperfect signals that a bound for a class counts, as docs/theory/class.md has them (C12 to C14).
///
/// Joint by joint, stiction of bristles that are damped is a force of any course with
/// `|f| ≤ max(stiction_nm, stiction_nm_s_rad |q̇|)`, of which `force_nm` has the first part.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClassSignals {
    /// Breakaway level \[N·m\] per joint; 0 without stiction.
    pub stiction_nm: Vec<f64>,
    /// Force of the bristles' damping per speed \[N·m·s/rad\] per joint, `σ_1 (1 + ρ)`.
    pub stiction_nm_s_rad: Vec<f64>,
    /// Amplitude of cogging \[N·m\] per joint, which goes with the sine of the joint's angle; empty without any.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cogging_nm: Vec<f64>,
    /// Periods of cogging per radian of the sine's argument, as `sin(n q)` counts them, per joint.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cogging_per_turn: Vec<f64>,
    /// Most that a sample is taken early \[s\].
    pub jitter_s: f64,
    /// True if the law compares a reading with the reference of the time that its stamp has; else nobody knows when a
    /// sample was taken.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    pub stamped: bool,
    /// Most commands that are lost in a row; 0: none is.
    pub commands_lost: u32,
    /// Least time between the starts of two such rows \[s\]; 0 where none is lost.
    pub lost_every_s: f64,
}

impl ClassSignals {
    /// Returns true if nothing is imperfect.
    pub fn is_perfect(&self) -> bool {
        let none = |list: &[f64]| list.iter().all(|own| *own <= 0.0);
        none(&self.stiction_nm)
            && none(&self.stiction_nm_s_rad)
            && none(&self.cogging_nm)
            && self.jitter_s <= 0.0
            && self.commands_lost == 0
    }
}

/// A posture that sets the error of a joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClassWitness {
    /// Joint positions \[rad\].
    pub q_rad: Vec<f64>,
    /// Payload of the arm there; `None`: no payload.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub payload: Option<FrozenPayload>,
    /// Names of the joints whose error it sets.
    pub joints: Vec<String>,
}

/// Bounds for the class run at another pace: speed times the factor, acceleration times its square, jerk times its
/// cube.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClassPace {
    /// Factor on the speed.
    pub factor: f64,
    /// Largest bound on `|e|` of a joint \[rad\]; `None`: the class does not close.
    #[serde(alias = "error_rad")]
    pub error_bound_rad: Option<f64>,
    /// Largest bound on the change of torque per sample \[N·m\]; `None`: the class does not close.
    pub torque_step_nm: Option<f64>,
    /// Spectral radius of the matrix by which an error adds to itself.
    pub spectral_radius: f64,
}

impl ClassBound {
    /// Returns true if the bound is about an arm with a supervisor, which keeps the reference in the class.
    pub fn is_supervised(&self) -> bool {
        self.start_s > 0.0
    }

    /// Returns true if a supervisor that keeps references in this box, with these largest speeds, accelerations and
    /// jerks, keeps them in the class.
    pub fn covers(
        &self,
        reference_box: Option<&[Vec<f64>; 2]>,
        motion: Option<&[Vec<f64>; 3]>,
    ) -> bool {
        let within = |own: &[f64], most: &[f64]| {
            own.len() == most.len() && own.iter().zip(most).all(|(own, most)| own <= most)
        };
        let (Some([low, high]), Some([speed, acceleration, jerk])) = (reference_box, motion) else {
            return false;
        };
        self.is_supervised()
            && within(&self.box_rad.0, low)
            && within(high, &self.box_rad.1)
            && within(speed, &self.speed_max_rad_s)
            && within(acceleration, &self.acceleration_max_rad_s2)
            && within(jerk, &self.jerk_max_rad_s3)
    }

    /// Largest error of a reading of a joint \[rad\], with what jitter adds to it: `N + (v + V) t_J`, or `N + V t_J`
    /// where samples are stamped; 0 for no such joint.
    pub fn reading(&self, joint: usize) -> f64 {
        let at = |list: &[f64]| list.get(joint).copied().unwrap_or(0.0);
        let early = self.signals.as_ref().map_or(0.0, |signals| signals.jitter_s);
        let stamped = self.signals.as_ref().is_some_and(|signals| signals.stamped);
        let speed = if stamped { 0.0 } else { at(&self.speed_max_rad_s) };
        at(&self.reading_rad) + early * (speed + at(&self.velocity_error_bound_rad_s))
    }

    /// The largest bound on `|e|` of a joint \[rad\], and the joint's index.
    pub fn worst(&self) -> Option<(usize, f64)> {
        let all = self.error_bound_rad.iter().copied().enumerate();
        all.max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_zero(x: &f64) -> bool {
    x.to_bits() == 0
}
