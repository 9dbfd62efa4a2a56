//! The control side of one joint, block after block: sensor, measurements on their way, law, commands on their way,
//! drive. For several runs at once.

use core::f64::consts::TAU;

use phihat::{TorqueSource, VelocitySource};
use phihat_certificate::JointRecord;

use super::law::Law;
use super::model::{LoopModel, LoopParts, SampledDrive};
use crate::lanes::Lane;

/// Reference of a joint at a sample: `q_d, q̇_d, q̈_d`.
pub(crate) type Jet = [f64; 3];

/// Position, velocity and torque that acted, as the law receives them.
pub(crate) type Message<const W: usize> = [Lane<W>; 3];

/// Constants of one joint's control side.
#[derive(Debug, Clone)]
pub(crate) struct ControlSide {
    /// Unit of its torques \[kg·m²\].
    pub(crate) inertia: f64,
    per_inertia: f64,
    law: Law,
    period: f64,
    per_period: f64,
    differences: bool,
    /// Share of a new velocity that the velocity filter takes.
    filter: Option<f64>,
    drive: Option<SampledDrive>,
    drive_rate: f64,
    reports: TorqueSource,
    /// Measurements, and commands, on their way.
    way: usize,
    line: usize,
}

/// All that it remembers, for `W` runs.
#[derive(Debug, Clone)]
pub(crate) struct ControlState<const W: usize> {
    law: Vec<Lane<W>>,
    /// Torques of the last samples over the unit, less their feed-forward, the newest first.
    sent: Vec<Lane<W>>,
    /// Accelerations fed forward at the last samples, the newest first: the same in every run.
    forward: Vec<f64>,
    position: Lane<W>,
    velocity: Lane<W>,
    /// Mean torque over the interval just ended, as it is reported.
    acted: Lane<W>,
    line: Vec<Lane<W>>,
    way: Vec<Message<W>>,
    /// Torque of the drive at the end of the interval.
    end: Lane<W>,
    /// Torque that a drive has to deliver in the interval, and how far it is from it at the start: no states.
    demand: Lane<W>,
    gap: Lane<W>,
}

impl ControlSide {
    /// In a loop.
    pub(crate) fn new(law: Law, inertia: f64, model: &LoopModel) -> Self {
        Self {
            inertia,
            per_inertia: inertia.recip(),
            law,
            period: model.period_s,
            per_period: model.period_s.recip(),
            differences: model.velocity == VelocitySource::Differenced,
            filter: model.filters().then(|| model.filter_gain()),
            drive: model.drive(),
            drive_rate: TAU * model.drive_bandwidth_hz.unwrap_or(0.0),
            reports: model.torque,
            way: model.sample_delay_samples as usize,
            line: model.delay_samples as usize,
        }
    }

    /// The law of gains in a loop, per unit of `M̄`, with both delays in one line: what a linear loop against one
    /// inertia cannot tell from two.
    pub(crate) fn unit(record: &JointRecord, model: &LoopModel) -> Self {
        let law = Law::or_none(record, model);
        let model = LoopModel { delay_samples: model.late(), sample_delay_samples: 0, ..*model };
        Self::new(law, 1.0, &model)
    }

    /// Units of its states over `M̄`, as rad/s^k, in their order.
    pub(crate) fn powers(&self) -> Vec<i8> {
        let (law, register) = self.law.powers().split_at(self.law.before_register());
        let mut powers = law.to_vec();
        if self.remembers_position() {
            powers.push(0);
        }
        powers.extend(register);
        let mut add = |is: bool, power: i8| {
            if is {
                powers.push(power);
            }
        };
        add(self.remembers_velocity(), 1);
        add(self.law.uses_torque(), 2);
        add(self.drive.is_some(), 2);
        powers.extend((0..self.line).map(|_| 2));
        powers.extend((0..self.way).flat_map(|_| [0, 1, 2]));
        powers.extend((0..self.law.sent()).map(|_| 2));
        powers
    }

    /// True if the torque of its drive changes within a sample.
    pub(crate) fn lags(&self) -> bool {
        self.drive.is_some()
    }

    /// True if its law subtracts its feed-forward from the torque that acted: what the reference does then leaves
    /// nothing to react to.
    pub(crate) fn subtracts_feed_forward(&self) -> bool {
        self.law.feed_forward().is_some()
    }

    /// Place among its states of the torque that acted.
    pub(crate) fn acted(&self) -> Option<usize> {
        let before = self.law.length()
            + usize::from(self.remembers_position())
            + usize::from(self.remembers_velocity());
        self.law.uses_torque().then_some(before)
    }

    /// True if its law uses a measured velocity.
    pub(crate) fn measures_velocity(&self) -> bool {
        self.law.uses_velocity() && !self.differences
    }

    fn remembers_position(&self) -> bool {
        self.law.uses_velocity() && self.differences
    }

    fn remembers_velocity(&self) -> bool {
        self.law.uses_velocity() && self.filter.is_some() && self.shared().is_none()
    }

    /// State of the law that is the filtered velocity of the sample before.
    fn shared(&self) -> Option<usize> {
        self.law.register().filter(|_| self.way == 0)
    }
}

impl<const W: usize> ControlState<W> {
    /// At rest.
    pub(crate) fn new(side: &ControlSide) -> Self {
        let zero = Lane::ZERO;
        Self {
            law: vec![zero; side.law.length()],
            sent: vec![zero; side.law.sent()],
            forward: vec![0.0; side.law.feed_forward().map_or(0, |d| d + 1)],
            position: zero,
            velocity: zero,
            acted: zero,
            line: vec![zero; side.line],
            way: vec![[zero; 3]; side.way],
            end: zero,
            demand: zero,
            gap: zero,
        }
    }

    /// After a torque that held the joint for long \[N·m\].
    pub(crate) fn hold(&mut self, torque: f64) {
        let torque = Lane([torque; W]);
        (self.acted, self.end) = (torque, torque);
        self.line.fill(torque);
    }

    /// The states, those of [`ControlSide::powers`].
    pub(crate) fn states(&mut self, side: &ControlSide) -> impl Iterator<Item = &mut Lane<W>> {
        let single = [
            (side.remembers_velocity(), &mut self.velocity),
            (side.law.uses_torque(), &mut self.acted),
            (side.drive.is_some(), &mut self.end),
        ];
        let (law, register) = self.law.split_at_mut(side.law.before_register());
        law.iter_mut()
            .chain(side.remembers_position().then_some(&mut self.position))
            .chain(register)
            .chain(single.into_iter().filter_map(|(is, state)| is.then_some(state)))
            .chain(&mut self.line)
            .chain(self.way.iter_mut().flatten())
            .chain(&mut self.sent)
    }

    /// Measurement of a sample as the law receives it. At the very first one a velocity is measured; until the law has
    /// begun, it is computed for a law too that will not use it.
    pub(crate) fn sense(
        &mut self,
        side: &ControlSide,
        (begins, early): (bool, bool),
        (position, velocity): (&Lane<W>, &Lane<W>),
    ) -> Message<W> {
        let mut sensed = *velocity;
        if !begins && (early || side.law.uses_velocity()) {
            if side.differences {
                sensed = position.minus(&self.position).affine(side.per_period, 0.0);
            }
            if let Some(share) = side.filter {
                let shared = side.shared().filter(|_| !early);
                let before = shared.map_or(self.velocity, |register| self.law[register]);
                let off = sensed.minus(&before);
                sensed = before;
                sensed.add_scaled(share, &off);
            }
        }
        self.position = *position;
        self.velocity = sensed;
        let fresh = [*position, sensed, self.acted];
        if self.way.is_empty() {
            return fresh;
        }
        if begins {
            self.way.fill(fresh);
        }
        passed(&mut self.way, fresh)
    }

    /// Torque command of the law; `first`: its first sample.
    pub(crate) fn command(
        &mut self,
        side: &ControlSide,
        first: bool,
        [q, dq, ddq]: Jet,
        [position, velocity, acted]: &Message<W>,
    ) -> Lane<W> {
        let error = position.affine(1.0, -q);
        if first {
            side.law.begin(&mut self.law, (&error, velocity), dq);
        } else {
            let fed = side.law.feed_forward().map_or(0.0, |d| self.forward[d]);
            let acted = acted.affine(side.per_inertia, -fed);
            side.law.step(&mut self.law, &[error, acted, *velocity]);
        }
        let torque = side.law.torque(&self.law, &self.sent, (&error, velocity));
        let before = self.forward.first().map_or(0.0, |fed| side.law.forward_before() * fed);
        self.feed_forward(ddq);
        let forward = side.law.forward(dq, ddq) + before;
        torque.affine(side.inertia, side.inertia * forward)
    }

    /// The law's state such that its first command is a torque that held the joint for long.
    pub(crate) fn take_over(
        &mut self,
        side: &ControlSide,
        (held, [q, dq, ddq]): (f64, Jet),
        [position, velocity, _]: &Message<W>,
    ) {
        let error = Lane::<W>::of(|c| position[c] - q);
        let subtracted = if self.forward.is_empty() { 0.0 } else { ddq };
        let torque = held * side.per_inertia;
        let wanted = torque - side.law.forward(dq, ddq) - side.law.forward_before() * ddq;
        side.law.begin(&mut self.law, (&error, velocity), dq);
        self.sent.fill(Lane([torque - subtracted; W]));
        let torque = side.law.torque(&self.law, &self.sent, (&error, velocity));
        side.law.resume(&mut self.law, &Lane::of(|c| wanted - torque[c]));
        self.forward.fill(ddq);
    }

    fn feed_forward(&mut self, acceleration: f64) {
        for i in (1..self.forward.len()).rev() {
            self.forward[i] = self.forward[i - 1];
        }
        if let Some(newest) = self.forward.first_mut() {
            *newest = acceleration;
        }
    }

    /// Torque at the start of the interval in which a command is the newest, before [`Self::act`].
    pub(crate) fn acting(&self, side: &ControlSide, command: &Lane<W>) -> Lane<W> {
        if side.drive.is_some() { self.end } else { *self.line.first().unwrap_or(command) }
    }

    /// Sends a command, as limits let it through: mean torque over the interval, and `∫∫ τ − ½T² mean`, which a drive's
    /// curve adds to a unit inertia's way.
    pub(crate) fn act(&mut self, side: &ControlSide, command: &Lane<W>) -> (Lane<W>, Lane<W>) {
        for i in (1..self.sent.len()).rev() {
            self.sent[i] = self.sent[i - 1];
        }
        if let Some(newest) = self.sent.first_mut() {
            let fed = self.forward.first().copied().unwrap_or(0.0);
            *newest = command.affine(side.per_inertia, -fed);
        }
        let demand = if self.line.is_empty() { *command } else { passed(&mut self.line, *command) };
        let (mut mean, mut bulge) = (demand, Lane::ZERO);
        if let Some(drive) = &side.drive {
            let half = 0.5 * side.period * side.period;
            let gap = self.end.minus(&demand);
            mean.add_scaled(drive.mean, &gap);
            bulge = gap.affine(drive.double - half * drive.mean, 0.0);
            self.end = demand;
            self.end.add_scaled(1.0 - drive.lost, &gap);
            (self.gap, self.demand) = (gap, demand);
        }
        self.acted = match side.reports {
            TorqueSource::Applied => mean,
            TorqueSource::Demanded => demand,
        };
        (mean, bulge)
    }

    /// Torque some time into the interval \[N·m\], after [`Self::act`].
    pub(crate) fn torque(&self, side: &ControlSide, elapsed: f64) -> Lane<W> {
        if side.drive.is_none() {
            return self.acted;
        }
        let mut torque = self.demand;
        torque.add_scaled(libm::exp(-side.drive_rate * elapsed), &self.gap);
        torque
    }

    /// Torque commanded last, where the law stores it \[N·m\]; else 0.
    pub(crate) fn sent_last(&self, side: &ControlSide) -> Lane<W> {
        self.sent.first().map_or(Lane::ZERO, |sent| Lane(sent.map(|u| side.inertia * u)))
    }

    /// Of a law that stores its torques: replaces the motion that it estimates and the torque that it sent last by
    /// their differences from the true motion and from the torque that it wants; after the command has acted.
    pub(crate) fn become_relative(&mut self, side: &ControlSide, motion: (&Lane<W>, &Lane<W>)) {
        if !self.sent.is_empty() {
            self.sent[0] = side.law.lag(&self.law, &self.sent);
            self.add_motion(side, motion, -1.0);
        }
    }

    /// The inverse of [`Self::become_relative`].
    pub(crate) fn become_absolute(&mut self, side: &ControlSide, motion: (&Lane<W>, &Lane<W>)) {
        if !self.sent.is_empty() {
            self.add_motion(side, motion, 1.0);
            self.sent[0] = side.law.sent_last(&self.law, &self.sent);
        }
    }

    /// Adds a motion a sample before, so many times, to what the law estimates of it.
    fn add_motion(
        &mut self,
        side: &ControlSide,
        (position, velocity): (&Lane<W>, &Lane<W>),
        times: f64,
    ) {
        let before = Lane::of(|c| position[c] - side.period * velocity[c]);
        side.law.add_motion(&mut self.law, (&before, velocity), times);
    }
}

/// Puts a new value into a line, and returns the one that arrives at its end.
fn passed<T: Copy>(line: &mut [T], new: T) -> T {
    let arrived = line[0];
    for i in 1..line.len() {
        line[i - 1] = line[i];
    }
    if let Some(last) = line.last_mut() {
        *last = new;
    }
    arrived
}
