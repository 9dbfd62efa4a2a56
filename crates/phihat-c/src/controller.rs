//! The controller behind its handle.

use phihat::{Command, JointGains, JointState, Measurement, Reference, update_joints};

use crate::border::{answer, element, present, structure};
use crate::error::{RefusedCall, Status, phihat_error};
use crate::laws::law;
use crate::types::{
    PHIHAT_RATE_LIMITED, PHIHAT_REFUSED, PHIHAT_SATURATED, phihat_command, phihat_joint,
    phihat_sample,
};

/// A controller for an arm: gains, what they remember, and room for one sample.
#[derive(Debug)]
pub struct phihat_controller {
    gains: Vec<JointGains<f64>>,
    states: Vec<JointState<f64>>,
    /// The states before a sample, to go back to.
    before: Vec<JointState<f64>>,
    measurements: Vec<Measurement<f64>>,
    references: Vec<Reference<f64>>,
    commands: Vec<Command<f64>>,
}

impl phihat_controller {
    /// All joints or none; `true` where the sample is refused.
    fn update(&mut self) -> bool {
        let Self { gains, states, before, measurements, references, commands } = self;
        before.copy_from_slice(states);
        update_joints(gains, states, measurements, references, commands);
        let refused = commands.iter().any(|answer| answer.status.refused);
        if refused {
            // A joint whose own numbers overflow refuses alone; the others go back and hold too.
            states.copy_from_slice(before);
            for measurement in measurements.iter_mut() {
                measurement.q = f64::NAN;
            }
            update_joints(gains, states, measurements, references, commands);
        }
        refused
    }
}

/// Makes a controller, at rest and with zero knowledge of the arm. Allocates; not for the control loop.
///
/// @param joints     Gains and limits, one per joint.
/// @param count      Number of joints, at least 1.
/// @param period_s   Time between samples, positive [s].
/// @param controller Receives the handle; free it with phihat_controller_destroy().
/// @param error      Receives what was wrong; set its size first. May be null.
///
/// # Safety
///
/// Every pointer is null or valid for what the header says of it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn phihat_controller_create(
    joints: *const phihat_joint,
    count: usize,
    period_s: f64,
    controller: *mut *mut phihat_controller,
    error: *mut phihat_error,
) -> Status {
    let call = || {
        if controller.is_null() {
            return Err(RefusedCall::new(Status::NullPointer, "the handle's pointer is null"));
        }
        if count == 0 {
            return Err(RefusedCall::new(
                Status::WrongJoints,
                "a controller has at least one joint",
            ));
        }
        let mut made = phihat_controller {
            gains: room(count)?,
            states: room(count)?,
            before: room(count)?,
            measurements: room(count)?,
            references: room(count)?,
            commands: room(count)?,
        };
        for index in 0..count {
            // SAFETY: the caller's array has `count` elements.
            let joint = unsafe { element(joints, index, phihat_joint::OLDER) }?;
            made.gains.push(law(&joint, period_s).map_err(|why| why.at(index))?);
        }
        made.states.resize(count, JointState::new());
        made.before.resize(count, JointState::new());
        made.measurements.resize(count, Measurement::default());
        made.references.resize(count, Reference::default());
        made.commands.resize(count, Command::default());
        // SAFETY: not null, so it can be written to.
        unsafe { controller.write(Box::into_raw(Box::new(made))) };
        Ok(Status::Ok)
    };
    // SAFETY: the caller's.
    unsafe { answer(error, call) }
}

/// Frees a controller; null is allowed. The handle is gone afterwards.
///
/// # Safety
///
/// `controller` is null or came from phihat_controller_create() and was not freed before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn phihat_controller_destroy(controller: *mut phihat_controller) {
    if !controller.is_null() {
        // SAFETY: made by `Box::into_raw` and not freed before.
        drop(unsafe { Box::from_raw(controller) });
    }
}

/// Number of joints; 0 for a null handle.
///
/// # Safety
///
/// `controller` is null or a living handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn phihat_controller_joints(controller: *const phihat_controller) -> usize {
    // SAFETY: null or a living handle.
    unsafe { controller.as_ref() }.map_or(0, |c| c.gains.len())
}

/// Back to rest and zero knowledge, as after phihat_controller_create().
///
/// # Safety
///
/// `controller` is null or a living handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn phihat_controller_reset(controller: *mut phihat_controller) -> Status {
    let call = || {
        // SAFETY: the caller's.
        unsafe { handle(controller) }?.states.fill(JointState::new());
        Ok(Status::Ok)
    };
    // SAFETY: no error is wanted.
    unsafe { answer(core::ptr::null_mut(), call) }
}

/// Answers one sample of the whole arm; call it once per period. Real time. PHIHAT_STATUS_REFUSED: the
/// sample was not finite, or beyond +-2^32 (4.3e9), or led to what is not finite; every joint holds its last
/// torque, which is in `command`, and no joint remembers the sample. The arrays of sample and command may
/// overlap.
///
/// # Safety
///
/// Every pointer is null or valid for what the header says of it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn phihat_controller_update(
    controller: *mut phihat_controller,
    sample: *const phihat_sample,
    command: *const phihat_command,
) -> Status {
    let call = || {
        // SAFETY: the caller's.
        let (c, sample, to) =
            unsafe { (handle(controller)?, structure(sample)?, structure(command)?) };
        // SAFETY: the caller's.
        unsafe { copy_sample(sample, &mut c.measurements, &mut c.references) }?;
        present([to.tau.cast_const()])?;
        joints_match(c.gains.len(), to.joints)?;
        let refused = c.update();
        // SAFETY: not null where written to, and with one entry per joint.
        unsafe { give(&c.commands, to) };
        Ok(if refused { Status::Refused } else { Status::Ok })
    };
    // SAFETY: no error is wanted.
    unsafe { answer(core::ptr::null_mut(), call) }
}

/// Takes over a moving or loaded arm without a bump: the torque that the next phihat_controller_update()
/// commands continues `tau`, the torque that acts now [N m]; beyond a joint's largest torque it counts as
/// that. If the sample or tau is not finite, or beyond +-2^32 (4.3e9), nothing changes and the answer is
/// PHIHAT_STATUS_REFUSED.
///
/// # Safety
///
/// Every pointer is null or valid for what the header says of it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn phihat_controller_resume(
    controller: *mut phihat_controller,
    sample: *const phihat_sample,
    tau: *const f64,
) -> Status {
    let call = || {
        // SAFETY: the caller's.
        let (c, sample) = unsafe { (handle(controller)?, structure(sample)?) };
        // SAFETY: the caller's.
        unsafe { copy_sample(sample, &mut c.measurements, &mut c.references) }?;
        present([tau])?;
        // All joints or none: tried on copies, which need no heap.
        for commit in [false, true] {
            for (i, gains) in c.gains.iter().enumerate() {
                let mut state = c.states[i];
                // SAFETY: not null, and with one entry per joint.
                let tau = unsafe { tau.add(i).read() };
                if !gains.resume(&mut state, &c.measurements[i], &c.references[i], tau) {
                    return Ok(Status::Refused);
                }
                if commit {
                    c.states[i] = state;
                }
            }
        }
        Ok(Status::Ok)
    };
    // SAFETY: no error is wanted.
    unsafe { answer(core::ptr::null_mut(), call) }
}

/// Copies a sample in.
///
/// # Safety
///
/// The sample's arrays are null or have as many entries as it says.
pub(crate) unsafe fn copy_sample(
    sample: &phihat_sample,
    measurements: &mut [Measurement<f64>],
    references: &mut [Reference<f64>],
) -> Result<(), RefusedCall> {
    let phihat_sample { q, dq, tau_applied, q_des, dq_des, ddq_des, .. } = *sample;
    present([q, dq, tau_applied, q_des, dq_des, ddq_des])?;
    joints_match(measurements.len(), sample.joints)?;
    for (i, (measurement, reference)) in measurements.iter_mut().zip(references).enumerate() {
        // SAFETY: not null, and with one entry per joint.
        unsafe {
            measurement.q = q.add(i).read();
            measurement.dq = dq.add(i).read();
            measurement.tau_applied = tau_applied.add(i).read();
            reference.q = q_des.add(i).read();
            reference.dq = dq_des.add(i).read();
            reference.ddq = ddq_des.add(i).read();
        }
    }
    Ok(())
}

/// Copies an answer out.
///
/// # Safety
///
/// `tau` is not null; what is not null has one entry per command.
pub(crate) unsafe fn give(commands: &[Command<f64>], to: &phihat_command) {
    for (i, answer) in commands.iter().enumerate() {
        // SAFETY: the caller's.
        unsafe {
            to.tau.add(i).write(answer.tau);
            if !to.phi_hat.is_null() {
                to.phi_hat.add(i).write(answer.phi_hat);
            }
            if !to.flags.is_null() {
                to.flags.add(i).write(flags(answer));
            }
        }
    }
}

/// The controller behind a handle.
///
/// # Safety
///
/// Null, or a living handle that no other thread uses.
unsafe fn handle<'a>(
    controller: *mut phihat_controller,
) -> Result<&'a mut phihat_controller, RefusedCall> {
    // SAFETY: the caller's.
    let living = unsafe { controller.as_mut() };
    living.ok_or_else(|| RefusedCall::new(Status::NullPointer, "the controller's handle is null"))
}

pub(crate) fn joints_match(own: usize, given: usize) -> Result<(), RefusedCall> {
    let why = "the number of joints is not that of the controller";
    if own == given { Ok(()) } else { Err(RefusedCall::new(Status::WrongJoints, why)) }
}

pub(crate) fn room<T>(count: usize) -> Result<Vec<T>, RefusedCall> {
    let mut vec = Vec::new();
    let short = |_| RefusedCall::new(Status::OutOfMemory, "there is no memory left");
    vec.try_reserve_exact(count).map_err(short)?;
    Ok(vec)
}

fn flags(command: &Command<f64>) -> u32 {
    let flag = |set: bool, flag: u32| if set { flag } else { 0 };
    flag(command.status.saturated, PHIHAT_SATURATED)
        | flag(command.status.rate_limited, PHIHAT_RATE_LIMITED)
        | flag(command.status.refused, PHIHAT_REFUSED)
}
