//! Gains for controllers that people already run: ROS 2, C, a table.
//!
//! Each file says what its target lacks against the controller that the certificate is about, and what is
//! claimed of it instead, in numbers.

mod c_header;
mod csv;
mod error;
mod notes;
mod number;
mod period;
mod pid;
mod ros;

pub use error::ExportError;
pub use pid::{Pid, PidClaims};

use period::period_ns;
use phihat::Form;

use crate::Gains;

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
/// #   "format": "phihat-gains", "version": 3, "study": "pendulum", "study_sha256": "",
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
    let form = gains.joints.first().map_or(Form::Observer, |own| own.form_or(Form::Observer));
    gains.joint_gains(&names, period_ns(gains)?, form)?;
    match &gains.certificate {
        Some(certificate) => certificate.verify(gains).map_err(ExportError::Refuted),
        None => Ok(()),
    }
}
