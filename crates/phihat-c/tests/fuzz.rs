//! A careless C program: wrong sizes, null pointers, counts that are not the arm's, numbers that are none. Every call
//! answers with a status, a refused one writes no torque, and a torque stays inside its limits.
#![allow(unsafe_code, reason = "plays the part of a C program")]
#![allow(clippy::panic, reason = "tests: a panic is the report")]

mod support;

use core::ptr::{null, null_mut};

use phihat_c::{
    Status, phihat_command, phihat_controller, phihat_controller_create, phihat_controller_destroy,
    phihat_controller_joints, phihat_controller_reset, phihat_controller_resume,
    phihat_controller_update, phihat_error, phihat_joint, phihat_sample,
};
use support::TORQUE;

const N: usize = 3;
const VALUES: [f64; 16] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    1e305,
    -1e305,
    1e200,
    1e9,
    -1e9,
    0.0,
    -0.0,
    5e-324,
    1e-200,
    -1.0,
    1e-3,
    400.0,
];

struct Choices<'a>(&'a [u8]);

impl Choices<'_> {
    fn byte(&mut self) -> Option<usize> {
        let (first, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(usize::from(*first))
    }

    /// One time in sixteen the unlikely.
    fn seldom(&mut self) -> bool {
        self.byte().unwrap_or(0) % 16 == 15
    }

    fn number(&mut self) -> f64 {
        let byte = self.byte().unwrap_or(0);
        if byte % 8 == 7 { VALUES[byte / 8 % 16] } else { byte as f64 / 128.0 - 1.0 }
    }

    fn or<T>(&mut self, usual: T, unlikely: T) -> T {
        if self.seldom() { unlikely } else { usual }
    }
}

fn joint(choices: &mut Choices<'_>) -> phihat_joint {
    let mut joint = phihat_joint { torque_rate_max_nm_s: 1000.0, ..support::joint() };
    if choices.seldom() {
        match choices.byte().unwrap_or(0) % 8 {
            0 => joint.inertia_kg_m2 = choices.number(),
            1 => joint.kp_per_s2 = choices.number(),
            2 => joint.kd_per_s = choices.number(),
            3 => joint.a[choices.byte().unwrap_or(0) % 4] = choices.number(),
            4 => joint.order = u32::try_from(choices.byte().unwrap_or(0)).unwrap_or(0),
            5 => joint.form = u32::try_from(choices.byte().unwrap_or(0)).unwrap_or(0),
            6 => joint.torque_rate_max_nm_s = choices.number(),
            _ => joint.size = choices.byte().unwrap_or(0),
        }
    }
    joint
}

fn played(bytes: &[u8]) {
    let mut choices = Choices(bytes);
    let joints = [(); N].map(|()| joint(&mut choices));
    let mut error = phihat_error {
        size: choices.or(size_of::<phihat_error>(), 3),
        joint: 0,
        value: 0.0,
        member: [1; 32],
        text: [1; 192],
    };
    let period = if choices.seldom() { choices.number() } else { 1e-3 };
    let mut controller = null_mut();
    let list = choices.or(joints.as_ptr(), null());
    let count = choices.or(N, 0);
    let error_at = choices.or(&raw mut error, null_mut());
    // SAFETY: null, or to living values, as many as counted.
    let made =
        unsafe { phihat_controller_create(list, count, period, &raw mut controller, error_at) };
    assert_eq!(made == Status::Ok, !controller.is_null());
    while let Some(call) = choices.byte() {
        called(controller, call, &mut choices);
    }
    // SAFETY: null or a living handle, freed once.
    unsafe { phihat_controller_destroy(controller) };
}

/// One call on a living handle or a null one.
fn called(controller: *mut phihat_controller, call: usize, choices: &mut Choices<'_>) {
    let alive = !controller.is_null();
    let columns: [[f64; N]; 6] = [(); 6].map(|()| [(); N].map(|()| choices.number()));
    let column = |choices: &mut Choices<'_>, k: usize| choices.or(columns[k].as_ptr(), null());
    let sample = phihat_sample {
        size: choices.or(size_of::<phihat_sample>(), 8),
        joints: choices.or(N, N - 1),
        q: column(choices, 0),
        dq: column(choices, 1),
        tau_applied: column(choices, 2),
        q_des: column(choices, 3),
        dq_des: column(choices, 4),
        ddq_des: column(choices, 5),
    };
    let sample_at = choices.or(&raw const sample, null());
    // Not a torque that anything of ours would write.
    let mut tau = [-1234.5; N];
    let command = phihat_command {
        size: choices.or(size_of::<phihat_command>(), 0),
        joints: choices.or(N, N + 1),
        tau: tau.as_mut_ptr(),
        phi_hat: null_mut(),
        flags: null_mut(),
    };
    // SAFETY: a living handle or null; columns of `N` numbers or null; `tau` has as many.
    let status = unsafe {
        assert_eq!(phihat_controller_joints(controller), if alive { N } else { 0 });
        match call % 8 {
            0 => phihat_controller_reset(controller),
            1 => phihat_controller_resume(controller, sample_at, columns[2].as_ptr()),
            _ => phihat_controller_update(controller, sample_at, &raw const command),
        }
    };
    let written = tau.iter().any(|tau| tau.to_bits() != (-1234.5_f64).to_bits());
    match status {
        Status::Ok if call % 8 > 1 => {
            assert!(tau.iter().all(|tau| tau.is_finite() && tau.abs() <= TORQUE), "{tau:?}");
        }
        // A refused sample is answered with a torque that is safe to apply; a bad call with none.
        _ if written => {
            assert!(
                tau.iter().all(|tau| tau.is_finite() && tau.abs() <= TORQUE),
                "{status:?}: {tau:?}"
            );
        }
        _ => {}
    }
    assert!(alive || status != Status::Ok, "a null handle is used");
}

#[test]
fn no_call_panics_or_writes_what_is_no_torque() {
    phihat_fuzz::drawn(512, played).unwrap();
}
