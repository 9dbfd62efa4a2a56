//! The parts of a world, from a study.

use phihat_model::{Body, Model};
use phihat_study::Study;

use super::friction::Friction;
use super::plant::{Plant, Push};
use super::sensor::Sensor;
use crate::error::SimError;
use crate::motion::Motion;

pub(super) fn plant(study: &Study, motion: &Motion) -> Result<Plant, SimError> {
    let bandwidth = |i: usize| study.world.drive_bandwidth_hz.as_ref().map(|hz| hz[i]);
    Ok(Plant::new(
        loaded_model(study)?,
        frictions(study),
        &(0..study.robot.joints.len()).map(bandwidth).collect::<Vec<_>>(),
        pushes(study),
        start_state(study, motion),
    ))
}

pub(super) fn sensors(study: &Study, period: f64) -> Vec<Sensor> {
    let sensor = |i: usize| {
        let bits = study.sensor.encoder_bits.as_ref().map(|bits| bits[i]);
        Sensor::new(bits, study.sensor.velocity, study.sensor.velocity_filter_hz, period)
    };
    (0..study.robot.joints.len()).map(sensor).collect()
}

pub(crate) fn loaded_model(study: &Study) -> Result<Model, SimError> {
    let model = study.robot.plant_model().with_gravity(study.world.gravity);
    let Some(payload) = &study.world.payload else { return Ok(model) };
    let frame = model
        .frame(&payload.frame)
        .ok_or_else(|| SimError::Payload(format!("no frame named {}", payload.frame)))?;
    let body = Body { mass: payload.mass, com: payload.com, inertia: payload.inertia };
    model.with_payload(frame, &body).map_err(|e| SimError::Payload(e.to_string()))
}

pub(crate) fn frictions(study: &Study) -> Vec<Friction> {
    let of = |(i, joint): (usize, &phihat_model::Joint)| {
        let mut friction = if study.world.robot_friction {
            let own = &joint.friction;
            Friction { viscous: own.viscous, coulomb: own.coulomb, sigmoid: own.sigmoid }
        } else {
            Friction::default()
        };
        friction.coulomb += study.world.extra_coulomb[i];
        friction.viscous += study.world.extra_viscous[i];
        friction
    };
    study.robot.joints.iter().enumerate().map(of).collect()
}

fn pushes(study: &Study) -> Vec<Push> {
    let push = |p: &phihat_study::Push| Push {
        joint: p.joint,
        torque: p.torque,
        start: p.start,
        end: p.start + p.duration,
    };
    study.world.pushes.iter().map(push).collect()
}

/// Where the study says, else on the reference.
fn start_state(study: &Study, motion: &Motion) -> (Vec<f64>, Vec<f64>) {
    if let Some(start) = &study.world.start {
        return (start.q.clone(), start.dq.clone());
    }
    let jets: Vec<_> = (0..study.robot.joints.len()).map(|i| motion.at(i, 0.0)).collect();
    (jets.iter().map(|j| j[0]).collect(), jets.iter().map(|j| j[1]).collect())
}
