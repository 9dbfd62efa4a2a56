//! The closed loop: sense → control → limit → drive → integrate.

use phihat::{Command, Delay, JointGains, JointState, Limits, Measurement, update_joints};
use phihat_model::{Body, Model};
use phihat_study::Study;

use crate::error::SimError;
use crate::friction::Friction;
use crate::motion::Motion;
use crate::plant::{Plant, Push};
use crate::sensor::Sensor;
use crate::trace::Trace;

/// Beyond this |q| \[rad or m\] or |q̇| \[rad/s or m/s\] a run has diverged.
pub const DIVERGED: f64 = 1e3;

/// A run that left every plausible state, and where.
#[derive(Debug, Clone, PartialEq)]
pub struct Divergence {
    /// When \[s\].
    pub t: f64,
    /// The joint that left first.
    pub joint: String,
}

/// What a run leaves.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The record, up to the end or to the divergence.
    pub trace: Trace,
    /// Set when the run diverged and was stopped.
    pub divergence: Option<Divergence>,
}

/// One study under one set of gains, ready to run.
///
/// # Law
///
/// At sample `k`, time `t_k = kT` (integer nanoseconds): sense `q`, `q̇`; [`update_joints`] with the mean
/// torque that acted over the interval just ended; delay the command by whole samples; the drive turns it
/// into torque, held over `[t_k, t_{k+1})`; RK4 in equal sub-steps.
///
/// Same study, same gains: same trace, bit for bit.
#[derive(Debug)]
pub struct Simulation {
    gains: Vec<JointGains<f64>>,
    states: Vec<JointState<f64>>,
    motion: Motion,
    sensors: Vec<Sensor>,
    delays: Vec<Delay<f64>>,
    plant: Plant,
    names: Vec<String>,
    period_ns: u64,
    samples: u64,
    substeps: u32,
}

impl Simulation {
    /// Builds the loop from a study and one set of gains per joint, in the robot's order. The study's
    /// torque limits are put behind the gains here.
    ///
    /// # Errors
    ///
    /// [`SimError`]: joint counts differ, a Cartesian reference cannot be reached, friction is too stiff
    /// for the step, or a payload or limit does not fit.
    pub fn new(study: &Study, gains: &[JointGains<f64>]) -> Result<Self, SimError> {
        let n = study.robot.joints.len();
        if gains.len() != n {
            return Err(SimError::JointCount { gains: gains.len(), robot: n });
        }
        let period = study.control.period_ns as f64 * 1e-9;
        let motion = Motion::new(&study.reference, &study.robot, study.duration)?;
        let start = start_state(study, &motion);
        let mut plant = Plant::new(
            loaded_model(study)?,
            frictions(study),
            &(0..n).map(|i| per(study.world.drive_bandwidth_hz.as_ref(), i)).collect::<Vec<_>>(),
            pushes(study),
            start,
        );
        let (needed, joint) = plant.steps_needed(period);
        if needed > study.world.substeps {
            let joint = study.robot.joints[joint].name.clone();
            return Err(SimError::TooStiff { joint, substeps: study.world.substeps, needed });
        }
        let sensor = |i: usize| {
            let bits = study.sensor.encoder_bits.as_ref().map(|bits| bits[i]);
            Sensor::new(bits, study.sensor.velocity, study.sensor.velocity_filter_hz, period)
        };
        let delay = Delay::new(study.control.delay_samples as usize)
            .map_err(|e| SimError::Limit(e.to_string()))?;
        Ok(Self {
            gains: limited(study, gains, period)?,
            states: vec![JointState::new(); n],
            motion,
            sensors: (0..n).map(sensor).collect(),
            delays: vec![delay; n],
            plant,
            names: study.robot.joints.iter().map(|j| j.name.clone()).collect(),
            period_ns: study.control.period_ns,
            samples: samples(study.duration, study.control.period_ns),
            substeps: study.world.substeps,
        })
    }

    /// Number of samples the run will have.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Runs to the end, or until the arm diverges. `progress` is told how many samples are done, about a
    /// hundred times.
    pub fn run(mut self, mut progress: impl FnMut(u64)) -> Outcome {
        let n = self.names.len();
        let period = self.period_ns as f64 * 1e-9;
        let mut trace = Trace::new(&self.names, self.period_ns, self.samples);
        let mut measurements = vec![Measurement::default(); n];
        let mut references = vec![phihat::Reference::default(); n];
        let mut commands = vec![Command::default(); n];
        let mut demand = vec![0.0; n];
        let stride = (self.samples / 100).max(1);
        for k in 0..self.samples {
            let t_ns = k * self.period_ns;
            let t = t_ns as f64 * 1e-9;
            for i in 0..n {
                let (q, dq) = self.sensors[i].sense(self.plant.q[i], self.plant.dq[i]);
                measurements[i] = Measurement { q, dq, tau_applied: self.plant.tau_mean[i] };
                let [q, dq, ddq] = self.motion.at(i, t);
                references[i] = phihat::Reference { q, dq, ddq };
            }
            update_joints(&self.gains, &mut self.states, &measurements, &references, &mut commands);
            for i in 0..n {
                demand[i] = self.delays[i].pass(commands[i].tau);
            }
            trace.state(t_ns, &self.plant.q, &self.plant.dq);
            self.plant.advance(t, period, self.substeps, &demand);
            for i in 0..n {
                let phi = self.plant.tau_start[i] - self.gains[i].inertia() * self.plant.ddq[i];
                let acted = (self.plant.ddq[i], self.plant.tau_mean[i], phi);
                trace.answer(i, &measurements[i], &references[i], &commands[i], acted);
            }
            if let Some(joint) = self.diverged() {
                let divergence = Some(Divergence { t, joint: self.names[joint].clone() });
                return Outcome { trace, divergence };
            }
            if (k + 1) % stride == 0 {
                progress(k + 1);
            }
        }
        progress(self.samples);
        Outcome { trace, divergence: None }
    }

    fn diverged(&self) -> Option<usize> {
        let beyond = |x: f64| x.is_nan() || x.abs() > DIVERGED;
        (0..self.names.len()).find(|&i| beyond(self.plant.q[i]) || beyond(self.plant.dq[i]))
    }
}

/// Samples of a run: every `kT` that lies before the end.
pub(crate) fn samples(duration: f64, period_ns: u64) -> u64 {
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the study bounds duration and rate; the quotient is a moderate positive number"
    )]
    let samples = (duration * 1e9 / period_ns as f64).round() as u64;
    samples.max(1)
}

fn per<T: Copy>(values: Option<&Vec<T>>, joint: usize) -> Option<T> {
    values.and_then(|v| v.get(joint)).copied()
}

fn limited(
    study: &Study,
    gains: &[JointGains<f64>],
    period: f64,
) -> Result<Vec<JointGains<f64>>, SimError> {
    let with = |(i, gains): (usize, &JointGains<f64>)| {
        let torque = per(study.control.torque_max.as_ref(), i);
        let rate = per(study.control.torque_rate_max.as_ref(), i);
        let limits = Limits::new(torque, rate, period)
            .map_err(|e| SimError::Limit(format!("{}: {e}", study.robot.joints[i].name)))?;
        Ok(gains.with_limits(limits))
    };
    gains.iter().enumerate().map(with).collect()
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
