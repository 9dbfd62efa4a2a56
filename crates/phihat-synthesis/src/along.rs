//! Data of an arm that a design takes from its reference alone.

use phihat_design::claims::Refutation;
use phihat_design::coupled::coupled;
use phihat_design::{Arm, ArmError, CoupledGains, Gains, Phi, PhiBasis, ReferenceBounds};
use phihat_sim::Demand;
use phihat_study::Study;

/// Postures of a reference that its arm's inertia is looked at.
const POSTURES: u32 = 200;

/// Postures of a reference at which coupled gains are summed up.
const FROZEN: u32 = 8;

/// A study's arm with the postures of its reference; without them where the arm cannot follow it, which
/// whoever walks along it is told.
///
/// # Errors
///
/// [`ArmError`]
pub fn arm_along(study: &Study) -> Result<Arm, ArmError> {
    let arm = Arm::of(study)?;
    let motion = phihat_sim::Motion::new(&study.reference, &study.robot, study.duration);
    match motion {
        Ok(motion) => arm.along(&passing(&motion, study, POSTURES)),
        Err(_) => Ok(arm),
    }
}

/// Positions and velocities, evenly over the run, both ends included.
fn passing(motion: &phihat_sim::Motion, study: &Study, count: u32) -> Vec<(Vec<f64>, Vec<f64>)> {
    let at = |k: u32| {
        let t = study.duration * f64::from(k) / f64::from(count - 1);
        let jets = (0..study.robot.joints.len()).map(|joint| motion.at(joint, t));
        jets.map(|[q, dq, _]| (q, dq)).unzip()
    };
    (0..count).map(at).collect()
}

/// Coupled gains of designed gains, at postures of the study's reference and others; see [`coupled`].
///
/// # Errors
///
/// The [`Refutation`] of a posture at which the loop is not stable.
pub fn coupled_along(study: &Study, gains: &Gains) -> Result<Option<CoupledGains>, Refutation> {
    let motion = phihat_sim::Motion::new(&study.reference, &study.robot, study.duration);
    let along = motion.map(|motion| passing(&motion, study, FROZEN)).unwrap_or_default();
    let postures: Vec<Vec<f64>> = along.into_iter().map(|(q, _)| q).collect();
    coupled(study, gains, &postures)
}

/// Largest velocity, acceleration and jerk of a joint's reference.
pub fn motion_along(demand: &Demand, joint: usize) -> ReferenceBounds {
    let (acceleration_rad_s2, jerk_rad_s3) = demand.motion(joint);
    let velocity_rad_s = demand.velocity(joint);
    ReferenceBounds { velocity_rad_s, acceleration_rad_s2, jerk_rad_s3 }
}

/// `φ` of a joint along the reference for a nominal inertia \[kg·m²\].
pub fn phi_along(demand: &Demand, joint: usize, inertia: f64) -> Phi {
    let phi = demand.phi(joint, inertia);
    Phi {
        basis: PhiBasis::Reference,
        source: "inverse dynamics along the reference, with and without payload".to_owned(),
        size_nm: Some(phi.size),
        rate_nm_s: phi.rate,
        jump_nm: phi.jump,
        motion: Some(motion_along(demand, joint)),
    }
}
