//! The laws of many arms: in lanes where all have the observer form, else arm by arm.

use phihat::{
    Command, JointGains, JointState, Limits, Measurement, ObserverNumbers, Reference, update_joints,
};
use phihat_model::{FileChoice, Lanes};

use crate::control::LawAlone;

/// Command to a joint of every arm.
#[derive(Debug, Clone, Copy)]
pub(super) struct CommandLanes {
    /// Torque \[N·m\].
    pub(super) tau: Lanes,
    /// `φ̂` \[N·m\].
    pub(super) phi_hat: Lanes,
    /// Arms on which the limit of torque, and that of its rate, acted.
    pub(super) over_torque: FileChoice,
    pub(super) over_rate: FileChoice,
}

/// The laws of all arms.
#[derive(Debug)]
pub(super) enum LawLanes {
    /// In lanes, joint by joint.
    Lanes(Vec<Observer>),
    /// Arm by arm.
    Each(Vec<ArmCommand>),
}

/// The law of one joint of every arm, in observer form: `JointGains::update`, operation by operation.
#[derive(Debug)]
pub(super) struct Observer {
    numbers: ObserverNumbers<Lanes>,
    /// The highest order of all arms; beyond an arm's own, its memory stays zero.
    order: usize,
    limits: [Lanes; 2],
    memory: [Lanes; phihat::ORDER_MAX],
    dq: Lanes,
    tau: Lanes,
}

/// The law of one arm.
#[derive(Debug)]
pub(super) struct ArmCommand {
    gains: Vec<JointGains<f64>>,
    states: Vec<JointState<f64>>,
    takes_over: Option<Vec<f64>>,
    measured: Vec<Measurement<f64>>,
    wanted: Vec<Reference<f64>>,
    commands: Vec<Command<f64>>,
}

impl LawLanes {
    /// The laws of arms, in their order; free lanes have the last one's.
    pub(super) fn new(arms: &[LawAlone<'_>]) -> Option<Self> {
        let joints = arms.first()?.0.len();
        let fresh = |(gains, states, held): &LawAlone<'_>| {
            held.is_none()
                && gains.iter().all(|own| own.observer().is_some())
                && states.iter().all(|state| *state == JointState::new())
        };
        Some(if arms.iter().all(fresh) {
            let joint = |i: usize| Observer::new(arms, i);
            Self::Lanes((0..joints).map(joint).collect::<Option<_>>()?)
        } else {
            Self::Each(arms.iter().map(ArmCommand::new).collect())
        })
    }

    /// Answers the first or a later sample. `false`: some law refused it.
    pub(super) fn answer(
        &mut self,
        first: bool,
        (seen, wanted): (&[[Lanes; 3]], &[[Lanes; 3]]),
        out: &mut [CommandLanes],
    ) -> bool {
        match self {
            Self::Lanes(joints) => {
                let sides = joints.iter_mut().zip(seen.iter().zip(wanted));
                let mut fits = true;
                for (out, (law, (seen, wanted))) in out.iter_mut().zip(sides) {
                    fits &= law.answer(first, *seen, *wanted, out);
                }
                fits
            }
            Self::Each(arms) => {
                let mut answered = arms.iter_mut().enumerate();
                answered.all(|(lane, arm)| arm.answer(lane, seen, wanted))
                    && ArmCommand::gather(arms, out)
            }
        }
    }
}

impl Observer {
    fn new(arms: &[LawAlone<'_>], joint: usize) -> Option<Self> {
        let gains = |k: usize| arms.get(k).or(arms.last()).and_then(|arm| arm.0.get(joint));
        let all: [Option<(ObserverNumbers<f64>, &Limits<f64>)>; Lanes::COUNT] =
            core::array::from_fn(|k| Some((gains(k)?.observer()?, gains(k)?.limits())));
        let lane = |of: &dyn Fn(&ObserverNumbers<f64>, &Limits<f64>) -> f64| {
            Lanes::from(all.map(|own| own.map_or(0.0, |(numbers, limits)| of(&numbers, limits))))
        };
        let orders = (0..Lanes::COUNT).filter_map(|k| gains(k).map(JointGains::order));
        all[0]?;
        Some(Self {
            numbers: ObserverNumbers {
                period: lane(&|own, _| own.period),
                inertia: lane(&|own, _| own.inertia),
                kp: lane(&|own, _| own.kp),
                kd: lane(&|own, _| own.kd),
                alpha: core::array::from_fn(|j| lane(&|own, _| own.alpha[j])),
            },
            order: orders.max()?,
            limits: [lane(&|_, limits| limits.torque()), lane(&|_, limits| limits.step())],
            memory: [Lanes::default(); phihat::ORDER_MAX],
            dq: Lanes::default(),
            tau: Lanes::default(),
        })
    }

    #[inline]
    fn answer(
        &mut self,
        first: bool,
        [q, dq, applied]: [Lanes; 3],
        [q_d, dq_d, ddq_d]: [Lanes; 3],
        out: &mut CommandLanes,
    ) -> bool {
        let ObserverNumbers { period, inertia, kp, kd, alpha } = &self.numbers;
        if !first {
            let momentum = *inertia * (dq - self.dq);
            let innovation = *period * (applied - self.memory[0]) - momentum;
            for j in 0..self.order {
                let above = match self.memory.get(j + 1) {
                    Some(above) if j + 1 < self.order => *above,
                    _ => Lanes::default(),
                };
                self.memory[j] += *period * above + alpha[j] * innovation;
            }
        }
        self.dq = dq;
        let (e, de) = (q - q_d, dq - dq_d);
        let outer = *inertia * (ddq_d - *kd * de - *kp * e);
        let [phi_hat, d1, d2, d3] = self.memory;
        let demand = outer + phi_hat;
        let [torque, step] = self.limits;
        let change = demand - self.tau;
        let over_rate = change.abs().exceeds(step);
        let limited = over_rate.pick(self.tau + saturated(change, step), demand);
        self.tau = saturated(limited, torque);
        let over_torque = demand.abs().exceeds(torque);
        *out = CommandLanes { tau: self.tau, phi_hat, over_torque, over_rate };
        (demand + (d1 + d2 + d3)).all_below(f64::INFINITY)
    }
}

/// `x` limited to `[−limit, limit]`.
#[inline]
fn saturated(x: Lanes, limit: Lanes) -> Lanes {
    let below = (-limit).exceeds(x).pick(-limit, x);
    x.exceeds(limit).pick(limit, below)
}

impl ArmCommand {
    fn new((gains, states, held): &LawAlone<'_>) -> Self {
        let n = gains.len();
        let mut commands = vec![Command::default(); n];
        for (command, torque) in commands.iter_mut().zip(held.iter().flatten()) {
            command.tau = *torque;
        }
        Self {
            gains: gains.to_vec(),
            states: states.to_vec(),
            takes_over: held.clone(),
            measured: vec![Measurement::default(); n],
            wanted: vec![Reference::default(); n],
            commands,
        }
    }

    /// As `ControlSide::step`; `false`: a joint refused.
    fn answer(&mut self, lane: usize, seen: &[[Lanes; 3]], wanted: &[[Lanes; 3]]) -> bool {
        let own = |all: &[Lanes; 3]| all.map(|x| <[f64; Lanes::COUNT]>::from(x)[lane]);
        for (measured, seen) in self.measured.iter_mut().zip(seen) {
            let [q, dq, tau_applied] = own(seen);
            *measured = Measurement { q, dq, tau_applied };
        }
        for (reference, wanted) in self.wanted.iter_mut().zip(wanted) {
            let [q, dq, ddq] = own(wanted);
            *reference = Reference { q, dq, ddq };
        }
        if self.takes_over.take().is_some() {
            let joints = self.gains.iter().zip(&mut self.states).zip(&mut self.commands);
            let sides = self.measured.iter().zip(&self.wanted);
            for (((gains, state), command), (measured, wanted)) in joints.zip(sides) {
                gains.resume(state, measured, wanted, command.tau);
                *command = gains.limits().command(command.tau, command.tau);
            }
        } else {
            let Self { gains, states, measured, wanted, commands, .. } = self;
            update_joints(gains, states, measured, wanted, commands);
        }
        self.commands.iter().all(|command| !command.status.refused)
    }

    fn gather(arms: &[Self], out: &mut [CommandLanes]) -> bool {
        for (i, out) in out.iter_mut().enumerate() {
            let command = |k: usize| arms.get(k).or(arms.last()).map(|arm| arm.commands[i]);
            let all: [Command<f64>; Lanes::COUNT] =
                core::array::from_fn(|k| command(k).unwrap_or_default());
            *out = CommandLanes {
                tau: Lanes::from(all.map(|own| own.tau)),
                phi_hat: Lanes::from(all.map(|own| own.phi_hat)),
                over_torque: FileChoice::from(all.map(|own| own.status.saturated)),
                over_rate: FileChoice::from(all.map(|own| own.status.rate_limited)),
            };
        }
        true
    }
}

impl Default for CommandLanes {
    fn default() -> Self {
        let (zero, none) = (Lanes::default(), FileChoice::from([false; Lanes::COUNT]));
        Self { tau: zero, phi_hat: zero, over_torque: none, over_rate: none }
    }
}
