//! Before a run: whether the robot's interface can bear what the reference asks for.

use phihat_model::Workspace;
use phihat_study::Study;

use crate::error::SimError;
use crate::motion::Motion;
use crate::world::{frictions, loaded_model};

/// Violations of the limits of the robot's interface, one sentence each; empty where it accepts the plan.
///
/// # Method
///
/// The torque that the reference asks of the controller, by inverse dynamics with payload and friction,
/// less what the robot adds: at the start against the start and rate rules, and at every sample against
/// the torque and rate limits in force.
///
/// # Errors
///
/// [`SimError`] when the reference cannot be reached or the payload not attached.
pub fn forecast(study: &Study) -> Result<Vec<String>, SimError> {
    let profile = &study.interface.profile;
    let (torque, rate) = (&study.control.torque_max, profile.torque_rate_max);
    if rate.is_none() && !profile.clamps_torque {
        return Ok(Vec::new());
    }
    let period = study.control.period_ns as f64 * 1e-9;
    let needed = needed(study)?;
    let mut said = Vec::new();
    for (i, joint) in study.robot.joints.iter().enumerate() {
        let name = &joint.name;
        let row = &needed[i];
        let peak = row.iter().fold(0.0_f64, |most, tau| most.max(tau.abs()));
        let stated = torque.as_ref().map(|limits| limits[i]);
        let clamp = joint.torque_max.filter(|_| profile.clamps_torque);
        if let Some(limit) =
            [stated, clamp].into_iter().flatten().reduce(f64::min).filter(|limit| peak > *limit)
        {
            said.push(format!(
                "{name} needs {peak:.1} N·m along the reference, {limit} are allowed"
            ));
        }
        let Some(rate) = rate else { continue };
        let first = row[0].abs();
        if first > rate * period {
            said.push(format!(
                "{name} needs {first:.1} N·m from the start, which `{}` lets grow by {} N·m per sample: \
                 the arm gives way for {:.0} ms",
                profile.name,
                rate * period,
                1e3 * first / rate
            ));
        }
        let steepest = row.windows(2).map(|w| (w[1] - w[0]).abs() / period).fold(0.0, f64::max);
        if steepest > rate {
            said.push(format!(
                "{name} needs {steepest:.0} N·m/s along the reference, `{}` stops beyond {rate}",
                profile.name
            ));
        }
    }
    Ok(said)
}

/// Torque that the controller must command, one row of samples per joint.
fn needed(study: &Study) -> Result<Vec<Vec<f64>>, SimError> {
    let profile = &study.interface.profile;
    let motion = Motion::new(&study.reference, &study.robot, study.duration)?;
    let loaded = loaded_model(study)?;
    let own = study.robot.plant_model().with_gravity(study.world.gravity);
    let (mut ws, mut ws_own) = (Workspace::new(&loaded), Workspace::new(&own));
    let frictions = frictions(study);
    let n = study.robot.joints.len();
    let zero = vec![0.0; n];
    let (mut q, mut dq, mut ddq) = (zero.clone(), zero.clone(), zero.clone());
    let (mut tau, mut gravity) = (zero.clone(), zero.clone());
    let mut rows = vec![Vec::new(); n];
    for k in 0..crate::simulation::samples(study.duration, study.control.period_ns) {
        let t = (k * study.control.period_ns) as f64 * 1e-9;
        for i in 0..n {
            [q[i], dq[i], ddq[i]] = motion.at(i, t);
        }
        loaded.inverse_dynamics(&mut ws, &q, &dq, &ddq, &mut tau);
        if profile.adds_gravity {
            own.bias(&mut ws_own, &q, &zero, &mut gravity);
        }
        for i in 0..n {
            let friction = frictions[i].torque(dq[i]) * (1.0 - profile.adds_friction);
            rows[i].push(tau[i] - gravity[i] + friction);
        }
    }
    Ok(rows)
}
