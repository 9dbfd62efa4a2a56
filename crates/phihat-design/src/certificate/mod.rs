//! The certificate: every claim about a set of gains as data, checked again by [`Certificate::verify`].

mod arming;
mod bounds;
mod find;
mod moving;
mod scope;
mod start;

use phihat_study::Study;
use serde::{Deserialize, Serialize};

pub use arming::arm_inside_window;
pub(crate) use arming::inside;
use arming::{covers, shared_law, tried};
pub use bounds::Bounds;
pub(crate) use bounds::Evidence;
pub(crate) use scope::as_modelled;
pub use scope::{LeftOut, NotCounted};

use crate::arm::ArmInertia;
use crate::claims::law::holds;
use crate::claims::{Attenuation, Iss, Law, NormH, Optimality, PaperRadius, PeakGains, Refutation};
use crate::gains::{Gains, JointRecord};
use crate::phi::Phi;
use crate::sampled::{
    InertiaWindow, LargestStep, LoopModel, Margins, Moving, ReadingError, ReferenceError,
    SampledPeaks, SampledVarying, TorqueNoise, VaryingWindow,
};

/// Inertia ratios at which figures are computed over the arm's range.
pub(crate) const RATIOS: u32 = 9;

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
    /// What the study has and the claims leave out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub not_counted: Vec<NotCounted>,
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
    /// The same for the sampled loop.
    pub sampled_varying: Option<SampledVarying>,
    /// Levels `γ` at which the law is optimal.
    pub attenuation: Attenuation,
    /// Inverse optimality at one `K̃`; `None` where no diagonal `Q` exists.
    pub optimality: Option<Optimality>,
    /// Input-to-state stability.
    pub iss: Iss,
    /// The paper's bound (40) on `|x|` per unit of `φ/M̄`, and the ultimate bound that holds.
    pub paper: PaperRadius,
    /// H-infinity norm from φ to the error.
    pub norm: NormH,
    /// Continuous peak-to-peak gains at `μ = 1`.
    pub peaks: PeakGains,
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
    /// What `φ` may be; `None`: not known, so no bound on the error.
    pub phi: Option<Phi>,
    /// What follows for the error.
    pub bounds: Option<Bounds>,
    /// Claims that do not hold, each with its inequality. Gains with any of these do not arm.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub refused: Vec<Refutation>,
}

impl Certificate {
    /// Finds every claim about gains on a study's arm, and what follows for `φ` as far as it is known. Claims
    /// that the sampled loop refuses are told in the certificate: see [`Self::refused`].
    ///
    /// # Errors
    ///
    /// [`Refutation`] of gains about which nothing at all can be claimed: joints with different laws, or a
    /// continuous law that is not stable.
    pub fn find(
        study: &Study,
        gains: &Gains,
        arm: ArmInertia,
        phi: &[Option<Phi>],
    ) -> Result<Self, Refutation> {
        shared_law(gains)?;
        let margin = study.design.window_margin;
        let bits = study.sensor.encoder_bits.as_ref();
        let mut known: Vec<find::Shared> = Vec::new();
        let mut joint = |(i, record): (usize, &JointRecord)| {
            let per = |v: &Option<Vec<f64>>| v.as_ref().and_then(|v| v.get(i)).copied();
            let model = LoopModel::from_study(study, i).with_filter_of(gains, study);
            let drive = scope::gains(study, i);
            let at = known.iter().position(|shared| shared.is_of(&model, drive));
            let at = at.map_or_else(
                || {
                    let modelled = scope::unmodelled(study, i, (record, &model), &arm);
                    let loop_ = (model, drive, modelled);
                    known.push(find::Shared::find(record, loop_, (&arm, margin), bits.is_some())?);
                    Ok(known.len() - 1)
                },
                Ok,
            )?;
            let context = find::Context {
                record,
                arm: &arm,
                limits: (per(&study.control.torque_max), per(&study.control.torque_rate_max)),
                quantum: bits.and_then(|b| b.get(i)).map(|bits| TorqueNoise::quantum(*bits)),
                duration: study.duration,
            };
            context.claims(&known[at], phi.get(i).cloned().flatten())
        };
        let joint = |(i, record): (usize, &JointRecord)| {
            joint((i, record)).map_err(|why| why.on(&record.name))
        };
        let joints = gains.joints.iter().enumerate().map(joint).collect::<Result<_, _>>()?;
        let (window_margin, duration_s) = (study.design.window_margin, study.duration);
        Ok(Self {
            arm,
            window_margin,
            duration_s,
            joints,
            moving: None,
            moving_refused: None,
            not_counted: NotCounted::of(study),
        })
    }

    /// The first claim that the certificate itself says does not hold.
    pub fn refused(&self) -> Option<Refutation> {
        let own =
            |joint: &JointCertificate| joint.refused.first().map(|why| why.clone().on(&joint.name));
        self.joints.iter().find_map(own)
    }

    /// Checks every claim again, from the gains alone.
    ///
    /// # Errors
    ///
    /// The first [`Refutation`], naming joint, claim and inequality with both sides; last of all the one that
    /// the certificate itself states.
    pub fn verify(&self, gains: &Gains) -> Result<(), Refutation> {
        shared_law(gains)?;
        let claim = "certificate";
        let (own, theirs) = (self.joints.len() as f64, gains.joints.len() as f64);
        let all = self.joints.len() == gains.joints.len()
            && self.joints.len() == self.arm.nominal_kg_m2.len();
        holds(claim, "one entry per joint", own, theirs, all)?;
        let lasting = self.duration_s > 0.0 && self.duration_s.is_finite();
        holds(claim, "0 < duration < ∞", self.duration_s, 0.0, lasting)?;
        let mut checked: Vec<&JointCertificate> = Vec::new();
        for ((joint, record), nominal) in
            self.joints.iter().zip(&gains.joints).zip(&self.arm.nominal_kg_m2)
        {
            let named = |why: Refutation| why.on(&joint.name);
            let same = joint.name == record.name;
            holds(claim, "joint names agree", 0.0, 0.0, same).map_err(named)?;
            let (claimed, used) = (*nominal, record.inertia_kg_m2);
            let equal = (claimed - used).abs() <= 1e-9 * used;
            holds(claim, "the arm is measured in the gains' M̄", claimed, used, equal)
                .map_err(named)?;
            let filter = joint.model.velocity_filter_hz;
            let carried = gains.velocity_filter_hz.is_none() || gains.velocity_filter_hz == filter;
            let of = |hz: Option<f64>| hz.unwrap_or(0.0);
            let (left, right) = (of(filter), of(gains.velocity_filter_hz));
            holds(claim, "velocity filter is that of the gains", left, right, carried)
                .map_err(named)?;
            let told = checked.iter().any(|before| joint.tells_the_same(before));
            joint.verify(record, self, told).map_err(named)?;
            checked.push(joint);
        }
        self.verify_moving(gains)?;
        self.refused().map_or(Ok(()), Err)
    }
}

impl JointCertificate {
    /// Checks the claims; those that do not depend on the nominal inertia only where they are not `told` already.
    fn verify(
        &self,
        record: &JointRecord,
        whole: &Certificate,
        told: bool,
    ) -> Result<(), Refutation> {
        if !told {
            self.verify_loop(record)?;
        }
        if !self.refused.is_empty() {
            let bare = self.margins.is_none() && self.sampled.is_none() && self.bounds.is_none();
            return holds("certificate", "no claim rests on a refused one", 1.0, 0.0, bare);
        }
        self.verify_over_range(record, whole)?;
        self.verify_bounds(record, whole.duration_s)
    }

    /// Whether all that does not depend on the nominal inertia is the same, for the law that joints share.
    fn tells_the_same(&self, other: &Self) -> bool {
        self.model == other.model
            && self.window == other.window
            && self.varying == other.varying
            && self.sampled_varying == other.sampled_varying
            && self.attenuation == other.attenuation
            && self.optimality == other.optimality
            && self.iss == other.iss
            && self.paper == other.paper
            && self.norm == other.norm
            && self.peaks == other.peaks
            && self.margins == other.margins
            && self.sampled == other.sampled
            && self.reading == other.reading
            && self.reference == other.reference
    }

    /// Continuous law and sampled loop, at whatever nominal inertia.
    fn verify_loop(&self, record: &JointRecord) -> Result<(), Refutation> {
        let law = Law::from(record);
        self.attenuation.verify(&law)?;
        if let Some(optimality) = &self.optimality {
            optimality.verify(&law)?;
        }
        self.paper.verify(&law, &self.iss)?;
        self.norm.verify(&law)?;
        self.peaks.verify(&law)?;
        if let Some(varying) = &self.varying {
            varying.verify(record)?;
        }
        if let Some(varying) = &self.sampled_varying {
            varying.verify(record, &self.model)?;
        }
        if let Some(window) = &self.window {
            window.verify(record, &self.model)?;
        }
        if let Some(margins) = &self.margins {
            margins.verify(record, &self.model)?;
        }
        if let Some(sampled) = &self.sampled {
            sampled.verify(record, &self.model)?;
        }
        if let Some(reading) = &self.reading {
            reading.verify(record, &self.model)?;
        }
        if let Some(reference) = &self.reference {
            reference.verify(record, &self.model)?;
        }
        Ok(())
    }

    /// That the claims are about the arm's whole range of inertia; noise and step at this joint's.
    fn verify_over_range(
        &self,
        record: &JointRecord,
        whole: &Certificate,
    ) -> Result<(), Refutation> {
        let arm = &whole.arm;
        let (Some(window), Some(margins), Some(sampled), Some(step)) =
            (&self.window, &self.margins, &self.sampled, &self.step)
        else {
            let inequality = "a claim that is missing is refused with its reason";
            return holds("certificate", inequality, 0.0, 1.0, false);
        };
        inside(window, arm, whole.window_margin)?;
        covers("margins", (margins.low, margins.high), arm)?;
        tried("sampled peak gains", &sampled.mu, arm)?;
        if let Some(reading) = &self.reading {
            tried("reading error", &reading.mu, arm)?;
        }
        if let Some(reference) = &self.reference {
            tried("reference error", &reference.mu, arm)?;
        }
        if let Some(noise) = &self.noise {
            noise.verify(record, &self.model)?;
            tried("torque noise", &noise.mu, arm)?;
        }
        step.verify(record, &self.model, self.limits)?;
        tried("largest step", &step.mu, arm)
    }
}
