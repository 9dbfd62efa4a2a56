//! The parts of a world, from a study.

use phihat_model::Model;
use phihat_study::{FaultKind, Study};

use super::bristle::Bristle;
use super::contact::Contacts;
use super::drive::DriveLoop;
use super::fault::Acts;
use super::forces::PushForce;
use super::friction::SimulatedFriction;
use super::payload::{Carried, loaded};
use super::plant::{FaultedParts, Parts, Plant};
use super::shape::DriveImperfections;
use super::spring::{EndStop, Transmission};
use crate::error::SimError;
use crate::motion::Motion;

pub(super) fn plant(study: &Study, motion: &Motion) -> Result<Plant, SimError> {
    let period = study.control.period_ns as f64 * 1e-9;
    let rate = study.world.drive.as_ref().and_then(|drive| drive.torque_rate_max.as_ref());
    let drive = |i: usize| {
        let drive = DriveLoop::new(study.world.drive_bandwidth_hz.as_ref().map(|hz| hz[i]));
        rate.map_or(drive, |rate| drive.with_step(rate[i] * period))
    };
    let world = &study.world;
    let n = study.robot.joints.len();
    let mut carried = Carried::new(study)?;
    let bristles = |stiction| (0..n).map(|i| Bristle::new(stiction, i)).collect();
    let parts = Parts {
        contacts: Contacts::new(study, carried.model().0)?,
        carried,
        bristles: world.stiction.as_ref().map(bristles),
        transmissions: world.flexibility.as_ref().map(|asked| Transmission::all(study, asked)),
        stops: EndStop::all(study),
        #[allow(clippy::float_cmp, reason = "exactly 1 as written: nothing warms up")]
        warm_up: Some(world.warm_up).filter(|(cold, _)| *cold != 1.0),
        friction: frictions(study),
        drives: (0..n).map(drive).collect(),
        shapes: DriveImperfections::all(study),
        pushes: pushes(study),
        faults: study.faults.iter().filter(|fault| of_plant(fault.kind)).cloned().collect(),
    };
    Ok(Plant::new(parts, start_state(study, motion)))
}

/// Takes the faults of a study that is the plant's own but for them; with what the plant met before.
pub(super) fn meet(plant: &mut Plant, study: &Study) -> Result<FaultedParts, SimError> {
    Ok(plant.met(FaultedParts {
        carried: Carried::new(study)?,
        pushes: pushes(study),
        faults: study.faults.iter().filter(|fault| of_plant(fault.kind)).cloned().collect(),
        shapes: DriveImperfections::all(study),
    }))
}

fn of_plant(kind: FaultKind) -> bool {
    matches!(Acts::of(kind), Acts::Drive(_) | Acts::Friction(_))
}

/// The plant with the study's payload, whenever it is picked up, under its gravity.
pub(crate) fn loaded_model(study: &Study) -> Result<Model, SimError> {
    let model = study.robot.plant_model().with_gravity(study.world.gravity);
    match &study.world.payload {
        Some(payload) => loaded(model, &payload.frame, &payload.body()),
        None => Ok(model),
    }
}

/// The friction of the robot's description, whether or not it acts in the study.
pub(crate) fn frictions_of_robot(study: &Study) -> Vec<SimulatedFriction> {
    let of = |joint: &phihat_model::Joint| {
        let own = &joint.friction;
        SimulatedFriction { viscous: own.viscous, coulomb: own.coulomb, sigmoid: own.sigmoid }
    };
    study.robot.joints.iter().map(of).collect()
}

pub(crate) fn frictions(study: &Study) -> Vec<SimulatedFriction> {
    let mut frictions = frictions_of_robot(study);
    if !study.world.robot_friction {
        frictions.fill(SimulatedFriction::default());
    }
    for (i, friction) in frictions.iter_mut().enumerate() {
        friction.coulomb += study.world.extra_coulomb[i];
        friction.viscous += study.world.extra_viscous[i];
    }
    frictions
}

fn pushes(study: &Study) -> Vec<PushForce> {
    let push = |p: &phihat_study::Push| PushForce {
        joint: p.joint,
        torque: p.torque,
        start: p.start,
        end: p.start + p.duration,
    };
    let mut pushes: Vec<PushForce> = study.world.pushes.iter().map(push).collect();
    for fault in study.faults.iter().filter(|fault| fault.kind == FaultKind::Push) {
        let joints = (0..study.robot.joints.len()).filter(|joint| fault.concerns(*joint));
        let (torque, start, end) = (fault.size, fault.start, fault.start + fault.duration);
        pushes.extend(joints.map(|joint| PushForce { joint, torque, start, end }));
    }
    pushes
}

/// Start state of the study, else the state on the reference.
fn start_state(study: &Study, motion: &Motion) -> (Vec<f64>, Vec<f64>) {
    if let Some(start) = &study.world.start {
        return (start.q.clone(), start.dq.clone());
    }
    let jets: Vec<_> = (0..study.robot.joints.len()).map(|i| motion.at(i, 0.0)).collect();
    (jets.iter().map(|j| j[0]).collect(), jets.iter().map(|j| j[1]).collect())
}
