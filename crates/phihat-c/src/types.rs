//! The structures of the header.

/// Highest order of the estimator.
pub const PHIHAT_ORDER_MAX: usize = 4;

/// Form of the law: a disturbance observer fed with the torque that acted. The default.
pub const PHIHAT_FORM_OBSERVER: u32 = 0;
/// Form of the law: the paper's integrals of the error, for reproduction; winds up under saturation.
pub const PHIHAT_FORM_LITERAL: u32 = 1;

/// Flag of a command: the torque limit acted.
pub const PHIHAT_SATURATED: u32 = 1;
/// Flag of a command: the torque-rate limit acted.
pub const PHIHAT_RATE_LIMITED: u32 = 2;
/// Flag of a command: the sample was not finite or beyond +-2^32; the last torque is held, the state untouched.
pub const PHIHAT_REFUSED: u32 = 4;

/// Gains and limits of one joint.
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
    /// Estimator coefficients a_0 ... a_(order-1), positive; a_i in [1/s^(order-i)].
    pub a: [f64; PHIHAT_ORDER_MAX],
    /// Order of the estimator, 1 ... PHIHAT_ORDER_MAX.
    pub order: u32,
    /// PHIHAT_FORM_OBSERVER or PHIHAT_FORM_LITERAL.
    pub form: u32,
    /// Largest |tau|, positive [N m]; INFINITY: no limit.
    pub torque_max_nm: f64,
    /// Largest change of tau, positive [N m/s]; INFINITY: no limit.
    pub torque_rate_max_nm_s: f64,
}

/// What the sensors say at a sample, and what the arm shall do.
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
    /// Desired acceleration [rad/s^2].
    pub ddq_des: *const f64,
}

/// Where the answer goes.
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
