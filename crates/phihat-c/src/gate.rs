//! The last thing before a torque leaves, behind its handle.

use phihat::{Command, Gate, Limits, Measurement, Outlet, Tank};

use crate::border::{answer, present, structure};
use crate::controller::{give, joints_match, room};
use crate::error::{RefusedCall, Status, phihat_error};
use crate::types::phihat_command;

/// A gate for an arm's torques, and room for one sample.
#[derive(Debug)]
pub struct phihat_gate {
    gate: Gate<f64, Vec<Outlet<f64>>>,
    measurements: Vec<Measurement<f64>>,
    commands: Vec<Command<f64>>,
    held: Vec<f64>,
}

/// Limits of a phihat_gate.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct phihat_gate_limits {
    /// sizeof(phihat_gate_limits).
    pub size: usize,
    /// Number of joints, at least 1.
    pub joints: usize,
    /// Largest |tau|, positive, one per joint [N m]; INFINITY: no limit.
    pub torque_max_nm: *const f64,
    /// Largest change of tau per time, positive, one per joint [N m/s]; INFINITY: no limit.
    pub torque_rate_max_nm_s: *const f64,
    /// The most energy that all drives together may give the arm within energy_window_s, positive [J];
    /// INFINITY: no limit.
    pub energy_max_j: f64,
    /// The time that energy_max_j is counted in, positive [s]; not looked at without one.
    pub energy_window_s: f64,
    /// Time between samples, positive [s].
    pub period_s: f64,
}

/// Makes a gate, behind drives that give no torque yet. Allocates; not for the control loop.
///
/// A gate is the last thing before a torque leaves: behind gravity compensation, feed-forward and all else
/// that computes on it.
///
/// @param limits Limits of the gate.
/// @param gate   Receives the handle; free it with phihat_gate_destroy().
/// @param error  Receives what was wrong; set its size first. May be null.
///
/// # Safety
///
/// Every pointer is null or valid for what the header says of it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn phihat_gate_create(
    limits: *const phihat_gate_limits,
    gate: *mut *mut phihat_gate,
    error: *mut phihat_error,
) -> Status {
    let call = || {
        if gate.is_null() {
            return Err(RefusedCall::new(Status::NullPointer, "the handle's pointer is null"));
        }
        // SAFETY: the caller's.
        let of = unsafe { structure(limits) }?;
        if of.joints == 0 {
            return Err(RefusedCall::new(Status::WrongJoints, "a gate has at least one joint"));
        }
        present([of.torque_max_nm, of.torque_rate_max_nm_s])?;
        let finite = |x: f64| (!(x.is_infinite() && x > 0.0)).then_some(x);
        let mut outlets = room(of.joints)?;
        for i in 0..of.joints {
            // SAFETY: not null, and with one entry per joint.
            let (torque, rate) =
                unsafe { (of.torque_max_nm.add(i).read(), of.torque_rate_max_nm_s.add(i).read()) };
            let limits = Limits::new(finite(torque), finite(rate), of.period_s);
            outlets.push(Outlet::new(limits.map_err(|why| RefusedCall::gain(why).at(i))?));
        }
        let tank =
            finite(of.energy_max_j).map(|most| Tank::new(most, of.energy_window_s, of.period_s));
        let tank = tank.transpose().map_err(RefusedCall::gain)?;
        let mut made = phihat_gate {
            gate: Gate::new(outlets, tank),
            measurements: room(of.joints)?,
            commands: room(of.joints)?,
            held: room(of.joints)?,
        };
        made.measurements.resize(of.joints, Measurement::default());
        made.commands.resize(of.joints, Command::default());
        made.held.resize(of.joints, 0.0);
        // SAFETY: not null, so it can be written to.
        unsafe { gate.write(Box::into_raw(Box::new(made))) };
        Ok(Status::Ok)
    };
    // SAFETY: the caller's.
    unsafe { answer(error, call) }
}

/// Frees a gate; null is allowed. The handle is gone afterwards.
///
/// # Safety
///
/// `gate` is null or came from phihat_gate_create() and was not freed before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn phihat_gate_destroy(gate: *mut phihat_gate) {
    if !gate.is_null() {
        // SAFETY: made by `Box::into_raw` and not freed before.
        drop(unsafe { Box::from_raw(gate) });
    }
}

/// From here on the rate counts from `tau`, the torques with which something else holds the arm, one per
/// joint [N m]. A value that is not finite changes nothing.
///
/// # Safety
///
/// Every pointer is null or valid for what the header says of it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn phihat_gate_hold(gate: *mut phihat_gate, tau: *const f64) -> Status {
    let call = || {
        // SAFETY: the caller's.
        let g = unsafe { handle(gate) }?;
        present([tau])?;
        for (i, held) in g.held.iter_mut().enumerate() {
            // SAFETY: not null, and with one entry per joint.
            *held = unsafe { tau.add(i).read() };
        }
        g.gate.holding(&g.held);
        Ok(Status::Ok)
    };
    // SAFETY: no error is wanted.
    unsafe { answer(core::ptr::null_mut(), call) }
}

/// Lets the torques of a sample out; call it once per period, and send what it leaves in `command`, whatever
/// it answers. Real time.
///
/// `command->tau` holds the requested torques, and then those that may be sent: finite, within range and
/// rate, and, where an energy is limited, scaled down along the motion. A torque that is not finite becomes
/// the last one, and its joint has the flag PHIHAT_REFUSED.
///
/// @param gate    The handle.
/// @param q       Measured position, one per joint [rad]; what is not finite counts as the last one.
/// @param command Torques in and out; phi_hat is not looked at, flags may be null.
///
/// # Safety
///
/// Every pointer is null or valid for what the header says of it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn phihat_gate_release(
    gate: *mut phihat_gate,
    q: *const f64,
    command: *const phihat_command,
) -> Status {
    let call = || {
        // SAFETY: the caller's.
        let (g, to) = unsafe { (handle(gate)?, structure(command)?) };
        present([q, to.tau.cast_const()])?;
        joints_match(g.commands.len(), to.joints)?;
        for (i, (m, c)) in g.measurements.iter_mut().zip(&mut g.commands).enumerate() {
            // SAFETY: not null, and with one entry per joint.
            (m.q, *c) = unsafe {
                (q.add(i).read(), Command { tau: to.tau.add(i).read(), ..Command::default() })
            };
        }
        g.gate.release(&g.measurements, &mut g.commands);
        let to = phihat_command { phi_hat: core::ptr::null_mut(), ..*to };
        // SAFETY: not null where written to, and with one entry per joint.
        unsafe { give(&g.commands, &to) };
        let refused = g.commands.iter().any(|answer| answer.status.refused);
        Ok(if refused { Status::Refused } else { Status::Ok })
    };
    // SAFETY: no error is wanted.
    unsafe { answer(core::ptr::null_mut(), call) }
}

/// The gate behind a handle.
///
/// # Safety
///
/// Null, or a living handle that no other thread uses.
unsafe fn handle<'a>(gate: *mut phihat_gate) -> Result<&'a mut phihat_gate, RefusedCall> {
    // SAFETY: the caller's.
    let living = unsafe { gate.as_mut() };
    living.ok_or_else(|| RefusedCall::new(Status::NullPointer, "the gate's handle is null"))
}
