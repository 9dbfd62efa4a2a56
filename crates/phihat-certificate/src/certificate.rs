//! The certificate: every claim about a set of gains as data.

use serde::{Deserialize, Serialize};

use crate::{
    AnySpeed, ArmInertia, Bounds, ContinuousLaw, CoupledGains, FrozenArm, InertiaWindow,
    LargestStep, LoopModel, Margins, Moving, NotCounted, Phi, ReadingError, ReferenceError,
    Refutation, SampledPeaks, SampledVarying, Settle, TorqueNoise, Tube, VaryingWindow,
};

/// Everything that is claimed about a set of gains on an arm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Certificate {
    /// The arm's range of inertia, measured in the gains' `M̄`.
    pub arm: ArmInertia,
    /// Factor by which that range must stay inside each window, at both ends.
    pub window_margin: f64,
    /// Length of a run \[s\] for which the bounds on `∫e` hold.
    pub duration_s: f64,
    /// One entry per joint, in the robot's order.
    pub joints: Vec<JointCertificate>,
    /// Stability while the arm moves; `None`: not proved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moving: Option<Moving>,
    /// Why stability while the arm moves is not proved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moving_refused: Option<Refutation>,
    /// Widest range found, around the middle of the arm's, through which it may move at any speed; for joints
    /// with laws of their own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub any_speed: Option<AnySpeed>,
    /// Stability at every frozen posture where joints have laws of their own; `None`: they share one, or it
    /// is not proved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frozen: Option<FrozenArm>,
    /// Why that is not proved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frozen_refused: Option<Refutation>,
    /// Gains from a push on one joint to every joint, at frozen postures; `None` where no model of the arm is
    /// known, or a claim about the loop is refused.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coupled: Option<CoupledGains>,
    /// Effects in the study that the claims leave out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub not_counted: Vec<NotCounted>,
    /// An envelope of the study's run from its start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tube: Option<Tube>,
    /// Clauses of the specification that are not proved, each with what is known of it; empty: all are.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unproved: Vec<String>,
    /// Why there is no tube.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tube_refused: Option<String>,
    /// When the steady part begins, and why then; `None`: not told.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settle: Option<Settle>,
}

/// The claims about one joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointCertificate {
    /// Joint name.
    pub name: String,
    /// The sampled loop that the claims are about.
    pub model: LoopModel,
    /// Inertia window of the sampled loop; `None`: unstable even at the nominal inertia.
    pub window: Option<InertiaWindow>,
    /// Range through which the inertia may move at any speed, for the continuous law; `None`: no common
    /// quadratic form.
    pub varying: Option<VaryingWindow>,
    /// Range through which the inertia may move from sample to sample, for the sampled loop; `None`: no common
    /// quadratic form.
    pub sampled_varying: Option<SampledVarying>,
    /// Claims about the law in continuous time; `None`: a law from positions, which is made for its sampled
    /// loop.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub continuous: Option<ContinuousLaw>,
    /// Stability margins over the arm's range; like all that follows `None` where the window is refused.
    pub margins: Option<Margins>,
    /// Sampled peak-to-peak gains over the arm's range.
    pub sampled: Option<SampledPeaks>,
    /// Gains from the encoder's error to the true error; `None` also for an exact position.
    pub reading: Option<ReadingError>,
    /// Gains from the reference's own motion to the error.
    pub reference: Option<ReferenceError>,
    /// Torque noise from the encoder; `None` also for an exact position.
    pub noise: Option<TorqueNoise>,
    /// Largest reference step that no limit has to cut.
    pub step: Option<LargestStep>,
    /// Torque limit \[N·m\] and torque-rate limit \[N·m/s\] that `step` is about.
    pub limits: (Option<f64>, Option<f64>),
    /// Bounds on `φ`; `None`: not known, so no bound on the error.
    pub phi: Option<Phi>,
    /// Bounds on the error that follow.
    pub bounds: Option<Bounds>,
    /// Claims that do not hold, each with its inequality. Gains with any of these do not arm.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub refused: Vec<Refutation>,
}

/// Bounds on one joint's steady error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorBound {
    /// `|e|` \[rad\].
    pub error_rad: f64,
    /// `|ė|` \[rad/s\].
    pub velocity_error_rad_s: f64,
}

impl Certificate {
    /// The bound on a joint's steady error: that of the tube, or, for joints that are known one by one, their own.
    pub fn error_bound(&self, joint: usize) -> Option<ErrorBound> {
        if let Some(tube) = &self.tube {
            let own = tube.joints.get(joint)?;
            let (error_rad, velocity_error_rad_s) =
                (own.error_max_rad, own.velocity_error_max_rad_s);
            return Some(ErrorBound { error_rad, velocity_error_rad_s });
        }
        let own = self.joints.get(joint)?.bounds?;
        let Bounds { error_rad, velocity_error_rad_s, .. } = own;
        Some(ErrorBound { error_rad, velocity_error_rad_s })
    }

    /// The first claim that the certificate itself says does not hold.
    pub fn refused(&self) -> Option<Refutation> {
        let own =
            |joint: &JointCertificate| joint.refused.first().map(|why| why.clone().on(&joint.name));
        self.joints.iter().find_map(own).or_else(|| self.frozen_refused.clone())
    }
}
