//! Gains behind an encoder that is coarser than the one they were made for.

use serde::{Deserialize, Serialize};

/// The tube of gains where every encoder has fewer bits than the study says. Informs: no claim, and nothing checks it.
///
/// Without limits of torque rate: whether they would act is what [`Self::torque_step_max_nm`] says beside them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CoarserEncoder {
    /// Number of bits that each encoder has less.
    pub bits_fewer: u32,
    /// Largest |e| of each joint from the settling time on \[rad\]; empty: there is no tube.
    #[serde(alias = "error_max_rad")]
    pub error_bound_rad: Vec<f64>,
    /// Largest change of each joint's torque from one sample to the next \[N·m\]; empty: there is no tube.
    pub torque_step_max_nm: Vec<f64>,
    /// True if no limit of torque rate can act, so that the errors hold with the study's limits too.
    pub within_rate_limits: bool,
    /// Why there is no tube.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refused: Option<String>,
}
