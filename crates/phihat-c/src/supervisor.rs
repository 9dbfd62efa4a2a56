//! The supervisor behind its handle.

use core::mem::offset_of;

use phihat::{
    ArmRules, ArmState, Command, Events, Fault, JointMemory, JointRules, Measurement, Memories,
    Mode, ModeRequest, OptionError, Reference, Refusal as Denial, Report, Request, Rules, Sample,
    Stamp, supervise,
};

use crate::border::{answer, element, present, structure, write_structure};
use crate::controller::{copy_sample, give, joints_match, room};
use crate::error::{RefusedCall, Status, phihat_error};
use crate::guard::{phihat_guard, phihat_supervision};
use crate::laws::law;
use crate::types::{phihat_command, phihat_joint, phihat_sample};

/// Request: no torque; from armed and from a stop only.
pub const PHIHAT_REQUEST_IDLE: u32 = 0;
/// Request: get ready; counts when it is new.
pub const PHIHAT_REQUEST_ARM: u32 = 1;
/// Request: hold the pose.
pub const PHIHAT_REQUEST_HOLD: u32 = 2;
/// Request: follow the reference.
pub const PHIHAT_REQUEST_TRACK: u32 = 3;
/// Request: safe stop.
pub const PHIHAT_REQUEST_STOP: u32 = 4;

/// Mode: no torque.
pub const PHIHAT_MODE_IDLE: u32 = 0;
/// Mode: ready; the held torque and damping act.
pub const PHIHAT_MODE_ARMED: u32 = 1;
/// Mode: the law holds a pose.
pub const PHIHAT_MODE_HOLDING: u32 = 2;
/// Mode: the law follows the reference.
pub const PHIHAT_MODE_TRACKING: u32 = 3;
/// Mode: latched; the law brings the arm to rest and holds it there, then the brakes. Left by a new PHIHAT_REQUEST_ARM.
pub const PHIHAT_MODE_SAFE_STOP: u32 = 4;

/// A controller under supervision, for an arm.
#[derive(Debug)]
pub struct phihat_supervisor {
    arm: ArmRules<f64>,
    rules: Vec<JointRules<f64>>,
    state: ArmState,
    memories: Vec<JointMemory<f64>>,
    measurements: Vec<Measurement<f64>>,
    references: Vec<Reference<f64>>,
    preset: Vec<f64>,
    feed_forward: Vec<f64>,
    commands: Vec<Command<f64>>,
}

/// Number and time of a sample, and the request of the caller.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct phihat_request {
    /// sizeof(phihat_request).
    pub size: usize,
    /// Number of the sample, counted by the robot; repeat the last one when none came.
    pub sequence: u64,
    /// When the sample was taken, by any clock that goes forward [ns].
    pub t_ns: u64,
    /// Now, by the same clock [ns].
    pub now_ns: u64,
    /// Torques that hold the arm [N m], used when it is armed; null: those of the last stop, or zero.
    pub preset: *const f64,
    /// PHIHAT_REQUEST_IDLE, _ARM, _HOLD, _TRACK or _STOP: a level, repeated at every sample.
    pub mode: u32,
    /// Feed-forward torque along the reference in force, in addition to inertia times ddq_des [N m], one
    /// entry per joint, as the gravity of a description; null: none. A law from positions estimates the rest,
    /// and the feed-forward begins and ends without a step in torque; the other forms do not use it. One that
    /// is not finite is refused, and the last one held. phi_hat of the command is the sum of the estimate and
    /// this.
    pub feed_forward: *const f64,
}

impl phihat_request {
    /// sizeof(phihat_request) of the first header, which had no member from `feed_forward` on.
    pub(crate) const OLDER: &[usize] = &[offset_of!(Self, feed_forward)];
}

/// Report on a sample.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct phihat_report {
    /// sizeof(phihat_report).
    pub size: usize,
    /// Joint of the fault, from 0; SIZE_MAX without a fault.
    pub fault_joint: usize,
    /// Fault that stopped the arm, stored until the arm is armed again, as in "link-lost"; null without a
    /// fault.
    pub fault: *const core::ffi::c_char,
    /// Why the request was not granted, as in "not-at-rest"; null if it was.
    pub refusal: *const core::ffi::c_char,
    /// PHIHAT_MODE_IDLE, _ARMED, _HOLDING, _TRACKING or _SAFE_STOP, from this sample on.
    pub mode: u32,
    /// Set of events; phihat_event_text() names each bit.
    pub events: u32,
    /// 1: the brakes should be closed.
    pub brake: u32,
    /// Samples missed in a row.
    pub misses: u32,
    /// Samples missed of the last 64.
    pub lost: u32,
}

/// Makes a supervised controller, idle. Allocates; not for the control loop.
///
/// @param joints      Gains and limits, one per joint.
/// @param guards      Limits and monitors, one per joint; null: as phihat_guard_default() sets them.
/// @param count       Number of joints, at least 1.
/// @param supervision Options of the supervised arm.
/// @param supervisor  Receives the handle; free it with phihat_supervisor_destroy().
/// @param error       Receives what was wrong; set its size first. May be null.
///
/// # Safety
///
/// Every pointer is null or valid for what the header says of it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn phihat_supervisor_create(
    joints: *const phihat_joint,
    guards: *const phihat_guard,
    count: usize,
    supervision: *const phihat_supervision,
    supervisor: *mut *mut phihat_supervisor,
    error: *mut phihat_error,
) -> Status {
    let call = || {
        if supervisor.is_null() {
            return Err(RefusedCall::new(Status::NullPointer, "the handle's pointer is null"));
        }
        if count == 0 {
            return Err(RefusedCall::new(Status::WrongJoints, "an arm has at least one joint"));
        }
        // SAFETY: the caller's.
        let options = unsafe { element(supervision, 0, phihat_supervision::OLDER) }?.options();
        let arm = ArmRules::new(&options).map_err(|e| refused(e, None))?;
        let period = options.period_ns as f64 * 1e-9;
        let mut rules = room(count)?;
        for index in 0..count {
            // SAFETY: the caller's array has `count` elements.
            let joint = unsafe { element(joints, index, phihat_joint::OLDER) }?;
            let law = law(&joint, period).map_err(|why| why.at(index))?;
            let guard = if guards.is_null() {
                phihat::JointOptions::default()
            } else {
                // SAFETY: the caller's array has `count` elements.
                unsafe { element(guards, index, phihat_guard::OLDER) }?
                    .options()
                    .map_err(|why| why.at(index))?
            };
            let rule = JointRules::new(index, &law, &guard, &options);
            rules.push(rule.map_err(|e| refused(e, Some(index)))?);
        }
        let mut made = phihat_supervisor {
            arm,
            rules,
            state: ArmState::new(),
            memories: room(count)?,
            measurements: room(count)?,
            references: room(count)?,
            preset: room(count)?,
            feed_forward: room(count)?,
            commands: room(count)?,
        };
        made.memories.resize(count, JointMemory::new());
        made.measurements.resize(count, Measurement::default());
        made.references.resize(count, Reference::default());
        made.preset.resize(count, 0.0);
        made.feed_forward.resize(count, 0.0);
        made.commands.resize(count, Command::default());
        // SAFETY: not null, so it can be written to.
        unsafe { supervisor.write(Box::into_raw(Box::new(made))) };
        Ok(Status::Ok)
    };
    // SAFETY: the caller's.
    unsafe { answer(error, call) }
}

/// Frees a supervised controller; null is allowed. The handle is gone afterwards.
///
/// # Safety
///
/// `supervisor` is null or came from phihat_supervisor_create() and was not freed before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn phihat_supervisor_destroy(supervisor: *mut phihat_supervisor) {
    if !supervisor.is_null() {
        // SAFETY: made by `Box::into_raw` and not freed before.
        drop(unsafe { Box::from_raw(supervisor) });
    }
}

/// Answers one period of the whole arm; call it once per period, whether a new sample came or not. Real time.
/// Whatever the values, the torques are finite and within their limits, and what happened is in `report`.
/// The arrays of sample and command may overlap.
///
/// # Safety
///
/// Every pointer is null or valid for what the header says of it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn phihat_supervisor_step(
    supervisor: *mut phihat_supervisor,
    sample: *const phihat_sample,
    request: *const phihat_request,
    command: *const phihat_command,
    report: *mut phihat_report,
) -> Status {
    let call = || {
        // SAFETY: null or a living handle.
        let living = unsafe { supervisor.as_mut() };
        let why = "the supervisor's handle is null";
        let s = living.ok_or_else(|| RefusedCall::new(Status::NullPointer, why))?;
        // SAFETY: the caller's.
        let (sample, request, to) = unsafe {
            let request = element(request, 0, phihat_request::OLDER)?;
            (structure(sample)?, request, structure(command)?)
        };
        let mode = match request.mode {
            PHIHAT_REQUEST_IDLE => ModeRequest::Idle,
            PHIHAT_REQUEST_ARM => ModeRequest::Arm,
            PHIHAT_REQUEST_HOLD => ModeRequest::Hold,
            PHIHAT_REQUEST_TRACK => ModeRequest::Track,
            PHIHAT_REQUEST_STOP => ModeRequest::Stop,
            _ => return Err(RefusedCall::new(Status::BadOption, "mode is no PHIHAT_REQUEST_...")),
        };
        present([to.tau.cast_const()])?;
        joints_match(s.rules.len(), to.joints)?;
        if !report.is_null() {
            // SAFETY: not null, so it points to a structure that begins with its size.
            unsafe { structure(report.cast_const()) }?;
        }
        // SAFETY: the caller's.
        unsafe { copy_sample(sample, &mut s.measurements, &mut s.references) }?;
        for (from, to) in
            [(request.preset, &mut s.preset), (request.feed_forward, &mut s.feed_forward)]
        {
            for (i, torque) in to.iter_mut().enumerate() {
                if !from.is_null() {
                    // SAFETY: not null, and with one entry per joint.
                    *torque = unsafe { from.add(i).read() };
                }
            }
        }
        let stamp = Stamp { sequence: request.sequence, t_ns: request.t_ns };
        let told = supervise(
            Rules { arm: &s.arm, joints: &s.rules },
            Memories { arm: &mut s.state, joints: &mut s.memories },
            &Sample { stamp, now_ns: request.now_ns, joints: &s.measurements },
            &Request {
                mode,
                references: &s.references,
                preset: (!request.preset.is_null()).then_some(&s.preset),
                feed_forward: (!request.feed_forward.is_null()).then_some(&s.feed_forward),
            },
            &mut s.commands,
        );
        // SAFETY: not null where written to, and with one entry per joint.
        unsafe { give(&s.commands, to) };
        if !report.is_null() {
            // SAFETY: checked above.
            unsafe { write_structure(report, as_c(&told)) };
        }
        Ok(Status::Ok)
    };
    // SAFETY: no error is wanted.
    unsafe { answer(core::ptr::null_mut(), call) }
}

/// Name of an event, of which `bit` is the place, from 0; null where there is none.
#[unsafe(no_mangle)]
pub extern "C" fn phihat_event_text(bit: u32) -> *const core::ffi::c_char {
    const NAMES: [&core::ffi::CStr; 22] = [
        c"missed",
        c"duplicate",
        c"reordered",
        c"aged",
        c"time-jump",
        c"not-finite",
        c"implausible",
        c"reference-refused",
        c"saturated",
        c"rate-limited",
        c"range",
        c"shaped",
        c"funnel",
        c"funnel-left",
        c"raised",
        c"lowered",
        c"dead-zone",
        c"refused",
        c"funnel-over",
        c"held-back",
        c"torque-refused",
        c"let-go",
    ];
    // The names are the core's; a test compares.
    let known = Events::ALL.len().min(NAMES.len());
    let at = usize::try_from(bit).unwrap_or(usize::MAX);
    NAMES[..known].get(at).map_or(core::ptr::null(), |name| name.as_ptr())
}

fn as_c(told: &Report) -> phihat_report {
    phihat_report {
        size: size_of::<phihat_report>(),
        fault_joint: told.fault.map_or(usize::MAX, |(_, joint)| joint),
        fault: told.fault.map_or(core::ptr::null(), |(fault, _)| fault_text(fault).as_ptr()),
        refusal: told.refusal.map_or(core::ptr::null(), |why| denial_text(why).as_ptr()),
        mode: match told.mode {
            Mode::Idle => PHIHAT_MODE_IDLE,
            Mode::Armed => PHIHAT_MODE_ARMED,
            Mode::Holding => PHIHAT_MODE_HOLDING,
            Mode::Tracking => PHIHAT_MODE_TRACKING,
            Mode::SafeStop => PHIHAT_MODE_SAFE_STOP,
        },
        events: told.events.bits(),
        brake: u32::from(told.brake),
        misses: told.misses,
        lost: told.lost,
    }
}

fn fault_text(fault: Fault) -> &'static core::ffi::CStr {
    match fault {
        Fault::LinkLost => c"link-lost",
        Fault::LinkQuality => c"link-quality",
        Fault::BadSample => c"bad-sample",
        Fault::BadReference => c"bad-reference",
        Fault::Frozen => c"frozen-sensor",
        Fault::JointLimit => c"joint-limit",
        Fault::TrackingError => c"tracking-error",
        Fault::ErrorBound => c"error-bound",
        Fault::Overspeed => c"overspeed",
        Fault::Oscillation => c"oscillation",
        Fault::Actuation => c"actuation",
        Fault::Saturation => c"saturation",
        Fault::Clock => c"clock",
        Fault::NotFinite => c"not-finite",
        // None today: a test compares all names.
        _ => c"other",
    }
}

fn denial_text(why: Denial) -> &'static core::ffi::CStr {
    match why {
        Denial::NotArmed => c"not-armed",
        Denial::NotHolding => c"not-holding",
        Denial::NotStopped => c"not-stopped",
        Denial::AlreadyActive => c"already-active",
        Denial::Latched => c"latched",
        Denial::NotNew => c"not-new",
        Denial::Fault => c"fault",
        Denial::NotFresh => c"not-fresh",
        Denial::NotAtRest => c"not-at-rest",
        Denial::StartMismatch => c"start-mismatch",
        Denial::OutsideBox => c"outside-box",
        // None today.
        _ => c"other",
    }
}

fn refused(error: OptionError, joint: Option<usize>) -> RefusedCall {
    RefusedCall::option(joint, error)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_the_cores() {
        for (bit, (event, name)) in Events::ALL.iter().enumerate() {
            let text = phihat_event_text(u32::try_from(bit).unwrap());
            // SAFETY: not null, or the test fails; a text of this library.
            let text = unsafe { core::ffi::CStr::from_ptr(text) };
            assert_eq!(text.to_str().unwrap(), *name);
            assert_eq!(event.bits(), 1 << bit);
        }
        assert!(phihat_event_text(u32::try_from(Events::ALL.len()).unwrap()).is_null());
        for fault in Fault::ALL {
            assert_eq!(fault_text(fault).to_str().unwrap(), fault.name());
        }
        for why in [
            Denial::NotArmed,
            Denial::NotHolding,
            Denial::NotStopped,
            Denial::AlreadyActive,
            Denial::Latched,
            Denial::NotNew,
            Denial::Fault,
            Denial::NotFresh,
            Denial::NotAtRest,
            Denial::StartMismatch,
            Denial::OutsideBox,
        ] {
            assert_eq!(denial_text(why).to_str().unwrap(), why.name());
        }
    }
}
