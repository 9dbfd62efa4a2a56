//! Gains of one joint, as the document has them.

use phihat::{Form, InnovationSection};
use serde::{Deserialize, Serialize};

use crate::LoopModel;

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
    /// Estimator coefficients `a_0 … a_{m−1}`, `a_i` in \[1/s^(m−i)\]; the length is the order `m`. Empty in a law from
    /// positions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub a: Vec<f64>,
    /// Observer of a law from positions, in their place.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub observer: Option<PositionObserver>,
}

/// Observer of a law from positions, and how fast its torque may turn: [`phihat::JointGains::from_positions`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PositionObserver {
    /// `ℓ`: what one radian that the joint is farther than expected adds to `ê`, `ė̂` \[1/s\], `φ̂/M̄` \[1/s²\] and the
    /// derivatives of that; `m + 2` entries.
    pub correction: Vec<f64>,
    /// `g`: share of the way to the wanted torque that is gone in one sample.
    pub share: f64,
    /// Delay from sample to acting torque that the law predicts across \[samples\].
    pub delay_samples: u32,
    /// Filter on the innovation, of up to two sections; empty: none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub innovation_filter: Vec<FilterSection>,
}

/// A section of second order of a filter on the innovation: [`phihat::InnovationSection`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FilterSection {
    /// `c_0, c_1`: its poles are `z = 1 + w` with `w² + c_1 w + c_0 = 0`.
    pub rates: [f64; 2],
    /// `b_0, b_1`: weights of its state and of the change of that per sample in the wanted torque, per `M̄`
    /// \[1/s²\].
    pub weights_per_s2: [f64; 2],
}

impl From<&FilterSection> for InnovationSection {
    fn from(section: &FilterSection) -> Self {
        Self { rates: section.rates, weights: section.weights_per_s2 }
    }
}

impl JointRecord {
    /// Order `m` of the estimate of `φ`.
    pub fn order(&self) -> usize {
        self.observer.as_ref().map_or(self.a.len(), |own| own.correction.len().saturating_sub(2))
    }

    /// Sections of the filter on the innovation; empty: none.
    pub fn innovation_filter(&self) -> &[FilterSection] {
        self.observer.as_ref().map_or(&[], |own| &own.innovation_filter)
    }

    /// Returns true if the feed-forward of a law from positions acts in the interval that it is for; always,
    /// of another law.
    pub fn fed_in_time(&self, model: &LoopModel) -> bool {
        let late = model.delay_samples + model.sample_delay_samples;
        let in_time = |own: &PositionObserver| {
            own.delay_samples == late
                && model.drive_bandwidth_hz.is_none()
                && model.torque_filter_hz.is_none()
        };
        self.observer.as_ref().is_none_or(in_time)
    }

    /// The form of the law that these gains are for; `form` says which of those that share `a`.
    pub fn form_or(&self, form: Form) -> Form {
        if self.observer.is_some() { Form::Positions } else { form }
    }
}
