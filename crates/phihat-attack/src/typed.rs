//! Laws from positions that no design chose, with the certificate that a design would give them.

use std::path::Path;

use phihat_design::prelude::FindCertificate as _;
use phihat_design::tube::{FINER, PARTS};
use phihat_design::{
    Arm, ArmError, Certificate, DesignError, Gains, Outcome, PositionSearch, claims::Refutation,
    find_moving,
};
use phihat_session::{SessionError, arm};
use phihat_sim::{Demand, SimError};
use phihat_study::Study;
use phihat_synthesis::{SynthesisError, bound_by_tube, coupled_along, phi_along};
use thiserror::Error;

/// Why laws have no certificate.
#[derive(Debug, Error)]
pub(crate) enum NotTyped {
    /// The arm's inertia is not known.
    #[error(transparent)]
    Session(Box<SessionError>),
    /// It has no range against the nominal inertia.
    #[error(transparent)]
    Arm(#[from] ArmError),
    /// The gains are none of this study.
    #[error(transparent)]
    Synthesis(#[from] SynthesisError),
    /// Its reference cannot be followed.
    #[error(transparent)]
    Sim(#[from] SimError),
    /// A search cannot begin.
    #[error(transparent)]
    Design(#[from] DesignError),
    /// Nothing at all can be claimed about the laws.
    #[error("{0}")]
    Refuted(Box<Refutation>),
}

impl From<Refutation> for NotTyped {
    fn from(why: Refutation) -> Self {
        Self::Refuted(Box::new(why))
    }
}

/// Extent of the claims about laws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Claims {
    /// All that a design claims; verified as a user does it.
    All,
    /// The tube, and the claims that it needs: half of the time.
    Tube,
}

/// Finds the claims about typed laws.
///
/// # Errors
///
/// [`NotTyped`]
pub(crate) fn typed(
    study: &Study,
    mut gains: Gains,
    (claims, path): (Claims, &Path),
) -> Result<Outcome, NotTyped> {
    let arm = arm(study, path).map_err(|why| NotTyped::Session(Box::new(why)))?;
    let nominal = gains.joints.iter().map(|joint| joint.inertia_kg_m2).collect();
    let phi = vec![None; gains.joints.len()];
    gains.certificate = Some(Certificate::find(study, &gains, arm.against(nominal)?, &phi)?);
    let gains = with_tube(study, gains)?;
    if claims == Claims::All { pushed_and_moved(study, gains, &arm) } else { Ok(designed(gains)) }
}

/// The laws with which a search by positions begins: the least error for shares of the torque noise, and one tube.
///
/// # Errors
///
/// [`NotTyped`]
pub(crate) fn sketched(study: &Study, shares: &[f64], path: &Path) -> Result<Outcome, NotTyped> {
    let arm = arm(study, path).map_err(|why| NotTyped::Session(Box::new(why)))?;
    let demand = Demand::along(study)?;
    let phi = |joint: usize, inertia: f64| phi_along(&demand, joint, inertia);
    let mut search = PositionSearch::new(study, &arm, &phi)?;
    let Some((mut gains, _)) = search.laws(shares) else {
        return Ok(Outcome::Infeasible(search.refused()));
    };
    search.certify(&mut gains)?;
    pushed_and_moved(study, with_tube(study, gains)?, &arm)
}

fn designed(gains: Gains) -> Outcome {
    Outcome::Designed(Box::new(gains))
}

/// The same gains, bounded by the envelope of the study's motion.
fn with_tube(study: &Study, mut gains: Gains) -> Result<Gains, NotTyped> {
    // About every other tube is that of a payload in finer slices: a coin that was thrown with the gains.
    let coin = gains.joints.first().map_or(0, |joint| joint.inertia_kg_m2.to_bits());
    let parts = if coin.is_multiple_of(2) { PARTS } else { FINER };
    if gains.certificate.as_ref().is_some_and(|certificate| certificate.refused().is_none()) {
        bound_by_tube(study, &mut gains, parts)?;
    }
    Ok(gains)
}

/// Adds the coupled gains, and the claims of stability while the arm moves.
fn pushed_and_moved(study: &Study, mut gains: Gains, arm: &Arm) -> Result<Outcome, NotTyped> {
    let coupled = coupled_along(study, &gains)?;
    if let Some(certificate) = &mut gains.certificate {
        certificate.coupled = coupled;
    }
    find_moving(&mut gains, arm);
    Ok(designed(gains))
}
