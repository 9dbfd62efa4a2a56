//! The error budget as data.

use serde::{Deserialize, Serialize};

use crate::TradeOff;

/// What the error that a study allows is spent on, joint by joint, what other laws would do, and what changes would help.
///
/// # Not claimed
///
/// Nothing here is a claim of a certificate: parts are figures of the search or of a tube of their own, each for the one law that
/// is told. A change that is listed as helping was designed for and judged as a study of its own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Budget {
    /// The study.
    pub study: String,
    /// SHA-256 of its text, hexadecimal.
    pub study_sha256: String,
    /// Whether gains keep every clause.
    pub feasible: bool,
    /// What was found, in ordinary words.
    pub words: Vec<String>,
    /// Where the parts come from; `None`: there is no law that could be asked.
    pub basis: Option<BudgetBasis>,
    /// One entry per joint, in the robot's order.
    pub joints: Vec<JointBudget>,
    /// The laws that no other beats in both error and torque noise, ascending in noise: estimates of the search.
    pub front: Vec<TradeOff>,
    /// Changes that were tried.
    pub changes: Vec<TriedChange>,
}

/// What the parts of a budget are figures of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BudgetBasis {
    /// Of the tube: one for each cause alone, all else being ideal. Joints push each other.
    Tube,
    /// Of each joint's own loop, as if the others stood still: sums of worst cases.
    OwnLoop,
}

/// What one joint's error is made of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointBudget {
    /// The joint.
    pub name: String,
    /// Whether it slides: figures are in metres then.
    pub prismatic: bool,
    /// What the study allows \[rad; m\].
    pub allowed_rad: Option<f64>,
    /// All causes together \[rad; m\]; `None`: no figure.
    pub total_rad: Option<f64>,
    /// The causes.
    pub parts: Vec<Part>,
}

/// What one cause costs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// The cause.
    pub cause: Cause,
    /// What it costs alone \[rad; m\]; of a cause that is within the others, how much less the total would be without it.
    pub error_rad: f64,
    /// Whether it is within the others: such parts take no part in the sum.
    pub within: bool,
}

/// Why there is an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// Gravity, inertia and speed along the reference: the smooth part of φ. By a tube, with what the sampled reference costs.
    Motion,
    /// The interval of dry friction.
    Friction,
    /// The payload being somewhere in its interval.
    Payload,
    /// Declared pushes.
    Pushes,
    /// Steps of the encoder.
    Encoder,
    /// The reference's own motion, sampled and held.
    Reference,
    /// Measurements and torques that are late.
    Delay,
    /// What is left of the start when the bound begins to hold.
    Start,
    /// What the causes do to each other, joints that push each other included: total less the sum of those alone.
    Coupling,
}

impl Cause {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Motion => "smooth φ along the motion",
            Self::Friction => "dry friction",
            Self::Payload => "unknown payload",
            Self::Pushes => "pushes",
            Self::Encoder => "encoder",
            Self::Reference => "sampled reference",
            Self::Delay => "delay",
            Self::Start => "start",
            Self::Coupling => "coupling",
        }
    }
}

/// One change of a study, all else being equal, designed for as a study of its own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TriedChange {
    /// What is changed, in words: "2 times slower".
    pub change: String,
    /// Key of the study, and the value that it gets there.
    pub key: String,
    /// The value, as it is written in a study.
    pub value: String,
    /// Whether there are gains then that keep every clause.
    pub helps: bool,
    /// What of the allowed error those gains use, on the joint that decides, by their certificate.
    pub error_share: Option<f64>,
}

impl JointBudget {
    /// A cause's part, if there is one.
    pub fn part(&self, cause: Cause) -> Option<f64> {
        self.parts.iter().find(|part| part.cause == cause).map(|part| part.error_rad)
    }
}
