//! Range of an arm's inertia, which a constant nominal inertia has to cover.

use serde::{Deserialize, Serialize};

use crate::Searched;

/// The arm's inertia against a nominal one.
///
/// # Claim
///
/// Over the postures and payloads tried, all eigenvalues of `M̄^{-1/2} M(q) M̄^{-1/2}` lie in `[low, high]`, rotor
/// inertia included; the ends were then sought from the best of them, and are kept as witnesses.
///
/// # Not claimed
///
/// Postures that were not tried, unless [`Searched::proved`] bounds them. With an interval per joint, typed
/// or estimated: coupling between joints. An estimate from a trace is not a proof.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArmInertia {
    /// Kind of knowledge.
    pub basis: ArmBasis,
    /// Source of the range, in words.
    pub source: String,
    /// Nominal inertia `M̄` \[kg·m²\] per joint that the range is measured in.
    pub nominal_kg_m2: Vec<f64>,
    /// Smallest eigenvalue.
    pub low: f64,
    /// Largest eigenvalue.
    pub high: f64,
    /// Search that found the ends, where the range is that of a robot's description.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub searched: Option<Searched>,
}

/// Basis of the range of inertia.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ArmBasis {
    /// Postures of a robot's description.
    Postures,
    /// An interval per joint, typed.
    Typed,
    /// An interval per joint, estimated from a recorded trace.
    Trace,
}

impl ArmInertia {
    /// This range of inertia, measured in `scale` times the nominal inertias.
    #[must_use]
    pub fn scaled(&self, scale: f64) -> Self {
        Self {
            nominal_kg_m2: self.nominal_kg_m2.iter().map(|m| m * scale).collect(),
            low: self.low / scale,
            high: self.high / scale,
            searched: self.searched.as_ref().map(|searched| searched.scaled(scale)),
            ..self.clone()
        }
    }
}
