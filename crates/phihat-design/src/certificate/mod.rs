//! The certificate: every claim about a set of gains as data, checked again by [`Certificate::verify`].

mod arming;
mod bounds;
mod find;
mod inside;
mod moving;
mod scope;
mod start;

use phihat_study::Study;

pub use arming::arm_inside_window;
use arming::shared_law;
pub(crate) use bounds::{BoundsEvidence, alone};
pub(crate) use inside::inside;
pub use moving::find_moving;
pub(crate) use scope::{as_modelled, missing};

use crate::claims::Refutation;
use crate::sampled::{LoopModel, TorqueNoise};
use crate::{
    ArmBasis, ArmInertia, Certificate, Gains, JointCertificate, JointRecord, NotCounted, Phi,
    Settle,
};
use phihat_certificate::parallel::{parallel, threads};

pub(crate) use phihat_certificate::RATIOS;

/// Finding a [`Certificate`].
pub trait FindCertificate: Sized {
    /// Finds every claim about the loop of gains on a study's arm. Claims that the sampled loop refuses stand in the
    /// certificate: see `Certificate::refused`.
    ///
    /// A coupled arm gets no bound on its error here: joints push each other, and only a tube counts that. Joints that
    /// are known one by one get bounds of their own for `φ` as far as it is known.
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
}

/// The first joint with each law, and which of them each joint is like.
fn distinct(laws: &[find::Looped<'_>]) -> (Vec<usize>, Vec<usize>) {
    let mut firsts: Vec<usize> = Vec::new();
    let like = |i: usize| {
        let before = firsts.iter().position(|first| laws[*first].is_like(&laws[i]));
        before.unwrap_or_else(|| {
            firsts.push(i);
            firsts.len() - 1
        })
    };
    let of = (0..laws.len()).map(like).collect();
    (firsts, of)
}

impl FindCertificate for Certificate {
    fn find(
        study: &Study,
        gains: &Gains,
        arm: ArmInertia,
        phi: &[Option<Phi>],
    ) -> Result<Self, Refutation> {
        let margin = study.design.window_margin;
        let own_laws = shared_law(gains).is_err() && arm.basis == ArmBasis::Postures;
        let range = (arm.low / margin, arm.high * margin);
        let frozen = own_laws.then(|| arming::frozen(study, gains, range)).transpose();
        let (frozen, frozen_refused) = match frozen {
            Ok(proved) => (proved, None),
            Err(why) => (None, Some(why)),
        };
        let bits = study.sensor.encoder_bits.as_ref();
        let laws: Vec<find::Looped<'_>> = gains
            .joints
            .iter()
            .enumerate()
            .map(|(i, record)| {
                let model = LoopModel::from_study(study, i).with_choices_of(gains, study);
                find::Looped { record, model, drive: scope::gains(study, i) }
            })
            .collect();
        let (firsts, of) = distinct(&laws);
        let known = parallel(&firsts, threads(), |i| {
            let modelled = scope::unmodelled(study, i, (laws[i].record, &laws[i].model), &arm);
            let found = find::SharedClaims::find(laws[i], modelled, (&arm, margin), bits.is_some());
            found.map_err(|why| why.on(&laws[i].record.name))
        });
        let known = known.into_iter().collect::<Result<Vec<_>, _>>()?;
        let joint = |(i, law): (usize, &find::Looped<'_>)| {
            let context = find::Context {
                record: law.record,
                arm: &arm,
                // The robot's own rules are limits like the study's.
                limits: study.limits(i),
                quantum: quantum(study, i),
            };
            let claims = context.claims(&known[of[i]]);
            claims.map_err(|why| why.on(&law.record.name))
        };
        let joints = laws.iter().enumerate().map(joint).collect::<Result<_, _>>()?;
        let (window_margin, duration_s) = (study.design.window_margin, study.duration);
        let mut certificate = Self {
            arm,
            window_margin,
            duration_s,
            joints,
            moving: None,
            moving_refused: None,
            any_speed: None,
            frozen,
            frozen_refused,
            elastic: None,
            elastic_refused: None,
            coupled: None,
            not_counted: NotCounted::of(study),
            tube: None,
            tube_refused: None,
            class: None,
            class_refused: None,
            unproved: Vec::new(),
            settle: Some(Settle::of(study, None)),
        };
        bound_each(&mut certificate, (study, gains), phi)?;
        Ok(certificate)
    }
}

/// Step of a joint's encoder \[rad\]; `None`: its position is exact.
fn quantum(study: &Study, joint: usize) -> Option<f64> {
    let bits = study.sensor.encoder_bits.as_ref()?.get(joint)?;
    Some(TorqueNoise::quantum(*bits))
}

/// Gives joints that are known one by one the bounds that follow from their own `φ`; a coupled arm none.
fn bound_each(
    certificate: &mut Certificate,
    (study, gains): (&Study, &Gains),
    phi: &[Option<Phi>],
) -> Result<(), Refutation> {
    if certificate.is_coupled() {
        certificate.unproved.push("the specification: no tube was computed".to_owned());
        return Ok(());
    }
    let own = |(i, (record, claims)): (usize, (&JointRecord, &mut JointCertificate))| {
        claims.phi = phi.get(i).cloned().flatten();
        let given = (quantum(study, i).unwrap_or(0.0), study.duration);
        claims.phi.as_ref().and_then(|phi| alone(record, claims, phi, given))
    };
    let joints = gains.joints.iter().zip(&mut certificate.joints).enumerate();
    let bounds = joints.map(own).collect();
    certificate.bound_each(bounds)
}
