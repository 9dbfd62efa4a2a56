//! A typed φ against the one that the robot's model shows along the reference.

use phihat_design::{Contradiction, Gains};
use phihat_sim::Demand;
use phihat_study::{PhiSource, Study};

/// Relative slack: a figure that was copied from the model contradicts nothing.
const SLACK: f64 = 1e-9;

/// Checks that a typed `φ` is at least that of the model along the reference, for the nominal inertias of
/// some gains; passes where none is typed.
///
/// # Errors
///
/// The first [`Contradiction`].
pub fn typed_phi_holds(study: &Study, demand: &Demand, gains: &Gains) -> Result<(), Contradiction> {
    let PhiSource::Typed { rate, jump } = &study.design.phi else { return Ok(()) };
    for (i, joint) in gains.joints.iter().enumerate() {
        let along = demand.phi(i, joint.inertia_kg_m2);
        let holds = |key: &str, typed: f64, model: f64, unit, what| {
            let found = Contradiction {
                key: key.to_owned(),
                joint: Some(joint.name.clone()),
                typed,
                model,
                unit,
                what,
            };
            if model <= typed * (1.0 + SLACK) { Ok(()) } else { Err(found) }
        };
        let what = "dry friction and pushes along the reference";
        holds("design.phi_jump_max_nm", jump[i], along.jump, "N·m", what)?;
        let what = "the smooth part along the reference";
        holds("design.phi_rate_max_nm_s", rate[i], along.rate, "N·m/s", what)?;
    }
    Ok(())
}
