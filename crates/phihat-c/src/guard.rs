//! Options of a supervised arm, as C states them.

use core::mem::offset_of;

use phihat::{JointOptions, JointRange, MotionLimits, Options};

use crate::border::write_structure;
use crate::error::{RefusedCall, Status};

/// Limits and monitors of one joint; phihat_guard_default() fills it with "nothing is judged".
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct phihat_guard {
    /// sizeof(phihat_guard).
    pub size: usize,
    /// Largest speed [rad/s]: a joint that is faster is stopped, and a jump to a higher speed, or a step in
    /// position beyond it, is refused. INFINITY: not judged.
    pub velocity_max_rad_s: f64,
    /// Hard limits of the position [rad], beyond which the arm stops; -INFINITY and INFINITY: none.
    pub position_min_rad: f64,
    /// See position_min_rad; both or neither.
    pub position_max_rad: f64,
    /// Width of the soft zone inside of each hard limit [rad]; used where there are limits.
    pub position_soft_rad: f64,
    /// Deceleration that the joint can always afford near a limit [rad/s^2]; used where there are limits.
    pub braking_rad_s2: f64,
    /// Largest |e| while the law runs [rad]; beyond it the arm stops. INFINITY: not judged.
    pub error_stop_rad: f64,
    /// A position that stands still while the joint should have moved this far is frozen [rad]. INFINITY:
    /// not judged.
    pub frozen_travel_rad: f64,
    /// Limits that every reference is shaped to [rad/s, rad/s^2, rad/s^3]; all INFINITY: it is taken as it
    /// is.
    pub reference_velocity_max_rad_s: f64,
    /// See reference_velocity_max_rad_s.
    pub reference_acceleration_max_rad_s2: f64,
    /// See reference_velocity_max_rad_s.
    pub reference_jerk_max_rad_s3: f64,
    /// Inside this |e|, with the reference at rest, the estimate is held [rad]; 0: never.
    pub dead_zone_rad: f64,
    /// Root mean square of the torque's second difference that counts as oscillation [N m]. INFINITY: not
    /// judged.
    pub oscillation_nm: f64,
    /// Torque variation that is enough to judge, at first motion, whether the joint goes the way the torque
    /// pushes [N m, root mean square]. INFINITY: not judged.
    pub first_motion_nm: f64,
    /// Certified bound on the measured |e| in holding and tracking [rad]: the bound on |e|, and half a quantum of the
    /// encoder. An error beyond it in three samples in a row stops the arm. INFINITY, or 0: not compared.
    pub error_bound_rad: f64,
    /// Ends of the box that every reference is kept in [rad], with the three limits of the reference; equal, or
    /// infinite: none. An arm that is not inside is not engaged.
    pub reference_min_rad: f64,
    /// See reference_min_rad.
    pub reference_max_rad: f64,
}

impl phihat_guard {
    /// sizeof(phihat_guard) of headers that had no member from `error_bound_rad` on.
    pub(crate) const OLDER: &[usize] = &[offset_of!(Self, error_bound_rad)];
}

/// Options of a supervised arm; phihat_supervision_default() fills it.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct phihat_supervision {
    /// sizeof(phihat_supervision).
    pub size: usize,
    /// Time between samples [ns].
    pub period_ns: u64,
    /// Oldest usable sample [ns].
    pub age_max_ns: u64,
    /// Largest advance of the sequence number.
    pub sequence_window: u64,
    /// Samples missed in a row for which the last torque is held; then it fades to phi_hat.
    pub hold_samples: u32,
    /// Samples missed in a row that stop the arm.
    pub stop_samples: u32,
    /// Unbelievable samples in a row that stop the arm.
    pub bad_samples: u32,
    /// Samples missed of the last 64 that stop the arm.
    pub lost_max: u32,
    /// Largest speed that counts as rest [rad/s].
    pub rest_velocity_rad_s: f64,
    /// Largest distance between pose and reference at which tracking starts [rad].
    pub start_mismatch_max_rad: f64,
    /// Blend time of a change of reference [s].
    pub blend_s: f64,
    /// Damping while armed and in a stop, as a share of K_d, 0 to 1.
    pub stop_damping: f64,
    /// Time in a stop after which the brakes are requested even if the arm still moves [s].
    pub stop_s: f64,
    /// Longest time of a torque at its limit without a break before the arm is stopped [s]; INFINITY, or 0:
    /// no bound.
    pub saturation_s: f64,
    /// Time from the request for the brakes until they hold the arm [s]; the law gives way then. INFINITY, or
    /// 0: there are no brakes, and the law holds a stopped arm for as long as it is measured.
    pub brake_closing_s: f64,
}

impl phihat_supervision {
    /// sizeof(phihat_supervision) of headers that had no member from `saturation_s` on.
    pub(crate) const OLDER: &[usize] = &[offset_of!(Self, saturation_s)];
}

/// Fills a phihat_guard with "nothing is judged"; set its size first.
///
/// # Safety
///
/// `guard` is null or points to a phihat_guard whose size is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn phihat_guard_default(guard: *mut phihat_guard) -> Status {
    let none = f64::INFINITY;
    let filled = phihat_guard {
        size: size_of::<phihat_guard>(),
        velocity_max_rad_s: none,
        position_min_rad: -none,
        position_max_rad: none,
        position_soft_rad: 0.05,
        braking_rad_s2: 5.0,
        error_stop_rad: none,
        frozen_travel_rad: none,
        reference_velocity_max_rad_s: none,
        reference_acceleration_max_rad_s2: none,
        reference_jerk_max_rad_s3: none,
        dead_zone_rad: 0.0,
        oscillation_nm: none,
        first_motion_nm: none,
        error_bound_rad: none,
        reference_min_rad: -none,
        reference_max_rad: none,
    };
    // SAFETY: the caller's.
    unsafe { write_structure(guard, filled) }
}

/// Fills a phihat_supervision with the defaults at a period [ns]; set its size first.
///
/// # Safety
///
/// `supervision` is null or points to a phihat_supervision whose size is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn phihat_supervision_default(
    period_ns: u64,
    supervision: *mut phihat_supervision,
) -> Status {
    let o = Options::new(period_ns);
    let filled = phihat_supervision {
        size: size_of::<phihat_supervision>(),
        period_ns,
        age_max_ns: o.age_max_ns,
        sequence_window: o.sequence_window,
        hold_samples: o.hold_samples,
        stop_samples: o.stop_samples,
        bad_samples: o.bad_samples,
        lost_max: o.lost_max,
        rest_velocity_rad_s: o.rest_velocity,
        start_mismatch_max_rad: o.start_mismatch_max,
        blend_s: o.blend_s,
        stop_damping: o.stop_damping,
        stop_s: o.stop_s,
        saturation_s: o.saturation_s.unwrap_or(f64::INFINITY),
        brake_closing_s: o.brake_s.unwrap_or(f64::INFINITY),
    };
    // SAFETY: the caller's.
    unsafe { write_structure(supervision, filled) }
}

impl phihat_supervision {
    pub(crate) fn options(&self) -> Options {
        Options {
            age_max_ns: self.age_max_ns,
            sequence_window: self.sequence_window,
            hold_samples: self.hold_samples,
            stop_samples: self.stop_samples,
            bad_samples: self.bad_samples,
            lost_max: self.lost_max,
            rest_velocity: self.rest_velocity_rad_s,
            start_mismatch_max: self.start_mismatch_max_rad,
            blend_s: self.blend_s,
            stop_damping: self.stop_damping,
            stop_s: self.stop_s,
            saturation_s: stated(self.saturation_s),
            brake_s: stated(self.brake_closing_s),
            ..Options::new(self.period_ns)
        }
    }
}

impl phihat_guard {
    pub(crate) fn options(&self) -> Result<JointOptions<f64>, RefusedCall> {
        let finite = |x: f64| (!is_none(x)).then_some(x);
        let range = match (is_none(-self.position_min_rad), is_none(self.position_max_rad)) {
            (true, true) => None,
            (false, false) => Some(JointRange {
                lower: self.position_min_rad,
                upper: self.position_max_rad,
                soft: self.position_soft_rad,
                braking: self.braking_rad_s2,
            }),
            _ => {
                let why = "position_min_rad and position_max_rad: one is infinite, the other not";
                return Err(RefusedCall::new(Status::BadOption, why));
            }
        };
        let [velocity, acceleration, jerk] = [
            self.reference_velocity_max_rad_s,
            self.reference_acceleration_max_rad_s2,
            self.reference_jerk_max_rad_s3,
        ];
        let (low, high) = (self.reference_min_rad, self.reference_max_rad);
        let boxed = low.to_bits() != high.to_bits() && !(is_none(-low) && is_none(high));
        let unlimited = [velocity, acceleration, jerk].into_iter().all(is_none);
        Ok(JointOptions {
            velocity_max: finite(self.velocity_max_rad_s),
            range,
            error_stop: finite(self.error_stop_rad),
            frozen_travel: finite(self.frozen_travel_rad),
            motion: (!unlimited).then_some(MotionLimits { velocity, acceleration, jerk }),
            dead_zone: (self.dead_zone_rad.to_bits() != 0).then_some(self.dead_zone_rad),
            oscillation: finite(self.oscillation_nm),
            first_motion: finite(self.first_motion_nm),
            error_bound: stated(self.error_bound_rad),
            reference_box: boxed.then_some((self.reference_min_rad, self.reference_max_rad)),
            ..JointOptions::default()
        })
    }
}

/// A time, where it is one.
fn stated(seconds: f64) -> Option<f64> {
    (!is_none(seconds) && seconds.to_bits() != 0).then_some(seconds)
}

/// Returns true if a value states "no limit".
fn is_none(x: f64) -> bool {
    x.is_infinite() && x > 0.0
}
