//! A whole arm under supervision: guard in front, limits behind, one mode machine.

mod act;
mod arrivals;
mod blend;
mod feed;
mod follow;
mod funnel;
mod guard;
mod memory;
mod mode;
mod moment;
mod monitor;
mod option_error;
mod options;
mod range;
mod report;
mod rules;
mod sample;
mod schedule;
mod still;
mod stop;
mod stopping;
mod supervise;
mod watch;

pub use arrivals::Stamp;
pub use funnel::Funnel;
pub use memory::{ArmState, JointMemory};
pub use mode::{Action, Mode, ModeEvents, ModeRequest, Refusal, Transition, next_mode};
pub use option_error::OptionError;
pub use options::{JointOptions, Options, Schedule};
pub use range::JointRange;
pub use report::{Events, Fault, Report};
pub use rules::{ArmRules, JointRules};
pub use sample::{Memories, Request, Rules, Sample};
pub use supervise::supervise;

use crate::{Command, JointGains, Real};

/// A controller for an arm with `N` joints that survives what happens in a laboratory: bad, late, lost and
/// frozen samples, jumps of the reference, joint limits, oscillation, emergency stops and restarts.
///
/// Around the law of each joint it puts
///
/// - a guard: finite, fresh, in order, plausible; what does not pass leaves no trace in any state;
/// - limits: joint range, torque rate, torque, in this order, through one way out;
/// - modes: idle → armed → holding → tracking, and a latched safe stop ([`next_mode`]);
/// - a start: the held torque becomes `φ̂`, the reference starts at the pose and is blended or shaped.
///
/// Call [`Self::step`] once per sample period, whether a new sample came or not. It never panics, blocks,
/// allocates or reads a clock; whatever the bits of its arguments, torques are finite and within limits.
///
/// # Example
///
/// ```
/// use phihat::{
///     Form, JointDesign, JointGains, JointOptions, Limits, Measurement, Mode, ModeRequest, Options,
///     Reference, Request, Sample, Stamp, Supervisor, SupervisorState,
/// };
///
/// let design = JointDesign {
///     inertia: 0.8, kp: 400.0, kd: 40.0, a: &[4900.0, 140.0], period: 1e-3, form: Form::Observer,
/// };
/// let limits = Limits::new(Some(87.0), Some(1000.0), 1e-3)?;
/// let gains = JointGains::<f64>::new(&design)?.with_limits(limits);
/// let joint = JointOptions { velocity_max: Some(2.5), error_stop: Some(0.1), ..Default::default() };
/// let arm = Supervisor::new([gains; 2], &[joint; 2], &Options::new(1_000_000))?;
///
/// let mut state = SupervisorState::new();
/// let reference = [Reference { q: 0.3, dq: 0.0, ddq: 0.0 }; 2];
/// for k in 0..1000_u64 {
///     // From the robot; here it stands still.
///     let joints = [Measurement { q: 0.3, dq: 0.0, tau_applied: 0.0 }; 2];
///     let t_ns = k * 1_000_000;
///     let sample = Sample { stamp: Stamp { sequence: k, t_ns }, now_ns: t_ns, joints: &joints };
///     let mode = match k { 0 => ModeRequest::Arm, 1 => ModeRequest::Hold, _ => ModeRequest::Track };
///     let request = Request { mode, references: &reference, preset: None, feed_forward: None };
///     let answer = arm.step(&mut state, &sample, &request);
///     assert!(answer.report.fault.is_none());
///     // To the robot: answer.commands[i].tau
/// }
/// assert_eq!(state.arm.mode(), Mode::Tracking);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Supervisor<R, const N: usize> {
    arm: ArmRules<R>,
    joints: [JointRules<R>; N],
}

/// State of a [`Supervisor`] between samples; owned by the caller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SupervisorState<R, const N: usize> {
    /// The arm's part.
    pub arm: ArmState,
    /// The joints' part, in the controller's order.
    pub joints: [JointMemory<R>; N],
}

impl<R: Real, const N: usize> SupervisorState<R, N> {
    /// The state before the first sample: idle, with nothing known.
    #[must_use]
    pub fn new() -> Self {
        Self { arm: ArmState::new(), joints: [JointMemory::new(); N] }
    }
}

impl<R: Real, const N: usize> Default for SupervisorState<R, N> {
    fn default() -> Self {
        Self::new()
    }
}

/// The torques of a whole arm for one sample, and what the supervisor reports of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer<R, const N: usize> {
    /// Torque and estimate of each joint.
    pub commands: [Command<R>; N],
    /// Mode, faults, events.
    pub report: Report,
}

impl<R: Real, const N: usize> Supervisor<R, N> {
    /// Makes a supervisor from gains and options of each joint, in joint order. Torque limits are those of the gains.
    ///
    /// # Errors
    ///
    /// [`OptionError`], naming joint, option and value.
    pub fn new(
        gains: [JointGains<R>; N],
        joints: &[JointOptions<R>; N],
        options: &Options,
    ) -> Result<Self, OptionError> {
        let arm = ArmRules::new(options)?;
        let mut rules = gains.map(|gains| JointRules::plain(&gains));
        for (joint, (rule, own)) in rules.iter_mut().zip(joints).enumerate() {
            *rule = JointRules::new(joint, rule.running(), own, options)?;
        }
        Ok(Self { arm, joints: rules })
    }

    /// Judges one sample and computes the torques of the whole arm; see [`supervise`].
    pub fn step(
        &self,
        state: &mut SupervisorState<R, N>,
        sample: &Sample<'_, R>,
        request: &Request<'_, R>,
    ) -> Answer<R, N> {
        let mut commands = [Command::default(); N];
        let report = supervise(
            Rules { arm: &self.arm, joints: &self.joints },
            Memories { arm: &mut state.arm, joints: &mut state.joints },
            sample,
            request,
            &mut commands,
        );
        Answer { commands, report }
    }

    /// Changes the gains while the arm runs, without a step in torque: what the new gains demand
    /// differently at the last sample is faded out over the blend time. Options stay.
    ///
    /// # Errors
    ///
    /// [`OptionError::Period`] when gains are for another sample period; then nothing changes.
    pub fn change_gains(
        &mut self,
        state: &mut SupervisorState<R, N>,
        gains: [JointGains<R>; N],
    ) -> Result<(), OptionError> {
        for (joint, (rule, new)) in self.joints.iter().zip(&gains).enumerate() {
            rule.fits(joint, new)?;
        }
        let joints = self.joints.iter_mut().zip(&mut state.joints).zip(gains);
        for ((rule, memory), new) in joints {
            rule.exchange(memory, new, state.arm.raised);
        }
        Ok(())
    }
}
