//! A careless C program: wrong sizes, null pointers, counts that are not the arm's, numbers that are none. Every call
//! answers with a status, a refused one writes no torque, and a torque stays inside its limits.
#![allow(unsafe_code, reason = "plays the part of a C program")]

use core::ptr::{null, null_mut};

use crate::support::TORQUE;
use phihat_c::{
    Status, phihat_command, phihat_controller, phihat_controller_create, phihat_controller_destroy,
    phihat_controller_joints, phihat_controller_reset, phihat_controller_resume,
    phihat_controller_update, phihat_error, phihat_joint, phihat_sample,
};
use phihat_fuzz::{Choices, drawn};

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

/// One time in sixteen the unlikely.
fn seldom(choices: &mut Choices<'_>) -> bool {
    choices.byte_or_0() % 16 == 15
}

fn number(choices: &mut Choices<'_>) -> f64 {
    let byte = choices.byte_or_0();
    if byte % 8 == 7 { VALUES[byte / 8 % 16] } else { byte as f64 / 128.0 - 1.0 }
}

fn or<T>(choices: &mut Choices<'_>, usual: T, unlikely: T) -> T {
    if seldom(choices) { unlikely } else { usual }
}

fn joint(choices: &mut Choices<'_>) -> phihat_joint {
    let forms = [crate::support::joint(), crate::support::seeing(), crate::support::filtered()];
    let usual = forms[choices.byte_or_0() % 3];
    let mut joint = phihat_joint { torque_rate_max_nm_s: 1000.0, ..usual };
    if seldom(choices) {
        match choices.byte_or_0() % 15 {
            0 => joint.inertia_kg_m2 = number(choices),
            1 => joint.kp_per_s2 = number(choices),
            2 => joint.kd_per_s = number(choices),
            3 => joint.a[choices.byte_or_0() % 4] = number(choices),
            4 => joint.order = u32::try_from(choices.byte_or_0()).unwrap_or(0),
            5 => joint.form = u32::try_from(choices.byte_or_0()).unwrap_or(0),
            6 => joint.torque_rate_max_nm_s = number(choices),
            7 => joint.correction[choices.byte_or_0() % 5] = number(choices),
            8 => joint.velocity_correction[choices.byte_or_0() % 5] = number(choices),
            9 => joint.share = number(choices),
            10 => joint.delay_samples = choices.byte_or_0() as u64,
            11 => joint.sections = choices.byte_or_0() as u64,
            12 => joint.section_rates[choices.byte_or_0() % 2][0] = number(choices),
            13 => joint.section_weights_per_s2[choices.byte_or_0() % 2][1] = number(choices),
            _ => joint.size = choices.byte_or_0(),
        }
    }
    joint
}

fn played(bytes: &[u8]) {
    let mut choices = Choices::of(bytes);
    let joints = [(); N].map(|()| joint(&mut choices));
    let mut error = phihat_error {
        size: or(&mut choices, size_of::<phihat_error>(), 3),
        joint: 0,
        value: 0.0,
        member: [1; 32],
        text: [1; 192],
    };
    let period = if seldom(&mut choices) { number(&mut choices) } else { 1e-3 };
    let mut controller = null_mut();
    let list = or(&mut choices, joints.as_ptr(), null());
    let count = or(&mut choices, N, 0);
    let error_at = or(&mut choices, &raw mut error, null_mut());
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
    let columns: [[f64; N]; 6] = [(); 6].map(|()| [(); N].map(|()| number(choices)));
    let column = |choices: &mut Choices<'_>, k: usize| or(choices, columns[k].as_ptr(), null());
    let sample = phihat_sample {
        size: or(choices, size_of::<phihat_sample>(), 8),
        joints: or(choices, N, N - 1),
        q: column(choices, 0),
        dq: column(choices, 1),
        tau_applied: column(choices, 2),
        q_des: column(choices, 3),
        dq_des: column(choices, 4),
        ddq_des: column(choices, 5),
    };
    let sample_at = or(choices, &raw const sample, null());
    // Not a torque that anything of ours would write.
    let mut tau = [-1234.5; N];
    let command = phihat_command {
        size: or(choices, size_of::<phihat_command>(), 0),
        joints: or(choices, N, N + 1),
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
    drawn(512, played).unwrap();
}
