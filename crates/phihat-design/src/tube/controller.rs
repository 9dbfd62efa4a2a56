//! The control side of all joints, for the nominal run and for small deviations from it.

use phihat_certificate::Gains;

use crate::lanes::Lane;
pub(super) use crate::sampled::control_side::Jet;
use crate::sampled::control_side::{ControlSide, ControlState};
use crate::sampled::{Law, LoopModel};

/// Constant part of the loop: sensors, law, delays, drives, per joint.
#[derive(Debug, Clone)]
pub(super) struct SampledLaw {
    joints: Vec<ControlSide>,
    /// Sample at which the law begins; before it the command is zero.
    first: usize,
    /// The first command is the torque that held the arm before: [`TubeControl::holding`].
    takes_over: bool,
}

impl SampledLaw {
    /// Gains in their loops; a robot may take zero alone as its first torque.
    pub(super) fn new(
        gains: &Gains,
        models: &[LoopModel],
        (starts_at_zero, takes_over): (bool, bool),
    ) -> Self {
        let joints = gains.joints.iter().zip(models).map(|(record, model)| {
            let law = Law::or_none(record, model);
            ControlSide::new(law, record.inertia_kg_m2, model)
        });
        Self { joints: joints.collect(), first: usize::from(starts_at_zero), takes_over }
    }

    /// Number of states per run.
    pub(super) fn states(&self) -> usize {
        self.joints.iter().map(|side| side.powers().len()).sum()
    }

    /// Returns true if a law subtracts its feed-forward from the torque that acted.
    pub(super) fn subtracts_feed_forward(&self) -> bool {
        self.joints.iter().any(ControlSide::subtracts_feed_forward)
    }

    /// Returns true if a law uses a measured velocity.
    pub(super) fn measures_velocity(&self) -> bool {
        self.joints.iter().any(ControlSide::measures_velocity)
    }

    /// Returns true if torque changes within a sample.
    pub(super) fn bulges(&self) -> bool {
        self.joints.iter().any(ControlSide::lags)
    }
}

/// The state of all joints' control sides, for `W` runs at once.
#[derive(Debug, Clone)]
pub(super) struct TubeControl<const W: usize> {
    joints: Vec<ControlState<W>>,
    /// Torque command of the law at this sample \[N·m\].
    pub(super) command: Vec<Lane<W>>,
    /// Torque that held the arm before the first sample; 0 of a deviation.
    held: Vec<f64>,
    /// Mean torque over the interval that begins at this sample.
    pub(super) mean: Vec<Lane<W>>,
    /// `∫∫ τ − ½T² mean`: what the drive's curve adds to a unit inertia's way over the interval.
    pub(super) bulge: Vec<Lane<W>>,
}

impl<const W: usize> TubeControl<W> {
    pub(super) fn new(law: &SampledLaw) -> Self {
        let zero = vec![Lane::ZERO; law.joints.len()];
        Self {
            joints: law.joints.iter().map(ControlState::new).collect(),
            command: zero.clone(),
            held: vec![0.0; law.joints.len()],
            mean: zero.clone(),
            bulge: zero,
        }
    }

    /// The same after torques that held the arm for long.
    pub(super) fn holding(mut self, held: &[f64]) -> Self {
        for (state, torque) in self.joints.iter_mut().zip(held) {
            state.hold(*torque);
        }
        self.held.copy_from_slice(held);
        self
    }

    /// Shows every state, joint after joint, in a fixed order.
    pub(super) fn each(&mut self, law: &SampledLaw, mut visit: impl FnMut(usize, &mut Lane<W>)) {
        let joints = law.joints.iter().zip(&mut self.joints);
        let states = joints.flat_map(|(side, state)| state.states(side));
        states.enumerate().for_each(|(at, state)| visit(at, state));
    }

    /// Torque commanded last, where the law stores it \[N·m\]; else 0.
    pub(super) fn sent_last(&self, law: &SampledLaw, i: usize) -> Lane<W> {
        self.joints[i].sent_last(&law.joints[i])
    }

    /// Laws that store their torques: replaces the motion that they estimate and the torque sent by their differences
    /// from the true motion and from the torque wanted; after commands have acted.
    pub(super) fn come_apart(&mut self, law: &SampledLaw, arm: (&[Lane<W>], &[Lane<W>])) {
        for (i, (side, state)) in law.joints.iter().zip(&mut self.joints).enumerate() {
            state.become_relative(side, (&arm.0[i], &arm.1[i]));
        }
    }

    /// The inverse of [`Self::come_apart`].
    pub(super) fn come_together(&mut self, law: &SampledLaw, arm: (&[Lane<W>], &[Lane<W>])) {
        for (i, (side, state)) in law.joints.iter().zip(&mut self.joints).enumerate() {
            state.become_absolute(side, (&arm.0[i], &arm.1[i]));
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
        let (early, begins) = (k <= law.first, k == law.first);
        for (i, (side, state)) in law.joints.iter().zip(&mut self.joints).enumerate() {
            let measured = (&position[i], &velocity[i]);
            let message = state.sense(side, (k == 0, early), measured);
            self.command[i] = if k < law.first {
                Lane::ZERO
            } else if begins && law.takes_over {
                state.take_over(side, (self.held[i], reference(i)), &message);
                Lane([self.held[i]; W])
            } else {
                state.command(side, begins, reference(i), &message)
            };
        }
    }

    /// Lets the commands act, after limits that the caller put on them.
    pub(super) fn act(&mut self, law: &SampledLaw) {
        for (i, (side, state)) in law.joints.iter().zip(&mut self.joints).enumerate() {
            (self.mean[i], self.bulge[i]) = state.act(side, &self.command[i]);
        }
    }
}

impl TubeControl<1> {
    /// Torque of a drive some time into the interval.
    pub(super) fn torque(&self, law: &SampledLaw, i: usize, elapsed: f64) -> f64 {
        self.joints[i].torque(&law.joints[i], elapsed)[0]
    }
}
