//! The world side: command path → drives → plant → sensors.

mod build;
mod drive;
mod friction;
mod plant;
mod sensor;

pub(crate) use build::{frictions, loaded_model};
pub use friction::{COULOMB_VELOCITY, Friction};

use phihat::{Delay, Measurement};
use phihat_study::Study;

use crate::error::SimError;
use crate::motion::Motion;
use crate::sample::Sample;
use plant::Plant;
use sensor::Sensor;

/// Everything outside the controller. It knows of the controller what torque it asks for.
#[derive(Debug)]
pub(crate) struct World {
    sensors: Vec<Sensor>,
    delays: Vec<Delay<f64>>,
    pub(crate) plant: Plant,
    sample: Sample,
    demand: Vec<f64>,
    period: f64,
    substeps: u32,
}

impl World {
    /// The world of a study; it starts where the study says, else on the reference.
    pub(crate) fn new(study: &Study, motion: &Motion) -> Result<Self, SimError> {
        let n = study.robot.joints.len();
        let period = study.control.period_ns as f64 * 1e-9;
        let mut plant = build::plant(study, motion)?;
        let (needed, joint) = plant.steps_needed(period);
        if needed > study.world.substeps {
            let joint = study.robot.joints[joint].name.clone();
            return Err(SimError::TooStiff { joint, substeps: study.world.substeps, needed });
        }
        let delay = Delay::new(study.control.delay_samples as usize)
            .map_err(|e| SimError::Limit(e.to_string()))?;
        Ok(Self {
            sensors: build::sensors(study, period),
            delays: vec![delay; n],
            plant,
            sample: Sample { joints: vec![Measurement::default(); n], ..Sample::default() },
            demand: vec![0.0; n],
            period,
            substeps: study.world.substeps,
        })
    }

    /// What the controller gets at sample `k`, time `t_ns`.
    pub(crate) fn sense(&mut self, k: u64, t_ns: u64) -> &Sample {
        self.sample.sequence = k;
        self.sample.t_ns = t_ns;
        for (i, joint) in self.sample.joints.iter_mut().enumerate() {
            let (q, dq) = self.sensors[i].sense(self.plant.q[i], self.plant.dq[i]);
            *joint = Measurement { q, dq, tau_applied: self.plant.tau_mean[i] };
        }
        &self.sample
    }

    /// What the controller last got.
    pub(crate) fn sample(&self) -> &Sample {
        &self.sample
    }

    /// Takes the torque asked for at `t` \[s\] and goes on to the next sample.
    pub(crate) fn advance(&mut self, t: f64, torque: impl Iterator<Item = f64>) {
        for ((demand, delay), torque) in self.demand.iter_mut().zip(&mut self.delays).zip(torque) {
            *demand = delay.pass(torque);
        }
        self.plant.advance(t, self.period, self.substeps, &self.demand);
    }
}
