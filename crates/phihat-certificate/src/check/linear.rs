//! A joint's loop as the kernel's polynomials, from the core's own numbers.

use phihat::{TorqueSource, VelocityFilter, VelocitySource, VelocityState};
use phihat_kernel::{JointLoop, Law, Reported, Setting, Unproved, VelocityModel};

use super::drive::drive;
use super::law::LawMatrices;
use crate::refutation::refuse;
use crate::{JointRecord, LoopModel, Refutation};

/// The loop of a joint, from the numbers that the core runs with.
///
/// # Errors
///
/// [`Refutation`]: the core refuses the gains, or a unit.
pub(crate) fn joint(
    claim: &str,
    record: &JointRecord,
    model: &LoopModel,
) -> Result<JointLoop, Refutation> {
    let law = played(claim, record, model)?;
    let hears = law.input.iter().chain([&law.direct]).any(|[_, dq, _]| dq.abs() > 0.0);
    let setting = Setting {
        period: model.period_s,
        inertia: record.inertia_kg_m2,
        late: (model.delay_samples + model.sample_delay_samples) as usize,
        velocity: if hears { velocity(claim, model)? } else { NO_VELOCITY },
        drive: drive(model),
        reported: match model.torque {
            TorqueSource::Applied => Reported::Applied,
            TorqueSource::Demanded => Reported::Commanded,
        },
    };
    JointLoop::new(&law, &setting).map_err(|why| refuse(claim, &format!("a loop: {why}"), 0.0, 0.0))
}

/// An inequality that is not proved, with the frequency at which it fails, or the reason.
pub(crate) fn failed(what: &str, why: Unproved) -> String {
    match why {
        Unproved::At { theta, .. } => format!("{what} at θ = {theta:.6} rad/sample"),
        why => format!("{what}: {why}"),
    }
}

/// The velocity of a law that does not hear it.
const NO_VELOCITY: VelocityModel =
    VelocityModel { last: 0.0, velocity: 0.0, position: 0.0, before: 0.0 };

/// The law's matrices as the kernel takes them.
fn played(claim: &str, record: &JointRecord, model: &LoopModel) -> Result<Law, Refutation> {
    let gains = record
        .core_gains_in(model)
        .map_err(|why| refuse(claim, &format!("gains that the core runs: {why}"), 0.0, 0.0))?;
    let law = LawMatrices::of(&gains)
        .ok_or_else(|| refuse(claim, "the core answers a unit", 0.0, 1.0))?;
    let (mut state, mut input) = law.whole();
    let output = state.pop().unwrap_or_default();
    let direct = input.pop().unwrap_or_default();
    Ok(Law { state, input, output, direct })
}

/// The velocity that the law gets, by playing the core's filter.
fn velocity(claim: &str, model: &LoopModel) -> Result<VelocityModel, Refutation> {
    let t = model.period_s;
    let filter = VelocityFilter::<f64>::new(model.velocity_filter_hz, t)
        .map_err(|why| refuse(claim, &format!("a velocity filter: {why}"), 0.0, 0.0))?;
    let of = |before: f64, last: f64, q: f64| {
        filter.estimate(&mut VelocityState::after(before, last), q, t)
    };
    let last = of(0.0, 1.0, 0.0);
    Ok(match model.velocity {
        // A position that moves by T in T moves at 1.
        VelocitySource::Measured => {
            VelocityModel { last, velocity: of(0.0, 0.0, t), position: 0.0, before: 0.0 }
        }
        VelocitySource::Differenced => VelocityModel {
            last,
            velocity: 0.0,
            position: of(0.0, 0.0, 1.0),
            before: of(1.0, 0.0, 0.0),
        },
    })
}
