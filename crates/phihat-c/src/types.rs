//! The structures of the header.

use core::mem::offset_of;

/// Highest order of the estimator.
pub const PHIHAT_ORDER_MAX: usize = 4;
/// Most entries of a correction: of order 3, two more than that.
pub const PHIHAT_CORRECTION_MAX: usize = 5;
/// Longest delay that PHIHAT_FORM_POSITIONS predicts across [samples].
pub const PHIHAT_DELAY_MAX: u32 = 4;
/// Most sections of an innovation filter.
pub const PHIHAT_SECTIONS_MAX: usize = 2;

/// Form of the law: a disturbance observer fed with the torque that acted. The default.
pub const PHIHAT_FORM_OBSERVER: u32 = 0;
/// Form of the law: the paper's integrals of the error, for reproduction; winds up under saturation.
pub const PHIHAT_FORM_LITERAL: u32 = 1;
/// Form of the law: an observer from the position and the torque that acted. See phihat_joint.
pub const PHIHAT_FORM_POSITIONS: u32 = 2;

/// Flag of a command: the torque limit acted.
pub const PHIHAT_SATURATED: u32 = 1;
/// Flag of a command: the torque-rate limit acted.
pub const PHIHAT_RATE_LIMITED: u32 = 2;
/// Flag of a command: the sample was not finite or beyond +-2^32; the last torque is held, the state untouched.
pub const PHIHAT_REFUSED: u32 = 4;

/// Gains and limits of one joint. What a form does not use is not looked at.
///
/// PHIHAT_FORM_OBSERVER and PHIHAT_FORM_LITERAL use `a`. PHIHAT_FORM_POSITIONS uses the members from
/// `correction` on instead, l = correction, v = velocity_correction, g = share, d = delay_samples, and of
/// each section c = section_rates, b = section_weights_per_s2; at sample k:
///
///   z     = estimates of e, de, phi, ... at the last sample, carried on by the torque that acted less its ff
///   nu    = q - q_des - z_e
///   z    += l nu                                   (and v (dq - dq_des - z_de), where v is not zero)
///   x, y  = x + y, y + nu - c_0 x - c_1 y          of each section, from 0, 0 at the first sample
///   z+    = z carried on through the d torques that are on their way, and phi by T (1/g - 1) more
///   ff    = M ddq_des
///   r     = the last torque, as the limits let it through, less its ff
///   want  = phi+ - M (K_d de+ + K_p e+) + M (sum of b_0 x + b_1 y over the sections)
///   tau   = ff + r + g (want - r)
///
/// tau acts from sample k + d to k + d + 1. Its feed-forward ff enters with the reference, so that ddq_des of
/// phihat_sample is the mean of that interval.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct phihat_joint {
    /// sizeof(phihat_joint).
    pub size: usize,
    /// Nominal inertia M, positive [kg m^2].
    pub inertia_kg_m2: f64,
    /// Outer loop K_p, positive [1/s^2].
    pub kp_per_s2: f64,
    /// Outer loop K_d, positive [1/s].
    pub kd_per_s: f64,
    /// Estimator coefficients a_0 ... a_(order-1), positive; a_i in [1/s^(order-i)]. Not of PHIHAT_FORM_POSITIONS.
    pub a: [f64; PHIHAT_ORDER_MAX],
    /// Order of the estimator, 1 ... PHIHAT_ORDER_MAX; of PHIHAT_FORM_POSITIONS 1 ... 3.
    pub order: u32,
    /// PHIHAT_FORM_OBSERVER, PHIHAT_FORM_LITERAL or PHIHAT_FORM_POSITIONS.
    pub form: u32,
    /// Largest |tau|, positive [N m]; INFINITY: no limit.
    pub torque_max_nm: f64,
    /// Largest change of tau, positive [N m/s]; INFINITY: no limit.
    pub torque_rate_max_nm_s: f64,
    /// Corrections of the estimates of e [1], of de [1/s], of phi/M [1/s^2] and of its derivatives per radian
    /// that the joint is farther than expected: entry i in [1/s^i], order + 2 entries. From the third on they
    /// are negative.
    pub correction: [f64; PHIHAT_CORRECTION_MAX],
    /// The same per rad/s of the measured velocity, entry i in [1/s^(i-1)]; all zero: this law uses a velocity only
    /// where it starts or takes over. A number has to be there always, and phihat_supervisor judges it.
    pub velocity_correction: [f64; PHIHAT_CORRECTION_MAX],
    /// Share of the way to the wanted torque that is gone in one sample, above 0, at most 1 [1].
    pub share: f64,
    /// Transport delay from a sample to its torque, 0 ... PHIHAT_DELAY_MAX [samples].
    // 64 bits leave no gap at the end: whatever a later header adds makes the structure larger.
    pub delay_samples: u64,
    /// Sections of the filter on the innovation nu, 0 ... PHIHAT_SECTIONS_MAX; 0: no filter.
    pub sections: u64,
    /// c_0, c_1 of each section, per sample [1]: its poles are z = 1 + w with w^2 + c_1 w + c_0 = 0, inside of the
    /// circle where 0 < c_0 < c_1 and 2 c_1 < 4 + c_0.
    pub section_rates: [[f64; 2]; PHIHAT_SECTIONS_MAX],
    /// b_0, b_1 of each section: weights of its x and its y in the wanted torque, per M [1/s^2].
    pub section_weights_per_s2: [[f64; 2]; PHIHAT_SECTIONS_MAX],
    /// Cut-off f of a first-order low-pass on tau before the limits, of every form [Hz]; 0: none. With
    /// s = 1 - exp(-2 pi f T), tau = r + s (tau - r), r the last torque as the limits let it through.
    pub torque_filter_hz: f64,
}

impl phihat_joint {
    /// sizeof(phihat_joint) of older headers: of the first, which had no member from `correction` on, of the one that
    /// had none from `sections` on, and of the one without `torque_filter_hz`.
    pub(crate) const OLDER: &[usize] = &[
        offset_of!(Self, correction),
        offset_of!(Self, sections),
        offset_of!(Self, torque_filter_hz),
    ];
}

/// Measurements and references of all joints at a sample.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct phihat_sample {
    /// sizeof(phihat_sample).
    pub size: usize,
    /// Number of entries in each array: that of the controller's joints.
    pub joints: usize,
    /// Measured position [rad].
    pub q: *const f64,
    /// Measured velocity [rad/s].
    pub dq: *const f64,
    /// Torque that acted (mean) since the previous sample [N m]: after limits, delay and drive. Where it
    /// is not measured: the torque that was commanded for that time.
    pub tau_applied: *const f64,
    /// Desired position [rad].
    pub q_des: *const f64,
    /// Desired velocity [rad/s].
    pub dq_des: *const f64,
    /// Desired acceleration [rad/s^2]. Of joints with PHIHAT_FORM_POSITIONS: its mean over the interval in which
    /// the torque of this sample acts, from delay_samples periods after this sample to one period later. That is the
    /// desired velocity at its end less that at its begin, over the period; q_des and dq_des are those of now.
    pub ddq_des: *const f64,
}

/// Arrays for the commands of all joints.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct phihat_command {
    /// sizeof(phihat_command).
    pub size: usize,
    /// Number of entries in each array: that of the controller's joints.
    pub joints: usize,
    /// Torque to apply until the next sample [N m]: always finite and within the limits.
    pub tau: *mut f64,
    /// Estimate of the unknown dynamics [N m], contained in tau; may be null.
    pub phi_hat: *mut f64,
    /// PHIHAT_SATURATED, PHIHAT_RATE_LIMITED, PHIHAT_REFUSED; may be null.
    pub flags: *mut u32,
}
