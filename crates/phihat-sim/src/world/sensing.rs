//! From the plant's state to the message that the controller gets.

use core::f64::consts::{PI, TAU};
use std::collections::VecDeque;

use phihat::{Measurement, TorqueSource, VelocitySource};
use phihat_model::JointKind;
use phihat_study::{Fault, FaultKind, SampleStamps, Study};

use super::fault::{Acts, MessageFault, ReadingFault};
use super::loss::MessageLoss;
use super::noise::{Noise, NoiseEffect};
use super::path::CommandPath;
use super::plant::Plant;
use super::sensor::JointSensor;
use crate::sample::Sample;

/// All sensors, and the way of their messages.
#[derive(Debug)]
pub(super) struct Sensing {
    sensors: Vec<JointSensor>,
    errors: Option<Errors>,
    faults: Vec<Fault>,
    torque: TorqueSource,
    stamps: SampleStamps,
    /// Index in the plant's state at which the measured coordinates begin: those of its links, or of its
    /// rotors.
    side: usize,
    wrapped: Vec<usize>,
    /// Messages on their way, where they take time.
    way: Option<VecDeque<Sample>>,
    loss: Option<MessageLoss>,
    fresh: Sample,
    pub(super) sample: Sample,
}

/// Random and constant errors.
#[derive(Debug)]
struct Errors {
    joints: Vec<JointErrors>,
    jitter: f64,
    age: Noise,
}

#[derive(Debug)]
struct JointErrors {
    bias: f64,
    position: (f64, Noise),
    /// Noise of any size up to this.
    bounded: (f64, Noise),
    velocity: (f64, Noise),
    torque: (f64, Noise),
    fault: Noise,
}

impl Sensing {
    pub(super) fn new(study: &Study) -> Self {
        let n = study.robot.joints.len();
        let period = study.control.period_ns as f64 * 1e-9;
        let asked = &study.sensor;
        let sensor = |i: usize| {
            let bits = asked.encoder_bits.as_ref().map(|bits| bits[i]);
            JointSensor::new(bits, asked.velocity, asked.velocity_filter_hz, period)
        };
        let empty = Sample {
            joints: vec![Measurement::default(); n],
            accepted: vec![0.0; n],
            ..Sample::default()
        };
        let kinds = (FaultKind::SampleLoss, NoiseEffect::SampleLoss, NoiseEffect::FaultSampleLoss);
        let turns = |i: &usize| study.robot.joints[*i].kind != JointKind::Prismatic;
        Self {
            sensors: (0..n).map(sensor).collect(),
            errors: Errors::new(study),
            faults: study.faults.iter().filter(|f| of_sensor(f.kind)).cloned().collect(),
            torque: asked.torque,
            stamps: asked.stamps,
            side: if asked.at_motor && study.world.flexibility.is_some() { n } else { 0 },
            wrapped: (0..n).filter(|i| asked.wrap && turns(i)).collect(),
            way: (asked.delay_samples > 0)
                .then(|| VecDeque::with_capacity(asked.delay_samples as usize + 1)),
            loss: MessageLoss::new(study.world.network.sample, &study.faults, kinds, study.seed),
            fresh: empty.clone(),
            sample: empty,
        }
        .delayed_by(asked.delay_samples)
    }

    /// Takes the faults of a study that is this one's own but for them.
    pub(super) fn meet(&mut self, study: &Study) {
        let kinds = (FaultKind::SampleLoss, NoiseEffect::SampleLoss, NoiseEffect::FaultSampleLoss);
        let loss = MessageLoss::new(study.world.network.sample, &study.faults, kinds, study.seed);
        self.loss = loss.map(|loss| loss.after(self.loss.as_ref()));
        self.errors = Errors::new(study);
        self.faults = study.faults.iter().filter(|f| of_sensor(f.kind)).cloned().collect();
    }

    /// Room for messages on their way: as if the driver had been running before the start.
    fn delayed_by(mut self, samples: u32) -> Self {
        if let Some(way) = &mut self.way {
            let before = |k: u32| Sample { sequence: u64::from(k), ..self.sample.clone() };
            way.extend((0..samples).map(before));
        }
        self
    }

    /// Measures at sample `k`, time `t_ns`; returns the message that the controller receives.
    pub(super) fn sense(
        &mut self,
        k: u64,
        t_ns: u64,
        plant: &Plant,
        path: &CommandPath,
    ) -> &Sample {
        let t = t_ns as f64 * 1e-9;
        let ahead = self.way.as_ref().map_or(0, |way| way.len() as u64);
        self.fresh.sequence = k + ahead;
        self.fresh.t_ns = t_ns;
        self.fresh.accepted.copy_from_slice(&path.sent);
        let age = self.errors.as_ref().map_or(0.0, |errors| errors.age(k));
        if age > 0.0 && self.stamps == SampleStamps::Taken {
            self.fresh.t_ns = t_ns.saturating_sub(nanoseconds(age));
        }
        for i in 0..self.sensors.len() {
            self.fresh.joints[i] = self.measure(i, (k, t, age), plant, path.told[i]);
        }
        if !self.faults.is_empty() {
            self.spoil(k, t);
        }
        let lost = self.loss.as_mut().is_some_and(|loss| loss.lost(k, t));
        match &mut self.way {
            None if lost => {}
            None => core::mem::swap(&mut self.sample, &mut self.fresh),
            Some(way) => {
                if k == 0 {
                    for message in way.iter_mut() {
                        message.joints.clone_from(&self.fresh.joints);
                    }
                }
                // The oldest arrives, or is lost; its room serves the freshest.
                if let Some(mut room) = way.pop_front() {
                    if !lost {
                        core::mem::swap(&mut self.sample, &mut room);
                    }
                    core::mem::swap(&mut self.fresh, &mut room);
                    way.push_back(room);
                }
            }
        }
        &self.sample
    }

    /// Random and constant errors of a joint's position, velocity and torque, and what faults add to them.
    fn spoiled(
        &self,
        i: usize,
        (k, t, age): (u64, f64, f64),
        [mut q, mut dq, ddq]: [f64; 3],
        mut tau_applied: f64,
    ) -> (f64, f64, f64) {
        if let Some(errors) = &self.errors {
            if age > 0.0 {
                q -= age * (dq - 0.5 * age * ddq);
                dq -= age * ddq;
            }
            let own = &errors.joints[i];
            q += own.bias + own.position.0 * own.position.1.normal(k);
            q += own.bounded.0 * (2.0 * own.bounded.1.uniform(k) - 1.0);
            dq += own.velocity.0 * own.velocity.1.normal(k);
            tau_applied += own.torque.0 * own.torque.1.normal(k);
            for fault in self.faults.iter().filter(|f| f.concerns(i) && f.active(t)) {
                let Acts::Reading(what) = Acts::of(fault.kind) else { continue };
                match what {
                    ReadingFault::Bias => q += fault.size,
                    ReadingFault::Noise => q += fault.size * own.fault.normal(k),
                    ReadingFault::Torque => tau_applied += fault.size,
                }
            }
        }
        (q, dq, tau_applied)
    }

    /// Returns true if every message arrives, and none is perturbed or wrapped.
    pub(super) fn uneventful(&self) -> bool {
        self.faults.is_empty() && self.loss.is_none() && self.wrapped.is_empty()
    }

    /// By how many samples messages are late.
    pub(super) fn late(&self) -> usize {
        self.way.as_ref().map_or(0, VecDeque::len)
    }

    /// Returns true if the reported torque is the demanded one, not the one that acted.
    pub(super) fn tells_demand(&self) -> bool {
        self.torque == TorqueSource::Demanded
    }

    /// The sensor of a joint.
    pub(super) fn sensor(&self, i: usize) -> &JointSensor {
        &self.sensors[i]
    }

    /// Measurement of a joint's true state `[q, q̇, q̈]` and torque at sample `k`, with errors; `None`: there
    /// are none.
    pub(super) fn errors(
        &self,
        i: usize,
        k: u64,
        x: [f64; 3],
        tau: f64,
    ) -> Option<(f64, f64, f64)> {
        let age = self.errors.as_ref()?.age(k);
        Some(self.spoiled(i, (k, 0.0, age), x, tau))
    }

    /// Returns true if there are errors.
    pub(super) fn errs(&self) -> bool {
        self.errors.is_some()
    }

    fn measure(
        &mut self,
        i: usize,
        (k, t, age): (u64, f64, f64),
        plant: &Plant,
        told: f64,
    ) -> Measurement<f64> {
        let at = self.side + i;
        let true_state = [plant.q[at], plant.dq[at], plant.ddq[at]];
        let tau_applied = match self.torque {
            TorqueSource::Applied => plant.tau_mean[i],
            TorqueSource::Demanded => told,
        };
        let (q, dq, tau_applied) = self.spoiled(i, (k, t, age), true_state, tau_applied);
        let (mut q, dq) = self.sensors[i].sense(q, dq);
        if self.wrapped.contains(&i) {
            q = wrap(q);
        }
        Measurement { q, dq, tau_applied }
    }

    /// Applies the faults of a whole message.
    fn spoil(&mut self, k: u64, t: f64) {
        for fault in self.faults.iter().filter(|fault| fault.active(t)) {
            let concerned = self.fresh.joints.iter_mut().zip(&self.sample.joints).enumerate();
            let concerned = concerned.filter(|(i, _)| fault.concerns(*i));
            let Acts::Message(what) = Acts::of(fault.kind) else { continue };
            match what {
                // The first message has none before it that it could repeat.
                MessageFault::Freeze if k == 0 => {}
                MessageFault::Freeze => concerned.for_each(|(_, (new, old))| {
                    (new.q, new.dq) = (old.q, old.dq);
                }),
                MessageFault::Nan => concerned.for_each(|(_, (new, _))| {
                    (new.q, new.dq) = (f64::NAN, f64::NAN);
                }),
                MessageFault::JointOrder => {
                    #[allow(
                        clippy::cast_possible_truncation,
                        clippy::cast_sign_loss,
                        reason = "a whole number from 1 to 100"
                    )]
                    let places = fault.size as usize % self.fresh.joints.len();
                    self.fresh.joints.rotate_left(places);
                }
                MessageFault::ClockJump => self.fresh.t_ns += nanoseconds(fault.size),
            }
        }
    }
}

impl Errors {
    /// `None` where nothing random or constant is added.
    fn new(study: &Study) -> Option<Self> {
        let asked = &study.sensor;
        let lists = [
            &asked.position_noise,
            &asked.position_noise_max,
            &asked.position_bias,
            &asked.velocity_noise,
            &asked.torque_noise,
        ];
        let faulty = study.faults.iter().any(|f| matches!(Acts::of(f.kind), Acts::Reading(_)));
        let stated = lists.iter().any(|list| list.iter().any(|x| x.abs() > 0.0));
        if !(stated || faulty || asked.jitter > 0.0) {
            return None;
        }
        let joint = |i: usize| {
            let noise = |effect| Noise::new(study.seed, effect, i);
            let measured = asked.velocity == VelocitySource::Measured;
            JointErrors {
                bias: asked.position_bias[i],
                position: (asked.position_noise[i], noise(NoiseEffect::Position)),
                bounded: (asked.position_noise_max[i], noise(NoiseEffect::BoundedPosition)),
                velocity: (
                    if measured { asked.velocity_noise[i] } else { 0.0 },
                    noise(NoiseEffect::Velocity),
                ),
                torque: (asked.torque_noise[i], noise(NoiseEffect::Torque)),
                fault: noise(NoiseEffect::FaultNoise),
            }
        };
        Some(Self {
            joints: (0..study.robot.joints.len()).map(joint).collect(),
            jitter: asked.jitter,
            age: Noise::new(study.seed, NoiseEffect::Jitter, 0),
        })
    }

    /// Time by which sample `k` is taken early \[s\].
    fn age(&self, k: u64) -> f64 {
        if k == 0 { 0.0 } else { self.jitter * self.age.uniform(k) }
    }
}

fn of_sensor(kind: FaultKind) -> bool {
    matches!(Acts::of(kind), Acts::Reading(_) | Acts::Message(_))
}

/// Into `[−π, π)`.
fn wrap(q: f64) -> f64 {
    q - TAU * ((q + PI) / TAU).floor()
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a moderate positive number"
)]
fn nanoseconds(t: f64) -> u64 {
    (t * 1e9).round() as u64
}
