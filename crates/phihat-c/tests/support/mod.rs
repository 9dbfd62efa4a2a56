//! Common parts of the tests' C programs.
#![allow(dead_code, reason = "each test file uses its part")]
#![allow(unsafe_code, reason = "plays the part of a C program")]

use core::ptr::null_mut;

use phihat_c::{
    PHIHAT_CORRECTION_MAX, PHIHAT_FORM_POSITIONS, PHIHAT_SECTIONS_MAX, Status, phihat_command,
    phihat_joint, phihat_sample, phihat_supervision, phihat_supervision_default,
};

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
        correction: [0.0; PHIHAT_CORRECTION_MAX],
        velocity_correction: [0.0; PHIHAT_CORRECTION_MAX],
        share: 0.0,
        delay_samples: 0,
        sections: 0,
        section_rates: [[0.0; 2]; PHIHAT_SECTIONS_MAX],
        section_weights_per_s2: [[0.0; 2]; PHIHAT_SECTIONS_MAX],
        torque_filter_hz: 0.0,
    }
}

/// The same with a law from positions, at 1 ms: observer poles at 0.9, one sample of delay.
pub(crate) fn seeing() -> phihat_joint {
    phihat_joint {
        a: [0.0; 4],
        order: 1,
        form: PHIHAT_FORM_POSITIONS,
        correction: [0.271, 28.5, -1000.0, 0.0, 0.0],
        share: 0.5,
        delay_samples: 1,
        ..joint()
    }
}

/// The same with two sections on the innovation, no two numbers alike.
pub(crate) fn filtered() -> phihat_joint {
    phihat_joint {
        sections: 2,
        section_rates: [[0.02, 0.3], [0.5, 1.2]],
        section_weights_per_s2: [[800.0, -300.0], [2500.0, 90.0]],
        ..seeing()
    }
}

/// The default supervision at 1 ms.
pub(crate) fn supervision() -> phihat_supervision {
    // SAFETY: numbers only, and zero is one.
    let mut options: phihat_supervision = unsafe { core::mem::zeroed() };
    options.size = size_of::<phihat_supervision>();
    // SAFETY: to a living value whose size is set.
    let status = unsafe { phihat_supervision_default(1_000_000, &raw mut options) };
    assert_eq!(status, Status::Ok);
    options
}

/// A sample: `q, dq, tau_applied, q_des, dq_des, ddq_des`, an entry per joint each.
pub(crate) fn sample(joints: usize, of: [*const f64; 6]) -> phihat_sample {
    let [q, dq, tau_applied, q_des, dq_des, ddq_des] = of;
    let size = size_of::<phihat_sample>();
    phihat_sample { size, joints, q, dq, tau_applied, q_des, dq_des, ddq_des }
}

/// A command with an array for torques only.
pub(crate) fn command(tau: &mut [f64]) -> phihat_command {
    phihat_command {
        size: size_of::<phihat_command>(),
        joints: tau.len(),
        tau: tau.as_mut_ptr(),
        phi_hat: null_mut(),
        flags: null_mut(),
    }
}
