//! The certificate: every claim about a set of gains as data, checked again by [`Certificate::verify`].

mod arming;
mod bounds;
mod find;
mod moving;
mod scope;
mod start;

use phihat_study::Study;

pub use arming::arm_inside_window;
pub(crate) use arming::inside;
use arming::{covers, shared_law, tried};
pub(crate) use bounds::Evidence;
pub(crate) use moving::find_moving;
pub(crate) use scope::as_modelled;

use crate::claims::law::holds;
use crate::claims::{Law, Refutation};
use crate::prelude::*;
use crate::sampled::{LoopModel, TorqueNoise};
use crate::{ArmInertia, Certificate, Gains, JointCertificate, JointRecord, NotCounted, Phi};

/// Inertia ratios at which figures are computed over the arm's range.
pub(crate) const RATIOS: u32 = 9;

/// Finding a [`Certificate`].
pub trait FindCertificate: Sized {
    /// Finds every claim about gains on a study's arm, and what follows for `φ` as far as it is known. Claims
    /// that the sampled loop refuses are told in the certificate: see [`Self::refused`].
    ///
    /// # Errors
    ///
    /// [`Refutation`] of gains about which nothing at all can be claimed: joints with different laws, or a
    /// continuous law that is not stable.
    fn find(
        study: &Study,
        gains: &Gains,
        arm: ArmInertia,
        phi: &[Option<Phi>],
    ) -> Result<Self, Refutation>;

    /// Checks every claim again, from the gains alone.
    ///
    /// # Errors
    ///
    /// The first [`Refutation`], naming joint, claim and inequality with both sides; last of all the one that
    /// the certificate itself states.
    fn verify(&self, gains: &Gains) -> Result<(), Refutation>;
}

impl FindCertificate for Certificate {
    fn find(
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

    fn verify(&self, gains: &Gains) -> Result<(), Refutation> {
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
        if let Some(searched) = &self.arm.searched {
            searched.agrees(self.arm.low, self.arm.high)?;
        }
        moving::verify_moving(self, gains)?;
        self.refused().map_or(Ok(()), Err)
    }
}

/// What one joint's claims need to be checked.
trait CheckJoint {
    /// Checks the claims; those that do not depend on the nominal inertia only where they are not `told` already.
    fn verify(
        &self,
        record: &JointRecord,
        whole: &Certificate,
        told: bool,
    ) -> Result<(), Refutation>;

    /// Whether all that does not depend on the nominal inertia is the same, for the law that joints share.
    fn tells_the_same(&self, other: &Self) -> bool;

    /// Continuous law and sampled loop, at whatever nominal inertia.
    fn verify_loop(&self, record: &JointRecord) -> Result<(), Refutation>;

    /// That the claims are about the arm's whole range of inertia; noise and step at this joint's.
    fn verify_over_range(
        &self,
        record: &JointRecord,
        whole: &Certificate,
    ) -> Result<(), Refutation>;
}

impl CheckJoint for JointCertificate {
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
        bounds::verify(self, record, whole.duration_s)
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
