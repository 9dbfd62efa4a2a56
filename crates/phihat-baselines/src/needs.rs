//! What a rival needs, as types: it is handed nothing else.

use core::fmt::{self, Debug};

use serde::{Deserialize, Serialize};

use crate::error::Refusal;
use crate::knowledge::Supply;

/// Everything that there is at a control sample; slices have one entry per joint.
#[derive(Debug, Clone, Copy)]
pub struct All<'a> {
    /// Measured position \[rad\].
    pub q: &'a [f64],
    /// Measured velocity \[rad/s\].
    pub dq: &'a [f64],
    /// Torque that acted (mean) since the previous sample \[N·m\].
    pub tau: &'a [f64],
    /// Which joints' last torque met a limit.
    pub clipped: &'a [bool],
    /// Desired position \[rad\].
    pub q_d: &'a [f64],
    /// Desired velocity \[rad/s\].
    pub dq_d: &'a [f64],
    /// Desired acceleration \[rad/s²\].
    pub ddq_d: &'a [f64],
}

/// Measurements that a rival takes.
pub trait Sees<'a>: Sized {
    /// As data.
    const NEEDS: Needs;
    /// Takes them, and leaves the rest.
    fn of(all: &All<'a>) -> Self;
}

/// The reference and as many of its derivatives as a rival takes.
pub trait Wants<'a>: Sized {
    /// As data.
    const NEEDS: Needs;
    /// Takes them, and leaves the rest.
    fn of(all: &All<'a>) -> Self;
}

/// What a rival knows before it starts. Fields are private to this crate: a rival with [`Nothing`] cannot
/// come by a model.
pub trait Knows: Sized {
    /// As data.
    const NEEDS: Needs;
    /// Takes it, and leaves the rest.
    ///
    /// # Errors
    ///
    /// [`Refusal::NotApplicable`] when the supply does not have it.
    fn of(supply: &Supply) -> Result<Self, Refusal>;
}

/// Measured positions.
#[derive(Debug, Clone, Copy)]
pub struct Positions<'a> {
    /// \[rad\]
    pub q: &'a [f64],
}

/// Measured positions and velocities.
#[derive(Debug, Clone, Copy)]
pub struct Motion<'a> {
    /// \[rad\]
    pub q: &'a [f64],
    /// \[rad/s\]
    pub dq: &'a [f64],
}

/// Measured positions, and the torque that acted.
#[derive(Debug, Clone, Copy)]
pub struct PositionsAndTorque<'a> {
    /// \[rad\]
    pub q: &'a [f64],
    /// \[N·m\], mean since the previous sample.
    pub tau: &'a [f64],
}

/// Measured positions and velocities, and the torque that acted.
#[derive(Debug, Clone, Copy)]
pub struct MotionAndTorque<'a> {
    /// \[rad\]
    pub q: &'a [f64],
    /// \[rad/s\]
    pub dq: &'a [f64],
    /// \[N·m\], mean since the previous sample.
    pub tau: &'a [f64],
}

/// The desired position and velocity.
#[derive(Debug, Clone, Copy)]
pub struct Velocity<'a> {
    /// \[rad\]
    pub q: &'a [f64],
    /// \[rad/s\]
    pub dq: &'a [f64],
}

/// The desired position, velocity and acceleration.
#[derive(Debug, Clone, Copy)]
pub struct Acceleration<'a> {
    /// \[rad\]
    pub q: &'a [f64],
    /// \[rad/s\]
    pub dq: &'a [f64],
    /// \[rad/s²\]
    pub ddq: &'a [f64],
}

/// The clock alone: a rival that follows an orbit and not a time.
#[derive(Debug, Clone, Copy)]
pub struct NoReference;

impl<'a> Sees<'a> for Positions<'a> {
    const NEEDS: Needs = Needs::NONE;
    fn of(all: &All<'a>) -> Self {
        Self { q: all.q }
    }
}

impl<'a> Sees<'a> for Motion<'a> {
    const NEEDS: Needs = Needs { velocity: true, ..Needs::NONE };
    fn of(all: &All<'a>) -> Self {
        Self { q: all.q, dq: all.dq }
    }
}

impl<'a> Sees<'a> for PositionsAndTorque<'a> {
    const NEEDS: Needs = Needs { torque: true, ..Needs::NONE };
    fn of(all: &All<'a>) -> Self {
        Self { q: all.q, tau: all.tau }
    }
}

impl<'a> Sees<'a> for MotionAndTorque<'a> {
    const NEEDS: Needs = Needs { velocity: true, torque: true, ..Needs::NONE };
    fn of(all: &All<'a>) -> Self {
        Self { q: all.q, dq: all.dq, tau: all.tau }
    }
}

impl<'a> Wants<'a> for Velocity<'a> {
    const NEEDS: Needs = Needs { derivatives: 1, ..Needs::NONE };
    fn of(all: &All<'a>) -> Self {
        Self { q: all.q_d, dq: all.dq_d }
    }
}

impl<'a> Wants<'a> for Acceleration<'a> {
    const NEEDS: Needs = Needs { derivatives: 2, ..Needs::NONE };
    fn of(all: &All<'a>) -> Self {
        Self { q: all.q_d, dq: all.dq_d, ddq: all.ddq_d }
    }
}

impl Wants<'_> for NoReference {
    const NEEDS: Needs = Needs::NONE;
    fn of(_: &All<'_>) -> Self {
        Self
    }
}

/// No knowledge of the arm.
#[derive(Debug, Clone, Copy)]
pub struct Nothing;

impl Knows for Nothing {
    const NEEDS: Needs = Needs::NONE;
    fn of(_: &Supply) -> Result<Self, Refusal> {
        Ok(Self)
    }
}

impl<A: Knows, B: Knows> Knows for (A, B) {
    const NEEDS: Needs = A::NEEDS.and(B::NEEDS);
    fn of(supply: &Supply) -> Result<Self, Refusal> {
        Ok((A::of(supply)?, B::of(supply)?))
    }
}

/// What a rival declares to need, read from its types.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[allow(clippy::struct_excessive_bools, reason = "independent facts, each a column of a table")]
pub struct Needs {
    /// Measured velocity.
    pub velocity: bool,
    /// The torque that acted.
    pub torque: bool,
    /// Derivatives of the reference, 0 to 2.
    pub derivatives: u8,
    /// One nominal inertia per joint, in the law itself.
    pub inertia: bool,
    /// One nominal viscous friction per joint.
    pub friction: bool,
    /// The arm's gravity torque.
    pub gravity: bool,
    /// The arm's whole rigid-body model.
    pub model: bool,
    /// The arm's regressor: structure and geometry, not the parameters.
    pub regressor: bool,
    /// The arm's torque limits.
    pub limits: bool,
    /// The period of the task.
    pub period: bool,
    /// The path as a curve, beyond its value at the present time.
    pub orbit: bool,
    /// A measured position of the tip, and the form of the kinematics.
    pub task: bool,
}

impl Needs {
    /// Positions and nothing else.
    pub const NONE: Self = Self {
        velocity: false,
        torque: false,
        derivatives: 0,
        inertia: false,
        friction: false,
        gravity: false,
        model: false,
        regressor: false,
        limits: false,
        period: false,
        orbit: false,
        task: false,
    };

    /// What either needs.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        let derivatives =
            if self.derivatives > other.derivatives { self.derivatives } else { other.derivatives };
        Self {
            velocity: self.velocity || other.velocity,
            torque: self.torque || other.torque,
            derivatives,
            inertia: self.inertia || other.inertia,
            friction: self.friction || other.friction,
            gravity: self.gravity || other.gravity,
            model: self.model || other.model,
            regressor: self.regressor || other.regressor,
            limits: self.limits || other.limits,
            period: self.period || other.period,
            orbit: self.orbit || other.orbit,
            task: self.task || other.task,
        }
    }

    /// Whether nothing of the arm's dynamics or kinematics is known: one nominal inertia and friction per
    /// joint and the limits of its drives are not counted as a model.
    pub const fn model_free(&self) -> bool {
        !(self.gravity || self.model || self.regressor || self.task)
    }
}

impl fmt::Display for Needs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut words = vec!["q"];
        let flags = [
            (self.velocity, "dq"),
            (self.torque, "applied torque"),
            (self.derivatives == 1, "reference to velocity"),
            (self.derivatives == 2, "reference to acceleration"),
            (self.inertia, "inertia per joint"),
            (self.friction, "friction per joint"),
            (self.gravity, "gravity model"),
            (self.model, "model"),
            (self.regressor, "regressor"),
            (self.limits, "torque limits"),
            (self.period, "task period"),
            (self.orbit, "path"),
            (self.task, "tip position"),
        ];
        words.extend(flags.iter().filter(|(needed, _)| *needed).map(|(_, word)| *word));
        f.write_str(&words.join(", "))
    }
}

/// One nominal inertia `M̄` per joint \[kg·m²\].
#[derive(Debug, Clone)]
pub struct Inertia(Vec<f64>);

impl Inertia {
    /// `M̄` \[kg·m²\], one entry per joint.
    pub fn values(&self) -> &[f64] {
        &self.0
    }
}

impl Knows for Inertia {
    const NEEDS: Needs = Needs { inertia: true, ..Needs::NONE };
    fn of(supply: &Supply) -> Result<Self, Refusal> {
        Ok(Self(supply.inertia.clone()))
    }
}

/// The most torque of each joint \[N·m\].
#[derive(Debug, Clone)]
pub struct TorqueMax(Vec<f64>);

impl TorqueMax {
    /// \[N·m\], one entry per joint.
    pub fn values(&self) -> &[f64] {
        &self.0
    }
}

impl Knows for TorqueMax {
    const NEEDS: Needs = Needs { limits: true, ..Needs::NONE };
    fn of(supply: &Supply) -> Result<Self, Refusal> {
        match &supply.torque_max {
            Some(values) => Ok(Self(values.clone())),
            None => Err(Refusal::NotApplicable("the arm states no torque limits".to_owned())),
        }
    }
}

/// The limits of an arm that states them; a law that does without where there are none.
impl Knows for Option<TorqueMax> {
    const NEEDS: Needs = TorqueMax::NEEDS;
    fn of(supply: &Supply) -> Result<Self, Refusal> {
        Ok(supply.torque_max.clone().map(TorqueMax))
    }
}

/// The period of the task \[s\].
#[derive(Debug, Clone, Copy)]
pub struct Period(f64);

impl Period {
    /// \[s\]
    pub fn seconds(&self) -> f64 {
        self.0
    }
}

impl Knows for Period {
    const NEEDS: Needs = Needs { period: true, ..Needs::NONE };
    fn of(supply: &Supply) -> Result<Self, Refusal> {
        let missing = || Refusal::NotApplicable("the reference has no period".to_owned());
        supply.task_period.map(Self).ok_or_else(missing)
    }
}
