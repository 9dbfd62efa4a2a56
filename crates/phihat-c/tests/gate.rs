//! The gate of the header. Wrong if it lets out what the core's would not, or if a pointer or a number that
//! is none gets by.
#![allow(unsafe_code, reason = "plays the part of a C program")]

use core::ptr::{null, null_mut};

use phihat_c::{
    PHIHAT_RATE_LIMITED, PHIHAT_REFUSED, Status, phihat_command, phihat_error, phihat_gate_create,
    phihat_gate_destroy, phihat_gate_hold, phihat_gate_limits, phihat_gate_release,
};

const N: usize = 2;
const TORQUE: [f64; N] = [87.0, 12.0];
const RATE: [f64; N] = [1000.0, f64::INFINITY];

fn limits() -> phihat_gate_limits {
    phihat_gate_limits {
        size: size_of::<phihat_gate_limits>(),
        joints: N,
        torque_max_nm: TORQUE.as_ptr(),
        torque_rate_max_nm_s: RATE.as_ptr(),
        energy_max_j: f64::INFINITY,
        energy_window_s: 0.0,
        period_s: 1e-3,
    }
}

#[test]
fn what_leaves_is_within_the_limits() {
    let mut handle = null_mut();
    let limits = limits();
    // SAFETY: all pointers are to living values.
    let made = unsafe { phihat_gate_create(&raw const limits, &raw mut handle, null_mut()) };
    assert_eq!(made, Status::Ok);
    let (mut tau, mut flags) = ([50.0, f64::NAN], [0_u32; N]);
    let command = phihat_command {
        size: size_of::<phihat_command>(),
        joints: N,
        tau: tau.as_mut_ptr(),
        phi_hat: null_mut(),
        flags: flags.as_mut_ptr(),
    };
    // SAFETY: all pointers are to living values with N entries; the handle is freed at the end.
    unsafe {
        assert_eq!(phihat_gate_hold(handle, [10.0, 3.0].as_ptr()), Status::Ok);
        let status = phihat_gate_release(handle, [0.0; N].as_ptr(), &raw const command);
        assert_eq!(status, Status::Refused);
        assert_eq!(tau.as_ptr().read().to_bits(), 11.0_f64.to_bits());
        assert_eq!(tau.as_ptr().add(1).read().to_bits(), 3.0_f64.to_bits());
        assert_eq!(
            (flags.as_ptr().read(), flags.as_ptr().add(1).read()),
            (PHIHAT_RATE_LIMITED, PHIHAT_REFUSED)
        );
        assert_eq!(phihat_gate_release(handle, null(), &raw const command), Status::NullPointer);
        assert_eq!(phihat_gate_hold(null_mut(), tau.as_ptr()), Status::NullPointer);
        let other = phihat_command { joints: 3, ..command };
        assert_eq!(
            phihat_gate_release(handle, [0.0; 3].as_ptr(), &raw const other),
            Status::WrongJoints
        );
        phihat_gate_destroy(handle);
        phihat_gate_destroy(null_mut());
    }
}

#[test]
fn what_is_no_gate_is_refused_by_name() {
    let good = limits();
    let none = [-1.0, 1.0];
    let bad: [(phihat_gate_limits, Status, &str); 6] = [
        (phihat_gate_limits { size: 8, ..good }, Status::WrongSize, ""),
        (phihat_gate_limits { joints: 0, ..good }, Status::WrongJoints, ""),
        (phihat_gate_limits { torque_max_nm: null(), ..good }, Status::NullPointer, ""),
        (
            phihat_gate_limits { torque_max_nm: none.as_ptr(), ..good },
            Status::BadGain,
            "torque_max_nm",
        ),
        (phihat_gate_limits { energy_max_j: f64::NAN, ..good }, Status::BadGain, "energy_max_j"),
        (phihat_gate_limits { energy_max_j: 5.0, ..good }, Status::BadGain, "energy_window_s"),
    ];
    for (limits, wanted, member) in bad {
        let mut handle = null_mut();
        let mut error = phihat_error {
            size: size_of::<phihat_error>(),
            joint: 0,
            value: 0.0,
            member: [0; 32],
            text: [0; 192],
        };
        // SAFETY: all pointers are to living values.
        let status =
            unsafe { phihat_gate_create(&raw const limits, &raw mut handle, &raw mut error) };
        assert_eq!(status, wanted, "{member}");
        assert!(handle.is_null());
        let said: String = error
            .member
            .iter()
            .take_while(|c| **c != 0)
            .map(|c| char::from(c.to_ne_bytes()[0]))
            .collect();
        assert!(said.contains(member), "{said}, not {member}");
    }
}
