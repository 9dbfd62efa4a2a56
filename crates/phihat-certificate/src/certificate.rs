//! The certificate: every claim about a set of gains as data.

use serde::{Deserialize, Serialize};

use crate::refutation::refuse;
use crate::{
    AnySpeed, ArmBasis, ArmInertia, Bounds, ClassBound, ContinuousLaw, CoupledGains, ElasticJoints,
    FrozenArm, InertiaWindow, LargestStep, LoopModel, Margins, Moving, NotCounted, Phi,
    ReadingError, ReferenceError, Refutation, SampledPeaks, SampledVarying, Settle, TorqueNoise,
    Tube, VaryingWindow,
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
    /// Stability at every frozen posture where joints bend; `None`: not looked at, or refused.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub elastic: Option<Box<ElasticJoints>>,
    /// Why the arm is not proved stable with the springs that its study states.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub elastic_refused: Option<Box<Refutation>>,
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
    /// Bounds for every motion of the study's class.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub class: Option<Box<ClassBound>>,
    /// Why there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub class_refused: Option<String>,
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
    /// Bounds on `φ`; `None`: not known, or the joint's arm is coupled.
    pub phi: Option<Phi>,
    /// Bounds on the error of the joint by itself: see [`Certificate::own_bounds`].
    pub(crate) bounds: Option<Bounds>,
    /// Claims that do not hold, each with its inequality. Gains with any of these do not arm.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub refused: Vec<Refutation>,
}

/// The rule of [`Certificate::bound_each`].
pub(crate) const UNCOUPLED: &str =
    "a joint of a coupled arm has no bound of its own: only a tube bounds its error";

/// Bounds on one joint's steady error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorBound {
    /// `|e|` \[rad\].
    pub error_bound_rad: f64,
    /// `|ė|` \[rad/s\].
    pub velocity_error_bound_rad_s: f64,
}

impl JointCertificate {
    /// The claims about a joint with this loop and these limits (torque \[N·m\], torque rate \[N·m/s\]): none yet.
    pub fn new(name: String, model: LoopModel, limits: (Option<f64>, Option<f64>)) -> Self {
        Self {
            name,
            model,
            window: None,
            varying: None,
            sampled_varying: None,
            continuous: None,
            margins: None,
            sampled: None,
            reading: None,
            reference: None,
            noise: None,
            step: None,
            limits,
            phi: None,
            bounds: None,
            refused: Vec::new(),
        }
    }
}

impl Certificate {
    /// Returns true if the joints push each other, as those of a robot's description do. Only a tube bounds their
    /// errors. Joints that are known by an interval of inertia each are taken for uncoupled.
    pub fn is_coupled(&self) -> bool {
        self.arm.basis == ArmBasis::Postures
    }

    /// Gives each joint bounds of its own, in the robot's order; `None`: nothing is known.
    ///
    /// # Errors
    ///
    /// [`Refutation`]: the arm is coupled, or there is not one entry per joint.
    pub fn bound_each(&mut self, own: Vec<Option<Bounds>>) -> Result<(), Refutation> {
        if self.is_coupled() {
            return Err(refuse("error bound", UNCOUPLED, 1.0, 0.0));
        }
        let (given, joints) = (own.len(), self.joints.len());
        let all = given == joints;
        Refutation::unless("error bound", "one entry per joint", given as f64, joints as f64, all)?;
        self.joints.iter_mut().zip(own).for_each(|(joint, own)| joint.bounds = own);
        Ok(())
    }

    /// Takes a tube as the bound on the errors, with its settling time and the clauses of the specification that it
    /// does not satisfy.
    pub fn bound_by(&mut self, tube: Tube, settle: Settle, unproved: Vec<String>) {
        self.tube = Some(tube);
        self.tube_refused = None;
        self.settle = Some(settle);
        self.unproved = unproved;
    }

    /// Takes back any tube: no error is bounded, for this reason.
    pub fn unbounded(&mut self, why: String, settle: Settle) {
        self.tube = None;
        self.unproved = vec![format!("the specification: no tube, {why}")];
        self.tube_refused = Some(why);
        self.settle = Some(settle);
    }

    /// Bounds on the error of a joint by itself; `None`: nothing is known, or the arm is coupled.
    pub fn own_bounds(&self, joint: usize) -> Option<&Bounds> {
        let own = self.joints.get(joint)?.bounds.as_ref();
        own.filter(|_| !self.is_coupled())
    }

    /// Reason why the error of some joint is not bounded; `None`: all are.
    pub fn without_bound(&self) -> Option<String> {
        if (0..self.joints.len()).all(|joint| self.error_bound(joint).is_some()) {
            return None;
        }
        let why = if self.is_coupled() { "no tube was computed" } else { "φ is not known" };
        let refused = self.tube_refused.as_ref().or(self.class_refused.as_ref());
        Some(refused.cloned().unwrap_or_else(|| why.to_owned()))
    }

    /// Bound on a joint's steady error: that of the tube, that of the class of motions, or, for joints that are known
    /// one by one, their own; `None`: there is none. A coupled arm has no bound without a tube or a class.
    pub fn error_bound(&self, joint: usize) -> Option<ErrorBound> {
        if let Some(tube) = &self.tube {
            let own = tube.joints.get(joint)?;
            let (error_bound_rad, velocity_error_bound_rad_s) =
                (own.error_bound_rad, own.velocity_error_bound_rad_s);
            return Some(ErrorBound { error_bound_rad, velocity_error_bound_rad_s });
        }
        if let Some(class) = &self.class {
            let error_bound_rad = *class.error_bound_rad.get(joint)?;
            let velocity_error_bound_rad_s = *class.velocity_error_bound_rad_s.get(joint)?;
            return Some(ErrorBound { error_bound_rad, velocity_error_bound_rad_s });
        }
        let Bounds { error_bound_rad, velocity_error_bound_rad_s, .. } = *self.own_bounds(joint)?;
        Some(ErrorBound { error_bound_rad, velocity_error_bound_rad_s })
    }

    /// The first claim that the certificate itself says does not hold.
    pub fn refused(&self) -> Option<Refutation> {
        let own =
            |joint: &JointCertificate| joint.refused.first().map(|why| why.clone().on(&joint.name));
        let arm = self.frozen_refused.as_ref().or(self.elastic_refused.as_deref());
        self.joints.iter().find_map(own).or_else(|| arm.cloned())
    }
}

/// A certificate in a document: one that states a bound of its own for a joint of a coupled arm is neither written nor
/// read.
pub(crate) mod document {
    use serde::de::Error as _;
    use serde::ser::Error as _;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use super::{Certificate, UNCOUPLED};

    fn stray(certificate: &Certificate) -> Option<String> {
        let coupled = certificate.is_coupled();
        let joint = certificate.joints.iter().find(|joint| coupled && joint.bounds.is_some())?;
        Some(format!("{}: {UNCOUPLED}; design these gains again", joint.name))
    }

    #[expect(clippy::ref_option, reason = "the signature that serde calls")]
    pub(crate) fn serialize<S: Serializer>(
        certificate: &Option<Certificate>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        match certificate.as_ref().and_then(stray) {
            Some(why) => Err(S::Error::custom(why)),
            None => certificate.serialize(serializer),
        }
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<Certificate>, D::Error> {
        let certificate = Option::<Certificate>::deserialize(deserializer)?;
        match certificate.as_ref().and_then(stray) {
            Some(why) => Err(D::Error::custom(why)),
            None => Ok(certificate),
        }
    }
}
