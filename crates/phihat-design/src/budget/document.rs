//! The error budget as data.

use serde::{Deserialize, Serialize};

use crate::TradeOff;

/// Error budget of a study, joint by joint: causes of the error, other laws, and changes that would help.
///
/// # Not claimed
///
/// Nothing here is a claim of a certificate: parts are figures of the search or of a separate tube, each for
/// the one law that is reported. A change that is listed as helping was designed for and judged as a study of
/// its own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Budget {
    /// The study.
    pub study: String,
    /// SHA-256 of its text, hexadecimal.
    pub study_sha256: String,
    /// True if gains satisfy every clause.
    pub feasible: bool,
    /// Result in plain words.
    pub words: Vec<String>,
    /// Basis of the parts; `None`: there is no law to evaluate.
    pub basis: Option<BudgetBasis>,
    /// One entry per joint, in the robot's order.
    pub joints: Vec<JointBudget>,
    /// The laws that no other beats in both error and torque noise, ascending in noise: estimates of the search.
    pub front: Vec<TradeOff>,
    /// Changes that were tried.
    pub changes: Vec<TriedChange>,
}

/// Basis of the parts of a budget.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BudgetBasis {
    /// The tube: one figure for each cause alone, all else being ideal. Joints push each other.
    Tube,
    /// Each joint's own loop, as if the others stood still: sums of worst cases.
    OwnLoop,
}

/// Error budget of one joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointBudget {
    /// The joint.
    pub name: String,
    /// True if it is prismatic: figures are in metres then.
    pub prismatic: bool,
    /// Error that the study allows \[rad; m\].
    #[serde(alias = "allowed_rad")]
    pub error_bound_rad: Option<f64>,
    /// All causes together \[rad; m\]; `None`: no figure.
    pub total_rad: Option<f64>,
    /// The causes.
    pub parts: Vec<BudgetPart>,
}

/// Part of the error from one cause.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BudgetPart {
    /// The cause.
    pub cause: Cause,
    /// Error from this cause alone \[rad; m\]; of a cause that is within the others, the reduction of the
    /// total without it.
    pub error_rad: f64,
    /// True if it is within the others: such parts are not in the sum.
    pub within: bool,
}

/// Why there is an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// Gravity, inertia and speed along the reference: the smooth part of φ. By a tube, with what the sampled
    /// reference costs.
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
    /// Initial error that remains when the bound begins to apply.
    Start,
    /// Interaction of the causes, joints that push each other included: total less the sum of those alone.
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
    /// Change in words: "2 times slower".
    pub change: String,
    /// Key of the study, and the value that it gets there.
    pub key: String,
    /// The value, as it is written in a study.
    pub value: String,
    /// True if there are gains then that satisfy every clause.
    pub helps: bool,
    /// Share of the allowed error that those gains use, on the joint that decides, by their certificate.
    pub error_share: Option<f64>,
}

impl JointBudget {
    /// A cause's part, if there is one.
    pub fn part(&self, cause: Cause) -> Option<f64> {
        self.parts.iter().find(|part| part.cause == cause).map(|part| part.error_rad)
    }
}
