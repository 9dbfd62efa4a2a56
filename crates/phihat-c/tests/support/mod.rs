//! What the tests' C programs have in common.

use phihat_c::phihat_joint;

/// Largest torque \[N·m\].
pub(crate) const TORQUE: f64 = 87.0;

/// A joint of order 2 with no limit on its torque's rate.
pub(crate) fn joint() -> phihat_joint {
    phihat_joint {
        size: size_of::<phihat_joint>(),
        inertia_kg_m2: 0.8,
        kp_per_s2: 400.0,
        kd_per_s: 40.0,
        a: [4900.0, 140.0, 0.0, 0.0],
        order: 2,
        form: 0,
        torque_max_nm: TORQUE,
        torque_rate_max_nm_s: f64::INFINITY,
    }
}
