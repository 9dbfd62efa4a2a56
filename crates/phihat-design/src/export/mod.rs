//! Gains for controllers that people already run: ROS 2, C, a table.
//!
//! Each file says what its target lacks against the controller that the certificate is about, and what is
//! claimed of it instead, in numbers.

mod c_header;
mod csv;
mod notes;
mod number;
mod pid;
mod ros;

pub use pid::{Pid, PidClaims};

use phihat::Form;
use thiserror::Error;

use crate::claims::Refutation;
use crate::{Gains, GainsError};

/// The format that gains are exported to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// Parameters (YAML) of the ROS 2 `joint_trajectory_controller` with effort commands: order 1 only.
    Ros,
    /// Constants for C99 and C++.
    CHeader,
    /// A table, one row per joint; notes in lines that begin with `#`.
    Csv,
}

/// Why gains cannot be exported.
#[derive(Debug, Error)]
pub enum ExportError {
    /// Not gains that the core runs.
    #[error("{0}")]
    Gains(#[from] GainsError),
    /// No joint.
    #[error("there is no joint in these gains")]
    NoJoints,
    /// Two joints have one name.
    #[error("two joints are named {0:?}")]
    SameName(String),
    /// The certificate does not hold.
    #[error("the certificate is refuted: {0}")]
    Refuted(Refutation),
    /// The estimator integrates more than once.
    #[error(
        "joint {joint}: its estimator has order {order}, which integrates the error {order} times; the PID of \
         ROS 2 controllers does so once\n  = help: design with `orders = [1]` under [design], or take \
         --format c-header and run the law of order {order}"
    )]
    Order {
        /// The joint.
        joint: String,
        /// Order of its estimator.
        order: usize,
    },
    /// The rate is no whole number.
    #[error("rate_hz is {0}; a ROS 2 controller manager runs at a whole number of Hz")]
    Rate(f64),
    /// Without the torque that acted, the same gains do not hold the arm.
    #[error(
        "as a PID these gains do not hold the arm: {0}\n  = help: the certificate is about the observer form, \
         which knows the torque that acted; design with `form = \"literal\"` under [loop], or raise \
         design.window_margin"
    )]
    Pid(Refutation),
}

/// Writes gains for a target.
///
/// # Method
///
/// The certificate, if there is one, is checked first. For order 1 the claims about the PID are found anew
/// ([`PidClaims`]), since it is the literal form, without knowledge of the torque that acted.
///
/// # Errors
///
/// [`ExportError`].
///
/// # Example
///
/// ```
/// use phihat_design::Gains;
/// use phihat_design::export::{Target, export};
///
/// # let text = r#"{
/// #   "format": "phihat-gains", "version": 2, "study": "pendulum", "study_sha256": "",
/// #   "rate_hz": 1000.0, "method": "by hand",
/// #   "joints": [{
/// #     "name": "pivot", "inertia_kg_m2": 0.25, "kp_per_s2": 400.0, "kd_per_s": 40.0, "a": [4900.0, 140.0]
/// #   }]
/// # }"#;
/// # let gains = Gains::from_json(text)?;
/// let header = export(&gains, Target::CHeader)?;
/// assert!(header.starts_with("/*") && header.contains("pivot"));
/// // The PID of ROS 2 integrates once; these gains have an estimator of order 2.
/// assert!(export(&gains, Target::Ros).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn export(gains: &Gains, target: Target) -> Result<String, ExportError> {
    check(gains)?;
    match target {
        Target::Ros => ros::text(gains),
        Target::CHeader => Ok(c_header::text(gains)),
        Target::Csv => Ok(csv::text(gains)),
    }
}

fn check(gains: &Gains) -> Result<(), ExportError> {
    let names: Vec<String> = gains.joints.iter().map(|j| j.name.clone()).collect();
    if names.is_empty() {
        return Err(ExportError::NoJoints);
    }
    let again = |(i, name): (usize, &String)| names[..i].contains(name);
    if let Some((_, name)) = names.iter().enumerate().find(|entry| again(*entry)) {
        return Err(ExportError::SameName(name.clone()));
    }
    gains.joint_gains(&names, period_ns(gains)?, Form::Observer)?;
    match &gains.certificate {
        Some(certificate) => certificate.verify(gains).map_err(ExportError::Refuted),
        None => Ok(()),
    }
}

/// The period \[s\] of the core.
fn period(gains: &Gains) -> f64 {
    period_ns(gains).map_or(f64::NAN, |ns| ns as f64 * 1e-9)
}

/// The period as the core counts it.
fn period_ns(gains: &Gains) -> Result<u64, ExportError> {
    let period = (1e9 / gains.rate_hz).round();
    if !(1.0..=1e12).contains(&period) {
        return Err(ExportError::Gains(GainsError::Rate { found: gains.rate_hz, expected: 1e3 }));
    }
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 1 and 1e12, a whole number"
    )]
    Ok(period as u64)
}
