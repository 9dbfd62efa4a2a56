//! Error budget of a study, and changes that would help where the allowed error cannot be satisfied.

mod by_tube;
mod changes;
mod slower;

use phihat_certificate::extremes::Extremes as _;
use phihat_design::budget::{Budget, BudgetBasis, JointBudget, by_own_loop};
use phihat_design::{Arm, Gains, Outcome, Phi, PositionSearch, TradeOff};
use phihat_sim::Demand;
use phihat_study::{InertiaSource, PhiSource, Study};

use crate::along::phi_along;
use crate::error::SynthesisError;
use crate::recordings::Recordings;
use crate::synthesize::with_tip;

/// Extent of the search for changes that would help.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BudgetSearch {
    /// Nothing: what is known without another design.
    Nothing,
    /// One change after the other, each designed for: as long as some designs take.
    Changes,
}

/// Shares of the allowed torque noise at which laws from positions are looked at for the front.
const SHARES: [f64; 4] = [0.1, 0.25, 0.5, 1.0];

/// Error budget of a study, from the outcome of its synthesis; `step` receives the current step in words.
///
/// # Method
///
/// Of the gains that were found, else of the law that missed the least. Where these gains have a tube: the
/// tubes of the same gains with one cause at a time, all else being ideal; else each joint's own loop.
/// Changes are tried where the design is infeasible or its certificate leaves a clause unproved: each is
/// designed for as a study of its own.
///
/// # Errors
///
/// [`SynthesisError`]: the study's arm cannot follow its reference.
pub fn budget(
    study: &Study,
    (arm, recordings): (&Arm, &Recordings),
    (outcome, tried): (&Outcome, BudgetSearch),
    step: &mut dyn FnMut(&str),
) -> Result<Budget, SynthesisError> {
    let for_tip = with_tip(study)?;
    let study = &*for_tip;
    let (gains, feasible, mut words) = match outcome {
        Outcome::Designed(gains) => {
            let unproved = gains.certificate.as_ref().map(|c| c.unproved.clone());
            let unproved = unproved.unwrap_or_default();
            (Some(&**gains), unproved.is_empty(), unproved)
        }
        Outcome::Infeasible(no) => (no.nearest.as_deref(), false, no.words.clone()),
    };
    step("what the error is spent on");
    let demand = Demand::along(study)?;
    let (basis, joints) = match gains {
        Some(gains) => parts(study, gains, (arm, &demand))?,
        None => (None, Vec::new()),
    };
    let front = match outcome {
        Outcome::Designed(gains) if !gains.trade_off.is_empty() => gains.trade_off.clone(),
        Outcome::Infeasible(no) if !no.front.is_empty() => no.front.clone(),
        _ => front(study, arm, &demand),
    };
    let changes = match tried {
        BudgetSearch::Changes if !feasible => changes::tried(study, recordings, step),
        _ => Vec::new(),
    };
    if gains.is_none() {
        words.push(
            "no law holds on this arm: there is none whose error could be split up".to_owned(),
        );
    }
    Ok(Budget {
        study: study.name.clone(),
        study_sha256: study.sha256.clone(),
        feasible,
        words,
        basis,
        joints,
        front,
        changes,
    })
}

/// The parts of each joint's error, by a tube where there is one.
fn parts(
    study: &Study,
    gains: &Gains,
    (arm, demand): (&Arm, &Demand),
) -> Result<(Option<BudgetBasis>, Vec<JointBudget>), SynthesisError> {
    if study.design.inertia == InertiaSource::Robot {
        let found = by_tube::parts(study, gains)?;
        if let Some(joints) = found {
            return Ok((Some(BudgetBasis::Tube), joints));
        }
    }
    let nominal = gains.joints.iter().map(|joint| joint.inertia_kg_m2).collect();
    let range = arm.against(nominal)?;
    let joints = by_own_loop(study, gains, (range.low, range.high), &|joint, inertia| {
        known(study, demand, (joint, inertia))
    });
    Ok((Some(BudgetBasis::OwnLoop), joints))
}

/// Bounds of `φ`: typed, else along the reference.
fn known(study: &Study, demand: &Demand, (joint, inertia): (usize, f64)) -> Phi {
    let along = phi_along(demand, joint, inertia);
    let PhiSource::Typed { rate, jump } = &study.design.phi else { return along };
    Phi { rate_nm_s: rate[joint], jump_nm: jump[joint], size_nm: None, ..along }
}

/// Laws from positions at a few shares of the allowed noise: estimates, joint by joint.
fn front(study: &Study, arm: &Arm, demand: &Demand) -> Vec<TradeOff> {
    let phi = |joint: usize, inertia: f64| known(study, demand, (joint, inertia));
    let allowed = study.spec.error_bound.clone();
    let (Ok(mut search), Some(allowed)) = (PositionSearch::new(study, arm, &phi), allowed) else {
        return Vec::new();
    };
    let mut front = Vec::new();
    for share in SHARES {
        let Some((gains, estimates)) = search.laws(&vec![share; allowed.len()]) else { continue };
        let used = estimates.iter().zip(&allowed).map(|(own, error)| own.error_rad / error);
        let first = &gains.joints[0];
        front.push(TradeOff {
            error_share: used.largest(),
            torque_noise_nm: estimates.iter().map(|own| own.noise_nm).largest(),
            order: first.order(),
            bandwidth_rad_s: first.kp_per_s2.sqrt(),
            chosen: false,
        });
    }
    front
}
