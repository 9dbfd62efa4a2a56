//! The control side of one sample, for the nominal run and for small deviations from it.

use crate::lanes::Lane;
use crate::sampled::positions::Positions;
use crate::sampled::{Drive, LoopModel, LoopParts, estimator_coefficients, literal_factors};
use phihat::{Form, TorqueSource, VelocitySource};
use phihat_certificate::JointRecord;

/// Constant part of the loop: sensors, law, delays, drives, per joint.
#[derive(Debug, Clone)]
pub(super) struct SampledLaw {
    pub(super) joints: Vec<SampledJoint>,
    pub(super) period: f64,
    /// The first command is zero, and the law is first asked at the second sample.
    pub(super) starts_at_zero: bool,
    /// The first command is the torque that held the arm before: [`Control::holding`].
    pub(super) takes_over: bool,
}

impl SampledLaw {
    /// Returns true if torque changes within a sample.
    pub(super) fn bulges(&self) -> bool {
        self.joints.iter().any(|joint| joint.model.drive_bandwidth_hz.is_some())
    }
}

/// One joint's part of it.
#[derive(Debug, Clone)]
pub(super) struct SampledJoint {
    pub(super) inertia: f64,
    per_inertia: f64,
    kp: f64,
    kd: f64,
    /// Length of the estimator's memory.
    order: usize,
    positions: Option<Positions>,
    /// Observer: what the innovation adds to memory `j`. Literal: weight of integral `j`.
    on_memory: Vec<f64>,
    /// Literal: weights of `e` and `ė` in `φ̂`.
    on_error: [f64; 2],
    pub(super) model: LoopModel,
    /// Share of a new sample that the velocity filter takes.
    filter: Option<f64>,
    drive: Option<Drive>,
}

/// One demand of the law on its reference: `q_d, q̇_d, q̈_d`.
pub(super) type Jet = [f64; 3];

impl SampledJoint {
    pub(super) fn new(record: &JointRecord, model: LoopModel) -> Self {
        let m = record.a.len();
        let positions = Positions::of(record, model.period_s);
        let (on_memory, on_error) = match model.form {
            Form::Positions => (Vec::new(), [0.0; 2]),
            Form::Observer => {
                let mut alpha = estimator_coefficients(&record.a, model.period_s);
                alpha.reverse();
                (alpha, [0.0; 2])
            }
            Form::Literal => {
                // x_{m+1} = e, x_{m+2} = ė; memory j is the (j+1)-fold integral, x_{m−j}.
                let factors = literal_factors(record);
                let integrals = (0..m).map(|j| factors[m - 1 - j]).collect();
                (integrals, [factors[m], factors[m + 1]])
            }
        };
        Self {
            inertia: record.inertia_kg_m2,
            per_inertia: record.inertia_kg_m2.recip(),
            kp: record.kp_per_s2,
            kd: record.kd_per_s,
            order: positions.as_ref().map_or(m, Positions::length),
            positions,
            on_memory,
            on_error,
            filter: model.filters().then(|| model.filter_gain()),
            drive: model.drive(),
            model,
        }
    }
}

/// The state of all joints' control sides, for `W` runs at once.
#[derive(Debug, Clone)]
pub(super) struct Control<const W: usize> {
    joints: Vec<JointState<W>>,
    /// Torque command of the law at this sample \[N·m\].
    pub(super) command: Vec<Lane<W>>,
    /// Torque that held the arm before the first sample; 0 of a deviation.
    held: Vec<f64>,
    /// Mean torque over the interval that begins at this sample.
    pub(super) mean: Vec<Lane<W>>,
    /// `∫∫ τ − ½T² mean`: what the drive's curve adds to a unit inertia's way over the interval.
    pub(super) bulge: Vec<Lane<W>>,
}

#[derive(Debug, Clone)]
struct JointState<const W: usize> {
    last_position: Lane<W>,
    last_velocity: Lane<W>,
    law_velocity: Lane<W>,
    acted: Lane<W>,
    gap: Lane<W>,
    told: Lane<W>,
    memory: Vec<Lane<W>>,
    line: Vec<Lane<W>>,
    /// Messages on their way: position, velocity, torque.
    way: Vec<[Lane<W>; 3]>,
    /// From positions: the last commands without their feed-forward, over `M̄`, the newest first.
    sent: Vec<Lane<W>>,
    /// From positions: the last accelerations fed forward, the newest first. The same in every run.
    fed: Vec<f64>,
}

impl<const W: usize> Control<W> {
    pub(super) fn new(law: &SampledLaw) -> Self {
        let zero = Lane::ZERO;
        let joint = |joint: &SampledJoint| JointState {
            last_position: zero,
            last_velocity: zero,
            law_velocity: zero,
            acted: zero,
            gap: zero,
            told: zero,
            memory: vec![zero; joint.order],
            line: vec![zero; joint.model.delay_samples as usize],
            way: vec![[zero; 3]; joint.model.sample_delay_samples as usize],
            sent: vec![zero; joint.positions.as_ref().map_or(0, Positions::sent)],
            fed: vec![0.0; joint.positions.as_ref().map_or(0, |law| law.ahead() + 1)],
        };
        let n = law.joints.len();
        Self {
            joints: law.joints.iter().map(joint).collect(),
            command: vec![zero; n],
            held: vec![0.0; n],
            mean: vec![zero; n],
            bulge: vec![zero; n],
        }
    }

    /// The same after torques that held the arm for long.
    pub(super) fn holding(mut self, held: &[f64]) -> Self {
        for (state, torque) in self.joints.iter_mut().zip(held) {
            let torque = Lane([*torque; W]);
            (state.acted, state.told) = (torque, torque);
            state.line.fill(torque);
        }
        self.held.copy_from_slice(held);
        self
    }

    /// Number of states per run.
    pub(super) fn length(&self) -> usize {
        self.joints.iter().map(JointState::length).sum()
    }

    /// Shows every state, joint after joint, in a fixed order.
    pub(super) fn each(&mut self, mut visit: impl FnMut(usize, &mut Lane<W>)) {
        let mut at = 0;
        for joint in &mut self.joints {
            for state in joint.states() {
                visit(at, state);
                at += 1;
            }
        }
    }

    /// Torque commanded last, where the law stores it \[N·m\]; else 0.
    pub(super) fn sent_last(&self, law: &SampledLaw, i: usize) -> Lane<W> {
        let inertia = law.joints[i].inertia;
        self.joints[i].sent.first().map_or(Lane::ZERO, |sent| Lane(sent.map(|u| inertia * u)))
    }

    /// Laws from positions: replaces the expected values and the torque sent by their differences from the
    /// true values and from the torque wanted; after commands have acted.
    pub(super) fn come_apart(&mut self, law: &SampledLaw, arm: (&[Lane<W>], &[Lane<W>])) {
        for (i, (joint, state)) in law.joints.iter().zip(&mut self.joints).enumerate() {
            let Some(own) = &joint.positions else { continue };
            let late = own.late(&state.memory, &state.sent);
            state.sent[0] = late;
            state.expect(law.period, (&arm.0[i], &arm.1[i]), -1.0);
        }
    }

    /// The inverse of [`Self::come_apart`].
    pub(super) fn come_together(&mut self, law: &SampledLaw, arm: (&[Lane<W>], &[Lane<W>])) {
        for (i, (joint, state)) in law.joints.iter().zip(&mut self.joints).enumerate() {
            let Some(own) = &joint.positions else { continue };
            state.expect(law.period, (&arm.0[i], &arm.1[i]), 1.0);
            let last = own.last(&state.memory, &state.sent);
            state.sent[0] = last;
        }
    }

    /// Senses and asks the law at sample `k`; leaves `command`.
    pub(super) fn ask(
        &mut self,
        law: &SampledLaw,
        k: usize,
        reference: impl Fn(usize) -> Jet,
        (position, velocity): (&[Lane<W>], &[Lane<W>]),
    ) {
        for (i, joint) in law.joints.iter().enumerate() {
            let state = &mut self.joints[i];
            let message = state.sense(joint, law.period, k, (&position[i], &velocity[i]));
            let first = usize::from(law.starts_at_zero);
            self.command[i] = if k < first {
                Lane::ZERO
            } else if k == first && law.takes_over {
                state.take_over(joint, law.period, (reference(i), self.held[i]), &message);
                Lane([self.held[i]; W])
            } else {
                state.law(joint, law.period, k == first, reference(i), &message)
            };
        }
    }

    /// Lets the commands act, after limits that the caller put on them.
    pub(super) fn act(&mut self, law: &SampledLaw) {
        for (i, joint) in law.joints.iter().enumerate() {
            let state = &mut self.joints[i];
            state.send(joint, &self.command[i]);
            let told = state.delay(&self.command[i]);
            (self.mean[i], self.bulge[i]) = state.drive(joint, law.period, &told);
            state.acted = match joint.model.torque {
                TorqueSource::Applied => self.mean[i],
                TorqueSource::Demanded => told,
            };
        }
    }
}

impl Control<1> {
    /// Torque of a drive some time into the interval.
    pub(super) fn torque(&self, law: &SampledLaw, i: usize, elapsed: f64) -> f64 {
        let (joint, state) = (&law.joints[i], &self.joints[i]);
        match joint.model.drive_bandwidth_hz {
            None => self.mean[i][0],
            Some(hz) => {
                let rate = core::f64::consts::TAU * hz;
                // The state has the gap at the interval's end.
                state.told[0] + state.gap[0] * (rate * (law.period - elapsed)).exp()
            }
        }
    }
}

impl<const W: usize> JointState<W> {
    fn length(&self) -> usize {
        6 + self.memory.len() + self.line.len() + 3 * self.way.len() + self.sent.len()
    }

    fn states(&mut self) -> impl Iterator<Item = &mut Lane<W>> {
        [
            &mut self.last_position,
            &mut self.last_velocity,
            &mut self.law_velocity,
            &mut self.acted,
            &mut self.gap,
            &mut self.told,
        ]
        .into_iter()
        .chain(&mut self.memory)
        .chain(&mut self.line)
        .chain(self.way.iter_mut().flatten())
        .chain(&mut self.sent)
    }

    fn sense(
        &mut self,
        joint: &SampledJoint,
        period: f64,
        k: usize,
        (position, velocity): (&Lane<W>, &Lane<W>),
    ) -> [Lane<W>; 3] {
        let mut sensed = *velocity;
        let per_period = period.recip();
        if k > 0 {
            if joint.model.velocity == VelocitySource::Differenced {
                for c in 0..W {
                    sensed[c] = (position[c] - self.last_position[c]) * per_period;
                }
            }
            if let Some(share) = joint.filter {
                for c in 0..W {
                    sensed[c] = self.last_velocity[c] + share * (sensed[c] - self.last_velocity[c]);
                }
            }
        }
        self.last_position = *position;
        self.last_velocity = sensed;
        let fresh = [*position, sensed, self.acted];
        if self.way.is_empty() {
            return fresh;
        }
        if k == 0 {
            self.way.fill(fresh);
        }
        told_on(&mut self.way, fresh)
    }

    fn law(
        &mut self,
        joint: &SampledJoint,
        period: f64,
        first: bool,
        [q, dq, ddq]: Jet,
        [position, velocity, acted]: &[Lane<W>; 3],
    ) -> Lane<W> {
        if let Some(law) = &joint.positions {
            return self.seen((joint, law), first, [q, dq, ddq], [position, velocity, acted]);
        }
        let mut error: [Lane<W>; 2] = [Lane::ZERO; 2];
        for c in 0..W {
            error[0][c] = position[c] - q;
            error[1][c] = velocity[c] - dq;
        }
        let phi_hat = match joint.model.form {
            Form::Observer | Form::Positions => {
                self.observed(joint, period, first, (velocity, acted))
            }
            Form::Literal => self.integrated(joint, period, first, &error),
        };
        let mut command = Lane::<W>::ZERO;
        for c in 0..W {
            let wanted = ddq - joint.kd * error[1][c] - joint.kp * error[0][c];
            command[c] = joint.inertia * wanted + phi_hat[c];
        }
        self.law_velocity = *velocity;
        command
    }

    /// The law's state such that it would have commanded `held`.
    fn take_over(
        &mut self,
        joint: &SampledJoint,
        period: f64,
        ([q, dq, ddq], held): (Jet, f64),
        [position, velocity, _]: &[Lane<W>; 3],
    ) {
        let SampledJoint { inertia, kp, kd, .. } = *joint;
        self.law_velocity = *velocity;
        for c in 0..W {
            let (e, de) = (position[c] - q, velocity[c] - dq);
            let wanted = held / inertia - ddq;
            match (&joint.positions, joint.model.form) {
                (Some(law), _) => {
                    let ahead = period * law.ahead() as f64;
                    let share = ahead * (kd + 0.5 * ahead * kp);
                    let force = kp * (e + ahead * de) + kd * de;
                    (self.memory[0][c], self.memory[1][c]) = (e, de);
                    self.memory[2][c] = wanted + force / (1.0 + share);
                    self.sent.iter_mut().for_each(|sent| sent[c] = wanted);
                }
                (None, Form::Literal) => {
                    let rest = joint.on_error[0] * e + joint.on_error[1] * de;
                    let phi = wanted + kd * de + kp * e;
                    let highest = self.memory.iter_mut().zip(&joint.on_memory).next_back();
                    if let Some((memory, factor)) = highest {
                        memory[c] = (-phi - rest) / factor;
                    }
                }
                (None, _) => self.memory[0][c] = inertia * (wanted + kd * de + kp * e),
            }
        }
        self.fed.fill(ddq);
    }

    /// The law from positions.
    fn seen(
        &mut self,
        (joint, law): (&SampledJoint, &Positions),
        first: bool,
        [q, dq, ddq]: Jet,
        [position, velocity, acted]: [&Lane<W>; 3],
    ) -> Lane<W> {
        let inertia = joint.inertia;
        let error = Lane::<W>::of(|c| position[c] - q);
        if first {
            self.memory[0] = error;
            self.memory[1] = Lane::of(|c| velocity[c] - dq);
        } else {
            let fed = self.fed[law.ahead()];
            let acted = Lane::of(|c| acted[c] * joint.per_inertia - fed);
            law.see(&mut self.memory, &acted, &error);
        }
        self.fed.rotate_right(1);
        self.fed[0] = ddq;
        Lane(law.answer(&self.memory, &self.sent).map(|u| inertia * (u + ddq)))
    }

    /// Adds to what a law from positions expects the arm's own, a sample before, so many times.
    fn expect(&mut self, period: f64, (position, velocity): (&Lane<W>, &Lane<W>), times: f64) {
        for c in 0..W {
            self.memory[0][c] += times * (position[c] - period * velocity[c]);
            self.memory[1][c] += times * velocity[c];
        }
    }

    /// Stores the torque sent, without its feed-forward, for a law from positions.
    fn send(&mut self, joint: &SampledJoint, command: &Lane<W>) {
        if joint.positions.is_some() {
            for i in (1..self.sent.len()).rev() {
                self.sent[i] = self.sent[i - 1];
            }
            let fed = self.fed[0];
            self.sent[0] = Lane(command.map(|torque| torque * joint.per_inertia - fed));
        }
    }

    /// `φ̂` of the observer form.
    fn observed(
        &mut self,
        joint: &SampledJoint,
        period: f64,
        first: bool,
        (velocity, acted): (&Lane<W>, &Lane<W>),
    ) -> Lane<W> {
        if !first {
            let mut innovation = Lane::<W>::ZERO;
            for c in 0..W {
                innovation[c] = period * (acted[c] - self.memory[0][c])
                    - joint.inertia * (velocity[c] - self.law_velocity[c]);
            }
            for (j, gain) in joint.on_memory.iter().enumerate() {
                let next = self.memory.get(j + 1).map_or(Lane::ZERO, |next| *next);
                let own = &mut self.memory[j];
                for c in 0..W {
                    own[c] += period * next[c] + gain * innovation[c];
                }
            }
        }
        self.memory[0]
    }

    /// `φ̂` of the literal form.
    fn integrated(
        &mut self,
        joint: &SampledJoint,
        period: f64,
        first: bool,
        error: &[Lane<W>; 2],
    ) -> Lane<W> {
        let mut total = Lane::<W>::ZERO;
        let mut add = |factor: f64, x: &Lane<W>| {
            for c in 0..W {
                total[c] -= joint.inertia * factor * x[c];
            }
        };
        for (factor, x) in joint.on_error.iter().zip(error) {
            add(*factor, x);
        }
        let mut below = error[0];
        for (memory, factor) in self.memory.iter_mut().zip(&joint.on_memory) {
            if !first {
                for c in 0..W {
                    memory[c] += period * below[c];
                }
            }
            add(*factor, memory);
            below = *memory;
        }
        total
    }

    fn delay(&mut self, command: &Lane<W>) -> Lane<W> {
        if self.line.is_empty() {
            return *command;
        }
        told_on(&mut self.line, *command)
    }

    fn drive(&mut self, joint: &SampledJoint, period: f64, told: &Lane<W>) -> (Lane<W>, Lane<W>) {
        let Some(drive) = &joint.drive else { return (*told, Lane::ZERO) };
        let (mut mean, mut bulge) = (*told, Lane::ZERO);
        for c in 0..W {
            let gap = self.gap[c] + self.told[c] - told[c];
            mean[c] += drive.mean * gap;
            bulge[c] = (drive.double - 0.5 * period * period * drive.mean) * gap;
            self.gap[c] = gap * (1.0 - drive.lost);
        }
        self.told = *told;
        (mean, bulge)
    }
}

/// Puts a new value into a line, and returns the one that arrives at its end.
fn told_on<T: Copy>(line: &mut [T], new: T) -> T {
    let told = line[0];
    for i in 1..line.len() {
        line[i - 1] = line[i];
    }
    if let Some(last) = line.last_mut() {
        *last = new;
    }
    told
}
