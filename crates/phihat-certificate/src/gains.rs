//! The gains document: what a controller needs, as one versioned JSON file.

use phihat::{Form, GainError, InnovationSection, JointDesign, JointGains, PositionDesign};
use phihat_model::input::plain;
use phihat_study::Study;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::{
    Certificate, CoarserEncoder, JointLimit, JointRecord, LoopModel, PositionObserver, TradeOff,
};

/// Value of `format` in every gains document.
pub const FORMAT: &str = "phihat-gains";

/// The version of the document's shape that this crate writes and reads.
pub const VERSION: u32 = 3;

/// The whole document, `gains.json`.
///
/// # Example
///
/// ```
/// use phihat::Form;
/// use phihat_certificate::Gains;
///
/// let text = r#"{
///   "format": "phihat-gains", "version": 3, "study": "pendulum", "study_sha256": "",
///   "rate_hz": 1000.0, "method": "by hand",
///   "joints": [{
///     "name": "pivot", "inertia_kg_m2": 0.25, "kp_per_s2": 400.0, "kd_per_s": 40.0, "a": [4900.0, 140.0]
///   }]
/// }"#;
/// let gains = Gains::from_json(text)?;
///
/// // Bound by joint names and loop rate: gains of another arm, or for another rate, are refused.
/// let law = gains.joint_gains(&["pivot".to_owned()], 1_000_000, Form::Observer)?;
/// assert_eq!(law[0].order(), 2);
/// assert!(gains.joint_gains(&["elbow".to_owned()], 1_000_000, Form::Observer).is_err());
///
/// // Written and read again, every number has the same bits.
/// assert_eq!(Gains::from_json(&gains.to_json()?)?, gains);
/// # Ok::<(), phihat_certificate::GainsError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gains {
    /// Always `"phihat-gains"`.
    pub format: String,
    /// Version of the document's shape.
    pub version: u32,
    /// Name of the study the gains were made from.
    pub study: String,
    /// SHA-256 of that study's text, hexadecimal.
    pub study_sha256: String,
    /// Loop rate the gains were made for \[Hz\].
    pub rate_hz: f64,
    /// Method that gave the gains, in words: for people.
    pub method: String,
    /// Cut-off of the velocity's low-pass \[Hz\] where the design chose it; `None`: the study's own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity_filter_hz: Option<f64>,
    /// Cut-off of the low-pass on the torque command \[Hz\]; `None`: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub torque_filter_hz: Option<f64>,
    /// One entry per joint, in the robot's order.
    pub joints: Vec<JointRecord>,
    /// Names of the joints that slide, where there are any: of them, rad reads m, and N·m reads N.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sliding: Vec<String>,
    /// Claims about the gains, with their evidence.
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        with = "crate::certificate::document"
    )]
    pub certificate: Option<Certificate>,
    /// Torque noise of laws with other errors, ascending in noise; empty where nothing was searched.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub trade_off: Vec<TradeOff>,
    /// Comparison of each joint's law with the limit of linear laws; informs, and empty where not requested.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub limit: Vec<JointLimit>,
    /// The tube with coarser encoders, the least coarse first; informs, and empty where there is no tube or
    /// no encoder.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub coarser: Vec<CoarserEncoder>,
}

/// Why a gains document cannot be used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum GainsError {
    /// Not JSON, or not of this shape.
    #[error("not gains: {}; `phihat design` writes gains", plain(&.0.to_string()))]
    Json(#[from] serde_json::Error),
    /// Another kind of document.
    #[error("format is {found:?}; {FORMAT:?} is expected")]
    Format {
        /// Format in the document.
        found: String,
    },
    /// Written by another version.
    #[error("version is {found}; this program reads version {VERSION}")]
    Version {
        /// Version in the document.
        found: u32,
    },
    /// The joints are not those of the robot, in its order.
    #[error("the gains are for joints {found}; the robot has {expected}")]
    Joints {
        /// Names in the document.
        found: String,
        /// Names of the robot.
        expected: String,
    },
    /// Two joints have one name.
    #[error("joint {joint} is there twice; every joint has a name of its own")]
    Twice {
        /// Name of the joint.
        joint: String,
    },
    /// Made for another loop rate.
    #[error("the gains are for a loop at {found} Hz; the study runs at {expected} Hz")]
    Rate {
        /// Rate in the document.
        found: f64,
        /// Rate of the study.
        expected: f64,
    },
    /// A law of another form.
    #[error(
        "joint {joint}: the loop's form is {form:?}, which these gains are not for: those with an `observer` are for \
         \"positions\", those with `a` for the others"
    )]
    Form {
        /// Name of the joint.
        joint: String,
        /// Form of the loop.
        form: &'static str,
    },
    /// The study leaves the velocity filter to the design.
    #[error("the study leaves sensor.velocity_filter_hz to the design, and the gains carry none")]
    NoFilter,
    /// The core refuses a joint's gains.
    #[error("joint {joint}: {error}")]
    Joint {
        /// Name of the joint.
        joint: String,
        /// Why the core refuses them.
        error: GainError,
    },
}

impl Gains {
    /// Gains for a loop at this rate \[Hz\], of no study, about which nothing is claimed. `method` says how
    /// they were found.
    pub fn stated(joints: Vec<JointRecord>, rate_hz: f64, method: impl Into<String>) -> Self {
        Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            study: String::new(),
            study_sha256: String::new(),
            rate_hz,
            method: method.into(),
            velocity_filter_hz: None,
            torque_filter_hz: None,
            joints,
            sliding: Vec::new(),
            certificate: None,
            trade_off: Vec::new(),
            limit: Vec::new(),
            coarser: Vec::new(),
        }
    }

    /// Gains for a study, about which nothing is claimed yet.
    pub fn of(study: &Study, joints: Vec<JointRecord>, method: impl Into<String>) -> Self {
        let stated = Self::stated(joints, 1e9 / study.control.period_ns as f64, method);
        let sliding = study.robot.sliding();
        let torque_filter_hz = study.control.torque_filter_hz;
        let (study, study_sha256) = (study.name.clone(), study.sha256.clone());
        Self { study, study_sha256, torque_filter_hz, sliding, ..stated }
    }

    /// Returns true if a joint slides.
    pub fn slides(&self, joint: &str) -> bool {
        self.sliding.iter().any(|name| name == joint)
    }

    /// Reads a document.
    ///
    /// # Errors
    ///
    /// [`GainsError`]: not JSON, unknown or missing keys (with line and column), another format or
    /// version, a joint that is there twice.
    pub fn from_json(text: &str) -> Result<Self, GainsError> {
        let gains: Self = serde_json::from_str(text)?;
        if gains.format != FORMAT {
            return Err(GainsError::Format { found: gains.format });
        }
        if gains.version != VERSION {
            return Err(GainsError::Version { found: gains.version });
        }
        for (i, joint) in gains.joints.iter().enumerate() {
            if gains.joints[..i].iter().any(|other| other.name == joint.name) {
                return Err(GainsError::Twice { joint: joint.name.clone() });
            }
        }
        Ok(gains)
    }

    /// The document as text, for people and machines.
    ///
    /// # Errors
    ///
    /// [`GainsError::Json`], when a number is not finite.
    pub fn to_json(&self) -> Result<String, GainsError> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }

    /// The controller's gains for a robot, bound by joint name and order.
    ///
    /// # Errors
    ///
    /// [`GainsError`]: joints or rate differ, or the core refuses a joint's gains.
    pub fn joint_gains(
        &self,
        names: &[String],
        period_ns: u64,
        form: Form,
    ) -> Result<Vec<JointGains<f64>>, GainsError> {
        let own: Vec<&str> = self.joints.iter().map(|j| j.name.as_str()).collect();
        if own.iter().ne(names) {
            return Err(GainsError::Joints { found: own.join(", "), expected: names.join(", ") });
        }
        let expected = 1e9 / period_ns as f64;
        if (self.rate_hz - expected).abs() > 1e-9 * expected {
            return Err(GainsError::Rate { found: self.rate_hz, expected });
        }
        let period = period_ns as f64 * 1e-9;
        let joint = |record: &JointRecord| {
            let refused = |error| GainsError::Joint { joint: record.name.clone(), error };
            if record.observer.is_some() != (form == Form::Positions) {
                return Err(GainsError::Form { joint: record.name.clone(), form: word(form) });
            }
            let gains = record.core_gains(form, period);
            gains.and_then(|own| own.with_torque_filter(self.torque_filter_hz)).map_err(refused)
        };
        self.joints.iter().map(joint).collect()
    }
}

impl JointRecord {
    /// The core's gains of this law in a loop, without limits.
    ///
    /// # Errors
    ///
    /// [`GainError`]: numbers that the core refuses, or those of another form.
    pub fn core_gains_in(&self, model: &LoopModel) -> Result<JointGains<f64>, GainError> {
        let gains = self.core_gains(self.form_or(model.form), model.period_s)?;
        gains.with_torque_filter(model.torque_filter_hz)
    }

    /// The core's gains for these numbers, in a form, at a sample period \[s\], without limits and low-pass:
    /// [`Self::core_gains_in`] has the latter.
    ///
    /// # Errors
    ///
    /// [`GainError`]: numbers that the core refuses, or those of another form.
    pub fn core_gains(&self, form: Form, period: f64) -> Result<JointGains<f64>, GainError> {
        match (&self.observer, form) {
            (Some(own), Form::Positions) => own.gains(self, period),
            (None, Form::Observer | Form::Literal) => JointGains::new(&JointDesign {
                inertia: self.inertia_kg_m2,
                kp: self.kp_per_s2,
                kd: self.kd_per_s,
                a: &self.a,
                period,
                form,
            }),
            _ => Err(GainError::Form),
        }
    }
}

impl PositionObserver {
    /// The core's gains of a law from positions.
    pub(crate) fn gains(
        &self,
        record: &JointRecord,
        period: f64,
    ) -> Result<JointGains<f64>, GainError> {
        let gains = JointGains::from_positions(&PositionDesign {
            inertia: record.inertia_kg_m2,
            kp: record.kp_per_s2,
            kd: record.kd_per_s,
            correction: &self.correction,
            velocity_correction: &[],
            share: self.share,
            delay: self.delay_samples as usize,
            period,
        })?;
        if self.innovation_filter.is_empty() {
            return Ok(gains);
        }
        let sections: Vec<InnovationSection> =
            self.innovation_filter.iter().map(Into::into).collect();
        gains.with_innovation_filter(&sections)
    }
}

/// A form as studies spell it.
fn word(form: Form) -> &'static str {
    match form {
        Form::Observer => "observer",
        Form::Literal => "literal",
        Form::Positions => "positions",
    }
}
