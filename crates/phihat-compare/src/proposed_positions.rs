//! The law from positions with a law per joint: which gains its row runs with.

use phihat::Form;
use phihat_design::PositionSearch;
use phihat_rivals::DesignedPosition;
use phihat_sim::Demand;
use phihat_study::{DesignMethod, Study};
use phihat_synthesis::{arm_along, filtered_laws, phi_along};

use crate::cost::NOISE_CAP;
use crate::proposed_law::NotDesigned;

/// The laws of least error, joint by joint, whose torque changes by no more than [`NOISE_CAP`] of the joint's
/// torque limit per sample, as far as the encoder makes it change: the comparison's cap on noise as a clause
/// of the design. `limits` \[N·m\] per joint.
///
/// The clause is for the worst reading, and the cap for the mean: the measured noise is about a quarter of
/// the cap. The clause is not scaled to the mean joint by joint: joints pass their noise on to each other,
/// and the noise of the Panda was then 1.8 times the cap.
///
/// With `filter` such laws are searched once more, with a filter on the innovation and an estimated noise no
/// larger than that of those without one by their tube along the study's own motion; where those have no
/// tube, they stay without a filter.
///
/// # Errors
///
/// [`NotDesigned`]: a joint has no law that holds, or the design cannot begin.
pub(crate) fn designed_positions(
    study: &Study,
    limits: &[f64],
    filter: bool,
) -> Result<Vec<DesignedPosition>, NotDesigned> {
    let mut study = study.clone();
    study.design.method = DesignMethod::Ours;
    (study.control.form, study.control.preview) = (Form::Positions, true);
    study.sensor.velocity_filter_designed = false;
    study.design.torque_step_max = Some(limits.iter().map(|limit| NOISE_CAP * limit).collect());
    let demand = Demand::along(&study)?;
    let arm = arm_along(&study)?;
    let phi = |joint: usize, inertia: f64| phi_along(&demand, joint, inertia);
    let mut search = PositionSearch::new(&study, &arm, &phi)?;
    let found = search.laws(&vec![1.0; limits.len()]);
    let (mut gains, _) = found.ok_or_else(|| NotDesigned::Infeasible(search.refused().clauses))?;
    if filter {
        gains = filtered_laws(&study, &mut search, &gains)?.unwrap_or(gains);
    }
    let joint = |record: phihat_design::JointRecord| {
        let observer = record.observer.ok_or(NotDesigned::NoJoint)?;
        Ok(DesignedPosition {
            inertia: record.inertia_kg_m2,
            kp: record.kp_per_s2,
            kd: record.kd_per_s,
            correction: observer.correction,
            share: observer.share,
            innovation_filter: observer.innovation_filter.iter().map(Into::into).collect(),
        })
    };
    gains.joints.into_iter().map(joint).collect()
}
