//! Gains of one joint, as the document has them.

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
