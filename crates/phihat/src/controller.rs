//! The arm: one joint law per joint, one sample at a time, all or nothing.

use crate::{Command, JointGains, JointState, Measurement, Real, Reference};

/// A controller for an arm with `N` joints: an array of joint laws.
///
/// The law is decoupled: a joint's torque depends on that joint's signals only. What the arm adds is
/// that a sample counts for all joints or for none: when a measurement or reference of any joint is not
/// finite, or beyond ±2³², every joint holds its last torque.
///
/// # Example
///
/// ```
/// use phihat::{Controller, Form, JointDesign, JointGains, JointState, Measurement, Reference};
///
/// // A joint of 0.8 kg·m², bandwidth 20 rad/s, second-order estimator at 70 rad/s, 1 kHz.
/// let design = JointDesign {
///     inertia: 0.8, kp: 400.0, kd: 40.0, a: &[4900.0, 140.0], period: 1e-3, form: Form::Observer,
/// };
/// let controller = Controller::<f64, 1>::new([JointGains::new(&design)?]);
/// let mut state = [JointState::new()];
///
/// // Two milliradians above a reference at rest: the torque pushes back, M̄ K_p e = 0.64 N·m.
/// let measurement = [Measurement { q: 0.002, dq: 0.0, tau_applied: 0.0 }];
/// let [command] = controller.update(&mut state, &measurement, &[Reference::default()]);
/// assert!((command.tau + 0.64).abs() < 1e-12);
/// # Ok::<(), phihat::GainError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Controller<R, const N: usize> {
    joints: [JointGains<R>; N],
}

impl<R: Real, const N: usize> Controller<R, N> {
    /// A controller from one set of gains per joint.
    pub fn new(joints: [JointGains<R>; N]) -> Self {
        Self { joints }
    }

    /// The gains, in joint order.
    pub fn joints(&self) -> &[JointGains<R>; N] {
        &self.joints
    }

    /// Computes the torques of the whole arm for one sample; see [`JointGains::update`].
    pub fn update(
        &self,
        states: &mut [JointState<R>; N],
        measurements: &[Measurement<R>; N],
        references: &[Reference<R>; N],
    ) -> [Command<R>; N] {
        let mut commands = [Command::default(); N];
        update_joints(&self.joints, states, measurements, references, &mut commands);
        commands
    }
}

/// Computes the torques of an arm for one sample, where the number of joints is known at run time only.
///
/// Joints beyond the shortest of the five slices are left alone; the number answered is returned.
///
/// # Example
///
/// ```
/// use phihat::{
///     Command, Form, JointDesign, JointGains, JointState, Measurement, Reference, update_joints,
/// };
///
/// let design = JointDesign {
///     inertia: 0.8, kp: 400.0, kd: 40.0, a: &[4900.0, 140.0], period: 1e-3, form: Form::Observer,
/// };
/// let joints = 6; // known from a file, say
/// let gains = vec![JointGains::<f64>::new(&design)?; joints];
/// let mut states = vec![JointState::new(); joints];
/// let mut commands = vec![Command::default(); joints];
/// let measurements = vec![Measurement { q: 0.002, ..Measurement::default() }; joints];
/// let references = vec![Reference::default(); joints];
/// let answered = update_joints(&gains, &mut states, &measurements, &references, &mut commands);
/// assert_eq!(answered, joints);
/// assert!(commands.iter().all(|command| command.tau < 0.0));
/// # Ok::<(), phihat::GainError>(())
/// ```
pub fn update_joints<R: Real>(
    gains: &[JointGains<R>],
    states: &mut [JointState<R>],
    measurements: &[Measurement<R>],
    references: &[Reference<R>],
    commands: &mut [Command<R>],
) -> usize {
    let samples = measurements.iter().zip(references);
    let doubt = samples.fold(-R::ZERO, |sum, (m, r)| sum + m.doubt() + r.doubt());
    let admitted = doubt == R::ZERO;
    let joints = gains.iter().zip(states).zip(measurements.iter().zip(references));
    let mut answered = 0;
    for (command, ((gains, state), (measurement, reference))) in commands.iter_mut().zip(joints) {
        *command =
            if admitted { gains.answer(state, measurement, reference) } else { state.hold() };
        answered += 1;
    }
    answered
}
