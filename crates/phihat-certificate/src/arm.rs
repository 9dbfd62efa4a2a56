//! What is known of an arm's inertia: the range that a constant nominal inertia has to stand for.

use serde::{Deserialize, Serialize};

/// The arm's inertia against a nominal one.
///
/// # Claim
///
/// Over the postures and payloads tried, all eigenvalues of `M̄^{-1/2} M(q) M̄^{-1/2}` lie in `[low, high]`, rotor
/// inertia included; the ends were then sought from the best of them, and are kept as witnesses.
///
/// # Not claimed
///
/// Postures that were not tried, unless [`Searched::proved`] bounds them. With an interval per joint, typed or estimated: coupling between joints. An
/// estimate from a trace is not a proof.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArmInertia {
    /// Kind of knowledge.
    pub basis: ArmBasis,
    /// Where the range comes from, in words.
    pub source: String,
    /// Nominal inertia `M̄` \[kg·m²\] per joint that the range is measured in.
    pub nominal_kg_m2: Vec<f64>,
    /// Smallest eigenvalue.
    pub low: f64,
    /// Largest eigenvalue.
    pub high: f64,
    /// How the ends were found, where the range is that of a robot's description.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub searched: Option<Searched>,
}

/// What the range of inertia rests on.
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
    /// The same arm measured in `scale` times the nominal inertias.
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

/// A posture at which the arm has an eigenvalue at an end of its range.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Witness {
    /// Posture \[rad, m\].
    pub q: Vec<f64>,
    /// Payload's mass \[kg\].
    pub mass_kg: f64,
    /// Its centre of mass \[m\].
    pub com_m: [f64; 3],
    /// Its inertia about the centre of mass, `xx, xy, xz, yy, yz, zz` \[kg·m²\].
    pub inertia_kg_m2: [f64; 6],
    /// Smallest or largest eigenvalue of `M̄^{-1/2} M(q) M̄^{-1/2}` there.
    pub eigenvalue: f64,
}

/// How the ends of a range were found.
///
/// # Claim
///
/// The arm has the two eigenvalues at the two witnesses: the range is no narrower than said. All postures and
/// payloads that were tried lie inside.
///
/// # Not claimed
///
/// That no posture lies outside, unless [`proved`](Self::proved) says how far one could.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Searched {
    /// Postures looked at, those of the reference among them.
    pub postures: u32,
    /// Postures of the reference among them.
    pub of_reference: u32,
    /// Postures from which each end was sought by coordinate ascent.
    pub starts: u32,
    /// Frame that the payload is welded to.
    pub frame: String,
    /// Where the smallest eigenvalue is.
    pub low: Witness,
    /// Where the largest is.
    pub high: Witness,
    /// What is proved of all postures and payloads; `None`: nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub proved: Option<Proved>,
}

/// Bounds that hold at every posture inside the joints' travel, with every payload of the set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Proved {
    /// No eigenvalue is below.
    pub low: f64,
    /// No eigenvalue is above.
    pub high: f64,
    /// Cells of postures that the proof of `high` needed.
    pub cells: u64,
}

impl Searched {
    /// The same, measured in `scale` times the nominal inertias.
    fn scaled(&self, scale: f64) -> Self {
        let mut scaled = self.clone();
        scaled.low.eigenvalue /= scale;
        scaled.high.eigenvalue /= scale;
        if let Some(proved) = &mut scaled.proved {
            proved.low /= scale;
            proved.high /= scale;
        }
        scaled
    }
}
