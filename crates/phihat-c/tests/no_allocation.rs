//! After a controller is made, its calls allocate nothing, and bad calls answer a status.
#![allow(unsafe_code, reason = "plays the part of a C program")]

use core::ffi::CStr;
use core::ptr::null_mut;

use crate::support::{command, joint, sample};
use phihat_c::{
    Status, phihat_controller, phihat_controller_create, phihat_controller_destroy,
    phihat_controller_reset, phihat_controller_resume, phihat_controller_update, phihat_error,
    phihat_joint, phihat_status_text,
};

const N: usize = 7;

fn error() -> phihat_error {
    let size = size_of::<phihat_error>();
    phihat_error { size, joint: 0, value: 0.0, member: [1; 32], text: [1; 192] }
}

fn made() -> *mut phihat_controller {
    let mut handle = null_mut();
    // SAFETY: all pointers are to living values.
    let status = unsafe {
        phihat_controller_create([joint(); N].as_ptr(), N, 1e-3, &raw mut handle, null_mut())
    };
    assert_eq!(status, Status::Ok);
    handle
}

#[test]
fn only_create_and_destroy_touch_the_heap() {
    let controller = made();
    let (zero, mut tau) = ([0.0; N], [0.0; N]);
    let at = zero.as_ptr();
    let (sample, command) = (sample(N, [at; 6]), command(&mut tau));
    let mut statuses = [Status::Internal; 4];
    let used = allocation_counter::measure(|| {
        // SAFETY: all pointers are to living values with N entries.
        statuses = unsafe {
            [
                phihat_controller_update(controller, &raw const sample, &raw const command),
                phihat_controller_resume(controller, &raw const sample, at),
                phihat_controller_update(null_mut(), &raw const sample, &raw const command),
                phihat_controller_reset(controller),
            ]
        };
    });
    assert_eq!(statuses, [Status::Ok, Status::Ok, Status::NullPointer, Status::Ok]);
    assert_eq!(used.count_total, 0);
    let all = allocation_counter::measure(|| {
        // SAFETY: a living handle, once.
        unsafe { phihat_controller_destroy(made()) };
    });
    assert!(all.count_total > 0, "the counter counts");
    assert_eq!(all.count_current, 0, "what create takes, destroy gives back");
    // SAFETY: a living handle, once.
    unsafe { phihat_controller_destroy(controller) };
}

#[test]
fn refusals_name_joint_member_value_and_text() {
    let create = |joints: &[phihat_joint], period: f64, error: &mut phihat_error| {
        let mut handle = null_mut();
        // SAFETY: all pointers are to living values.
        let status = unsafe {
            phihat_controller_create(joints.as_ptr(), joints.len(), period, &raw mut handle, error)
        };
        assert!(handle.is_null(), "a refusal makes no handle");
        status
    };
    // SAFETY: written by the library, closed by a zero.
    let text = |text: &[core::ffi::c_char]| unsafe { CStr::from_ptr(text.as_ptr()) }.to_owned();

    let mut joints = [joint(); N];
    joints[3].kd_per_s = -1.0;
    let mut why = error();
    assert_eq!(create(&joints, 1e-3, &mut why), Status::BadGain);
    assert_eq!((why.joint, text(&why.member).as_c_str()), (3, c"kd_per_s"));
    assert!((why.value + 1.0).abs() < 1e-15);
    let expected = c"joint 3: kd [1/s] is -1; it must be positive and finite";
    assert_eq!(text(&why.text).as_c_str(), expected);

    for (change, member) in [
        ((|j| j.order = 5) as fn(&mut phihat_joint), c"order"),
        (|j| j.order = 0, c"order"),
        (|j| j.a[1] = f64::NAN, c"a[1]"),
        (|j| j.inertia_kg_m2 = f64::INFINITY, c"inertia_kg_m2"),
        (|j| j.torque_max_nm = 0.0, c"torque_max_nm"),
        (|j| j.torque_max_nm = f64::NAN, c"torque_max_nm"),
        (|j| j.torque_rate_max_nm_s = f64::NEG_INFINITY, c"torque_rate_max_nm_s"),
    ] {
        let mut joints = [joint(); N];
        change(&mut joints[6]);
        assert_eq!(create(&joints, 1e-3, &mut why), Status::BadGain);
        assert_eq!((why.joint, text(&why.member).as_c_str()), (6, member));
    }
    assert_eq!(create(&[joint()], f64::NAN, &mut why), Status::BadGain);
    assert_eq!(text(&why.member).as_c_str(), c"period_s");
    assert_eq!(create(&[], 1e-3, &mut why), Status::WrongJoints);
    let old = phihat_joint { size: 16, ..joint() };
    assert_eq!(create(&[joint(), old], 1e-3, &mut why), Status::WrongSize);
    assert_eq!(why.joint, 1);
    let other_form = phihat_joint { form: 7, ..joint() };
    assert_eq!(create(&[other_form], 1e-3, &mut why), Status::BadGain);
    assert_eq!((text(&why.member).as_c_str(), why.value), (c"form", 7.0));
}

#[test]
fn every_status_has_a_text_of_its_own() {
    // SAFETY: texts of the library.
    let text = |status| unsafe { CStr::from_ptr(phihat_status_text(status)) };
    for status in 0..=8 {
        assert!((status + 1..=9).all(|other| text(status) != text(other)));
    }
}
