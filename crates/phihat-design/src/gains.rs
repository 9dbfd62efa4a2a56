//! The gains document: what a controller needs, as one versioned JSON file.

use serde::{Deserialize, Serialize};

/// Gains of one joint, in SI units; see NOTATION.md.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointRecord {
    /// Joint name.
    pub name: String,
    /// Nominal inertia `M̄` \[kg·m²\].
    pub inertia_kg_m2: f64,
    /// Outer loop `K_p` \[1/s²\].
    pub kp_per_s2: f64,
    /// Outer loop `K_d` \[1/s\].
    pub kd_per_s: f64,
    /// Estimator coefficients `a_0 … a_{m−1}`, `a_i` in \[1/s^(m−i)\]; the length is the order `m`.
    pub a: Vec<f64>,
}

/// The whole document, `gains.json`.
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
    /// How they were found, in words: for people.
    pub method: String,
    /// One entry per joint, in the robot's order.
    pub joints: Vec<JointRecord>,
}
