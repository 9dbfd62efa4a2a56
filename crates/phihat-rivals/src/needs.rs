//! Needs of a rival, as data.

use core::fmt;

use serde::{Deserialize, Serialize};

/// Declared needs of a rival, read from its types.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[allow(clippy::struct_excessive_bools, reason = "independent facts, each a column of a table")]
pub struct Needs {
    /// Measured velocity.
    pub velocity: bool,
    /// The torque that acted.
    pub torque: bool,
    /// The torque that was last commanded, within its limits.
    #[serde(default)]
    pub commanded: bool,
    /// Derivatives of the reference, 0 to 2.
    pub derivatives: u8,
    /// The reference's acceleration in the interval in which the torque of a sample will act.
    pub preview: bool,
    /// The loop's delay, in samples.
    pub delay: bool,
    /// One nominal inertia per joint, in the law itself.
    pub inertia: bool,
    /// Gains that were designed for the arm's range of inertia and a bound on its load.
    pub designed: bool,
    /// A filter on the innovation that was designed for what bounds along the task say of the arm.
    #[serde(default)]
    pub filter: bool,
    /// One nominal viscous friction per joint.
    pub friction: bool,
    /// One identified dry friction per joint.
    #[serde(default)]
    pub dry: bool,
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
        commanded: false,
        derivatives: 0,
        preview: false,
        delay: false,
        inertia: false,
        designed: false,
        filter: false,
        friction: false,
        dry: false,
        gravity: false,
        model: false,
        regressor: false,
        limits: false,
        period: false,
        orbit: false,
        task: false,
    };

    /// Needs of both together.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        let derivatives =
            if self.derivatives > other.derivatives { self.derivatives } else { other.derivatives };
        Self {
            velocity: self.velocity || other.velocity,
            torque: self.torque || other.torque,
            commanded: self.commanded || other.commanded,
            derivatives,
            preview: self.preview || other.preview,
            delay: self.delay || other.delay,
            inertia: self.inertia || other.inertia,
            designed: self.designed || other.designed,
            filter: self.filter || other.filter,
            friction: self.friction || other.friction,
            dry: self.dry || other.dry,
            gravity: self.gravity || other.gravity,
            model: self.model || other.model,
            regressor: self.regressor || other.regressor,
            limits: self.limits || other.limits,
            period: self.period || other.period,
            orbit: self.orbit || other.orbit,
            task: self.task || other.task,
        }
    }

    /// Returns true if nothing of the arm's dynamics or kinematics is known: one nominal inertia and friction
    /// per joint and the limits of its drives are not counted as a model.
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
            (self.commanded, "commanded torque"),
            (self.derivatives == 1, "reference to velocity"),
            (self.derivatives == 2, "reference to acceleration"),
            (self.preview, "preview of it"),
            (self.delay, "delay"),
            (self.inertia, "inertia per joint"),
            (self.designed, "designed gains"),
            (self.filter, "designed filter"),
            (self.friction, "friction per joint"),
            (self.dry, "dry friction per joint"),
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
