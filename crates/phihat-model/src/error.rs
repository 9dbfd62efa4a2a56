//! Errors of a robot, with their places.

use thiserror::Error;

use crate::input::plain;

/// Why a model could not be changed as asked.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ModelError {
    /// Rotor inertia that no rotors have.
    #[error("armature {given:?} must be {joints} finite values of at least 0 kg·m², one per joint")]
    Armature {
        /// The values given.
        given: Vec<f64>,
        /// Number of joints.
        joints: usize,
    },
    /// A factor on masses that leaves no body.
    #[error("{0} times the masses: a factor above 0 and finite is valid")]
    MassFactor(f64),
    /// A payload that no body has.
    #[error("payload on frame \"{frame}\": {why}")]
    Payload {
        /// Frame the body was to be welded to.
        frame: String,
        /// Reason of the refusal.
        why: NotRigid,
    },
    /// A payload on a frame that the robot has not.
    #[error("payload on frame \"{0}\": there is no frame of this name")]
    PayloadFrame(String),
}

/// Why no rigid body has these figures: one clause, without the body's name.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum NotRigid {
    /// A mass below 0, or none \[kg\].
    #[error("mass is {0} kg; it must be finite and at least 0")]
    Mass(f64),
    /// Not a number, or an infinite one.
    #[error("centre of mass and inertia must be finite numbers")]
    NotFinite,
    /// An inertia about which some axis turns with less than nothing \[kg·m²\].
    #[error(
        "inertia {0:?} (xx, xy, xz, yy, yz, zz) has a negative principal moment; all three must be at least 0: \
            products of inertia (xy, xz, yz) this large belong to no body with this diagonal"
    )]
    Inertia([f64; 6]),
}

/// Why a robot could not be read. `origin` is the file, or what stands for it.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RobotError {
    /// The file could not be read.
    #[error("{origin}: cannot be read: {source}")]
    Read {
        /// File.
        origin: String,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The file is larger than any description of an arm.
    #[error("{origin}: {found} {what}, more than the {limit} that are read")]
    TooMuch {
        /// File.
        origin: String,
        /// Kind of the items of which there are too many.
        what: &'static str,
        /// Amount found, at least.
        found: usize,
        /// Largest amount that is read.
        limit: usize,
    },
    /// The text is not XML, or not XML of the plain kind a URDF is.
    #[error("{origin}:{line}: {why}")]
    Xml {
        /// File.
        origin: String,
        /// Line, from 1.
        line: u32,
        /// Description of the error.
        why: String,
    },
    /// A link that is not one.
    #[error("{origin}:{line}: link \"{link}\": {why}")]
    Link {
        /// File.
        origin: String,
        /// Line, from 1.
        line: u32,
        /// Link's name.
        link: String,
        /// Description of the error, and what would be valid.
        why: String,
    },
    /// A joint that is not one.
    #[error("{origin}:{line}: joint \"{joint}\": {why}")]
    Joint {
        /// File.
        origin: String,
        /// Line, from 1.
        line: u32,
        /// Joint's name.
        joint: String,
        /// Description of the error, and what would be valid.
        why: String,
    },
    /// No link that a joint moves has mass: the description is one of motion only, as those of many industrial arms.
    #[error(
        "{origin}:{line}: joint \"{joint}\": it moves no mass, and no other joint does: the file has no <inertial>, so \
            it describes motion only; `phihat new` writes a study of such an arm, with each joint's inertia as an \
            interval to fill in"
    )]
    NoInertia {
        /// File.
        origin: String,
        /// Line of the joint, from 1.
        line: u32,
        /// Name of the first joint.
        joint: String,
    },
    /// More joints move than an arm has: an arm of them has to be chosen.
    #[error("{origin}: {why}")]
    SeveralArms {
        /// File.
        origin: String,
        /// Number of joints, and an arm that could be chosen.
        why: String,
    },
    /// The links and joints do not form one tree.
    #[error("{origin}: {why}")]
    Tree {
        /// File.
        origin: String,
        /// Description of the error, with the links concerned.
        why: String,
    },
    /// The robot's TOML file is not one.
    #[error("{origin}: {why}")]
    Toml {
        /// File.
        origin: String,
        /// Description of the error, with line and column where known.
        why: String,
    },
    /// A key of the robot's TOML file has a value that cannot be.
    #[error("{origin}: {key}: {why}")]
    Value {
        /// File.
        origin: String,
        /// Key, with its table.
        key: String,
        /// Description of the error, and what would be valid.
        why: String,
    },
    /// No arm of that name is built in.
    #[error("no built-in arm is called \"{name}\"{hint}; there are {}", known.join(", "))]
    Unknown {
        /// Name asked for.
        name: String,
        /// `, did you mean …?` or nothing.
        hint: String,
        /// Names of the arms that are.
        known: &'static [&'static str],
    },
    /// A joint was to be locked that is not there, or where it cannot be.
    #[error("cannot lock joint \"{joint}\" of {robot}: {why}")]
    Lock {
        /// Robot's name.
        robot: String,
        /// Joint's name.
        joint: String,
        /// Description of the error, and what would be valid.
        why: String,
    },
}

impl RobotError {
    /// The same with what a terminal would obey written out: what a file says is for reading.
    pub(crate) fn plain(mut self) -> Self {
        let texts = match &mut self {
            Self::Xml { why, .. }
            | Self::SeveralArms { why, .. }
            | Self::Tree { why, .. }
            | Self::Toml { why, .. }
            | Self::Value { why, .. } => vec![why],
            Self::Link { link, why, .. } => vec![link, why],
            Self::Joint { joint, why, .. } => vec![joint, why],
            Self::NoInertia { joint, .. } => vec![joint],
            Self::Lock { robot, joint, why } => vec![robot, joint, why],
            Self::Unknown { name, .. } => vec![name],
            Self::Read { .. } | Self::TooMuch { .. } => Vec::new(),
        };
        for text in texts {
            *text = plain(text);
        }
        self
    }
}
