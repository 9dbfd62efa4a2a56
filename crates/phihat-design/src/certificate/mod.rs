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
pub(crate) use bounds::Evidence;
pub(crate) use inside::inside;
pub use moving::find_moving;
pub(crate) use scope::{as_modelled, missing};

use crate::claims::Refutation;
use crate::parallel::{parallel, threads};
use crate::sampled::{LoopModel, TorqueNoise};
use crate::{ArmBasis, ArmInertia, Certificate, Gains, JointCertificate, NotCounted, Phi, Settle};

pub(crate) use phihat_certificate::RATIOS;

/// Finding a [`Certificate`].
pub trait FindCertificate: Sized {
    /// Finds every claim about gains on a study's arm, and what follows for `φ` as far as it is known. Claims
    /// that the sampled loop refuses are told in the certificate: see `Certificate::refused`.
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
            let found = find::Shared::find(laws[i], modelled, (&arm, margin), bits.is_some());
            found.map_err(|why| why.on(&laws[i].record.name))
        });
        let known = known.into_iter().collect::<Result<Vec<_>, _>>()?;
        let joint = |(i, law): (usize, &find::Looped<'_>)| {
            let context = find::Context {
                record: law.record,
                arm: &arm,
                // The robot's own rules are limits like the study's.
                limits: study.limits(i),
                quantum: bits.and_then(|b| b.get(i)).map(|bits| TorqueNoise::quantum(*bits)),
                duration: study.duration,
            };
            let claims = context.claims(&known[of[i]], phi.get(i).cloned().flatten());
            claims.map_err(|why| why.on(&law.record.name))
        };
        let joints = laws.iter().enumerate().map(joint).collect::<Result<_, _>>()?;
        let (window_margin, duration_s) = (study.design.window_margin, study.duration);
        Ok(Self {
            arm,
            window_margin,
            duration_s,
            joints,
            moving: None,
            moving_refused: None,
            any_speed: None,
            frozen,
            frozen_refused,
            coupled: None,
            not_counted: NotCounted::of(study),
            tube: None,
            tube_refused: None,
            unproved: Vec::new(),
            settle: Some(Settle::of(study, None)),
        })
    }
}
