//! Programs that were compiled with older headers: the first, whose phihat_joint had no member from
//! `correction` on, and the second, whose had none from `sections` on. Wrong if one is refused, gets another
//! torque than before, or has more read than it handed over.
#![allow(unsafe_code, reason = "plays the part of a C program")]

use core::ptr::{null, null_mut};

use crate::support::{command, sample, supervision};
use phihat_c::{
    PHIHAT_FORM_LITERAL, PHIHAT_FORM_OBSERVER, PHIHAT_FORM_POSITIONS, PHIHAT_REQUEST_HOLD, Status,
    phihat_controller_create, phihat_controller_destroy, phihat_controller_update, phihat_joint,
    phihat_request, phihat_supervisor_create, phihat_supervisor_destroy, phihat_supervisor_step,
};

const N: usize = 3;

/// phihat_joint as it was in the first header, written down again.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
struct Joint {
    size: usize,
    inertia_kg_m2: f64,
    kp_per_s2: f64,
    kd_per_s: f64,
    a: [f64; 4],
    order: u32,
    form: u32,
    torque_max_nm: f64,
    torque_rate_max_nm_s: f64,
}

/// As it was in the second.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
struct Seeing {
    first: Joint,
    correction: [f64; 5],
    velocity_correction: [f64; 5],
    share: f64,
    delay_samples: u64,
}

fn joint(k: u32, form: u32) -> phihat_joint {
    let kp_per_s2 = 300.0 + 50.0 * f64::from(k);
    if form == PHIHAT_FORM_POSITIONS {
        return phihat_joint { kp_per_s2, ..crate::support::seeing() };
    }
    phihat_joint { kp_per_s2, form, ..crate::support::joint() }
}

fn as_it_was(joint: &phihat_joint) -> Joint {
    Joint {
        size: size_of::<Joint>(),
        inertia_kg_m2: joint.inertia_kg_m2,
        kp_per_s2: joint.kp_per_s2,
        kd_per_s: joint.kd_per_s,
        a: joint.a,
        order: joint.order,
        form: joint.form,
        torque_max_nm: joint.torque_max_nm,
        torque_rate_max_nm_s: joint.torque_rate_max_nm_s,
    }
}

/// As a program of the second header says it.
fn as_it_saw(joint: &phihat_joint) -> Seeing {
    Seeing {
        first: Joint { size: size_of::<Seeing>(), ..as_it_was(joint) },
        correction: joint.correction,
        velocity_correction: joint.velocity_correction,
        share: joint.share,
        delay_samples: joint.delay_samples,
    }
}

/// Status, and the torques of some samples.
fn answers(joints: *const phihat_joint, count: usize) -> (Status, Vec<[u64; N]>) {
    let mut handle = null_mut();
    // SAFETY: as many joints as counted, each as large as it says.
    let status =
        unsafe { phihat_controller_create(joints, count, 1e-3, &raw mut handle, null_mut()) };
    let mut torques = Vec::new();
    for k in 0..if status == Status::Ok { 50 } else { 0 } {
        let of = [0, 1, 2, 3, 4, 5].map(|c| [1.0, 1.3, 1.7].map(|w| (w * f64::from(k + c)).sin()));
        let mut tau = [0.0; N];
        let (sample, command) = (sample(N, of.each_ref().map(|c| c.as_ptr())), command(&mut tau));
        // SAFETY: all pointers are to living values with N entries.
        let status =
            unsafe { phihat_controller_update(handle, &raw const sample, &raw const command) };
        assert_eq!(status, Status::Ok);
        torques.push(tau.map(f64::to_bits));
    }
    // SAFETY: a living handle or null, once.
    unsafe { phihat_controller_destroy(handle) };
    (status, torques)
}

#[test]
fn it_runs_as_it_did() {
    if size_of::<usize>() == 8 {
        let sizes = (size_of::<Joint>(), size_of::<Seeing>());
        assert_eq!(sizes, (88, 184), "what programs of then say");
    }
    for form in [PHIHAT_FORM_OBSERVER, PHIHAT_FORM_LITERAL] {
        let now: Vec<_> = (0..3).map(|k| joint(k, form)).collect();
        let then: Vec<_> = now.iter().map(as_it_was).collect();
        let (status, torques) = answers(then.as_ptr().cast(), N);
        assert_eq!(status, Status::Ok);
        assert_eq!(torques, answers(now.as_ptr(), N).1);
    }
    for form in [PHIHAT_FORM_OBSERVER, PHIHAT_FORM_LITERAL, PHIHAT_FORM_POSITIONS] {
        let now: Vec<_> = (0..3).map(|k| joint(k, form)).collect();
        let then: Vec<_> = now.iter().map(as_it_saw).collect();
        let (status, torques) = answers(then.as_ptr().cast(), N);
        assert_eq!(status, Status::Ok);
        assert_eq!(torques, answers(now.as_ptr(), N).1, "no filter");
    }
}

#[test]
fn it_runs_under_supervision() {
    let first: Vec<_> = (0..3).map(|k| as_it_was(&joint(k, PHIHAT_FORM_OBSERVER))).collect();
    let second: Vec<_> = (0..3).map(|k| as_it_saw(&joint(k, PHIHAT_FORM_POSITIONS))).collect();
    let options = supervision();
    for then in [first.as_ptr().cast::<phihat_joint>(), second.as_ptr().cast()] {
        let mut handle = null_mut();
        // SAFETY: all pointers are to living values, or null where that is allowed.
        unsafe {
            let (to, unheard) = (&raw mut handle, null_mut());
            let status = phihat_supervisor_create(then, null(), N, &raw const options, to, unheard);
            assert_eq!(status, Status::Ok);
            phihat_supervisor_destroy(handle);
        }
    }
}

#[test]
fn what_it_cannot_say_is_refused() {
    let seeing = as_it_was(&crate::support::seeing());
    assert_eq!(seeing.form, PHIHAT_FORM_POSITIONS);
    assert_eq!(answers([seeing; N].as_ptr().cast(), N).0, Status::BadGain);
    // Joints of two headers in one array: their places are not known.
    for older in [size_of::<Joint>(), size_of::<Seeing>()] {
        let mut mixed = [joint(0, PHIHAT_FORM_OBSERVER); N];
        mixed[1].size = older;
        assert_eq!(answers(mixed.as_ptr(), N).0, Status::WrongSize);
        mixed = [joint(0, PHIHAT_FORM_OBSERVER); N];
        mixed[0].size = older;
        assert_eq!(answers(mixed.as_ptr(), N).0, Status::WrongSize);
        for size in [older - 8, older + 8] {
            let joints = [phihat_joint { size, ..joint(0, PHIHAT_FORM_OBSERVER) }; N];
            assert_eq!(answers(joints.as_ptr(), N).0, Status::WrongSize, "{size}");
        }
    }
    for size in [0, 8, size_of::<phihat_joint>() - 8, usize::MAX] {
        let joints = [phihat_joint { size, ..joint(0, PHIHAT_FORM_OBSERVER) }; N];
        assert_eq!(answers(joints.as_ptr(), N).0, Status::WrongSize, "{size}");
    }
}

/// phihat_request as it was, written down again.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
struct Request {
    size: usize,
    sequence: u64,
    t_ns: u64,
    now_ns: u64,
    preset: *const f64,
    mode: u32,
}

#[test]
fn a_request_that_feeds_nothing_forward_is_understood() {
    let joints = [0, 1, 2].map(|k| joint(k, PHIHAT_FORM_OBSERVER));
    let mut handle = null_mut();
    let options = supervision();
    // SAFETY: all pointers are to living values, or null where that is allowed.
    unsafe {
        let (joints, options, to) = (joints.as_ptr(), &raw const options, &raw mut handle);
        let made = phihat_supervisor_create(joints, null(), N, options, to, null_mut());
        assert_eq!(made, Status::Ok);
    }
    let (zero, mut tau) = ([0.0; N], [0.0; N]);
    let (sample, command) = (sample(N, [zero.as_ptr(); 6]), command(&mut tau));
    let size = size_of::<Request>();
    assert_eq!(size, core::mem::offset_of!(phihat_request, feed_forward));
    for (size, wanted) in [
        (size, Status::Ok),
        (size - 8, Status::WrongSize),
        (size + 4, Status::WrongSize),
        (size_of::<phihat_request>() + 8, Status::WrongSize),
    ] {
        let request = Request {
            size,
            sequence: 0,
            t_ns: 0,
            now_ns: 0,
            preset: null(),
            mode: PHIHAT_REQUEST_HOLD,
        };
        // SAFETY: as much as the size says is there, or the size is refused.
        let status = unsafe {
            let request = (&raw const request).cast::<phihat_request>();
            let (sample, command) = (&raw const sample, &raw const command);
            phihat_supervisor_step(handle, sample, request, command, null_mut())
        };
        assert_eq!(status, wanted, "{size}");
    }
    // SAFETY: a living handle, once.
    unsafe { phihat_supervisor_destroy(handle) };
}
