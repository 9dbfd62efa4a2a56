//! The family of laws that is searched.

use crate::JointRecord;
use crate::quick::Quick;
use crate::request::estimator;
use crate::sampled::LoopModel;

/// A law of the family, and its velocity filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LawShape {
    /// `ω` \[rad/s\].
    pub(super) w: f64,
    pub(super) order: usize,
    /// `ω_o/ω`.
    pub(super) ratio: f64,
    /// Cut-off of the velocity filter \[Hz\].
    pub(super) filter_hz: Option<f64>,
}

impl LawShape {
    pub(super) fn law(&self) -> JointRecord {
        self.record("", 1.0)
    }

    /// `K_p = ω²`, `K_d = 2ω`, all estimator poles at `ω_o`.
    pub(super) fn record(&self, name: &str, inertia: f64) -> JointRecord {
        JointRecord {
            name: name.to_owned(),
            inertia_kg_m2: inertia,
            kp_per_s2: self.w * self.w,
            kd_per_s: 2.0 * self.w,
            a: estimator(self.order, self.ratio * self.w, 1.0),
            observer: None,
        }
    }

    /// A loop with this velocity filter.
    pub(super) fn in_loop(&self, model: &LoopModel) -> LoopModel {
        LoopModel { velocity_filter_hz: self.filter_hz, ..*model }
    }
}

/// A law and a factor on every nominal inertia, with what they do.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Candidate {
    pub(super) shape: LawShape,
    pub(super) scale: f64,
    /// Position of `scale` between the smallest and the largest that satisfy the window, 0 … 1.
    pub(super) share: f64,
    /// Gains per `M̄`, worst over the arm's range and the loop models.
    pub(super) gains: Quick,
}

impl Candidate {
    /// Torque noise, to be minimised: the torque that encoder steps cause on a joint of nominal inertia.
    pub(super) fn noise(&self) -> f64 {
        self.scale * self.gains.change
    }
}
