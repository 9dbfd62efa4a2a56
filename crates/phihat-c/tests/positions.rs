//! PHIHAT_FORM_POSITIONS as a C program asks for it. Wrong if a bad member passed, was told under another name, or came
//! through as another number than C stated.
#![allow(unsafe_code, reason = "plays the part of a C program")]

use core::ffi::{CStr, c_char};
use core::ptr::{null, null_mut};

use crate::support::{TORQUE, filtered, seeing, supervision};
use phihat::{
    Command, InnovationSection, JointGains, JointState, Limits, Measurement, PositionDesign,
    Reference,
};
use phihat_c::{
    PHIHAT_DELAY_MAX, PHIHAT_MODE_HOLDING, PHIHAT_REQUEST_ARM, PHIHAT_REQUEST_HOLD, Status,
    phihat_command, phihat_controller_create, phihat_controller_destroy, phihat_controller_update,
    phihat_error, phihat_joint, phihat_report, phihat_request, phihat_sample,
    phihat_supervisor_create, phihat_supervisor_destroy, phihat_supervisor_step,
};

const T: f64 = 1e-3;

fn error() -> phihat_error {
    let size = size_of::<phihat_error>();
    phihat_error { size, joint: 0, value: 0.0, member: [1; 32], text: [1; 192] }
}

/// Status and error for these joints, of the controller and of the supervisor.
fn made(joints: &[phihat_joint]) -> [(Status, phihat_error); 2] {
    let (mut bare, mut supervised) = (null_mut(), null_mut());
    let mut why = [error(), error()];
    let options = supervision();
    let (at, count) = (joints.as_ptr(), joints.len());
    // SAFETY: all pointers are to living values, or null where that is allowed; handles are freed once.
    let statuses = unsafe {
        let first = phihat_controller_create(at, count, T, &raw mut bare, &raw mut why[0]);
        let (to, told) = (&raw mut supervised, &raw mut why[1]);
        let second = phihat_supervisor_create(at, null(), count, &raw const options, to, told);
        phihat_controller_destroy(bare);
        phihat_supervisor_destroy(supervised);
        [first, second]
    };
    [(statuses[0], why[0]), (statuses[1], why[1])]
}

fn text(of: &[c_char]) -> String {
    // SAFETY: written by the library, closed by a zero.
    unsafe { CStr::from_ptr(of.as_ptr()) }.to_string_lossy().into_owned()
}

/// Change of a joint, the reported member and its value.
type Case = (fn(&mut phihat_joint), &'static str, f64);

fn refused_by_name(joint: &phihat_joint, (change, member, value): Case) {
    let mut joints = [*joint; 3];
    change(&mut joints[2]);
    for (status, why) in made(&joints) {
        assert_eq!(status, Status::BadGain, "{member}");
        assert_eq!((why.joint, text(&why.member)), (2, member.to_owned()));
        assert_eq!(why.value.is_nan(), value.is_nan(), "{member}: {}", why.value);
        assert!(value.is_nan() || why.value.to_bits() == value.to_bits(), "{member}");
        assert!(text(&why.text).starts_with("joint 2: "), "{}", text(&why.text));
    }
}

#[test]
fn what_is_no_innovation_filter_is_refused_by_the_name_of_its_member() {
    let cases: [Case; 12] = [
        (|j| j.sections = 3, "sections", 3.0),
        (|j| j.torque_filter_hz = -1.0, "torque_filter_hz", -1.0),
        (|j| j.torque_filter_hz = 0.5, "torque_filter_hz", 0.5),
        (|j| j.torque_filter_hz = f64::NAN, "torque_filter_hz", f64::NAN),
        (|j| j.sections = u64::MAX, "sections", u64::MAX as f64),
        // On the circle, beyond -1, growing.
        (|j| j.section_rates[0] = [0.0, 0.3], "section_rates[0]", f64::NAN),
        (|j| j.section_rates[1] = [1.0, 2.5], "section_rates[1]", f64::NAN),
        (|j| j.section_rates[1] = [0.1, 0.05], "section_rates[1]", f64::NAN),
        (|j| j.section_rates[1][0] = f64::INFINITY, "section_rates[1]", f64::INFINITY),
        (|j| j.section_rates[0][1] = f64::NAN, "section_rates[0]", f64::NAN),
        (
            |j| j.section_weights_per_s2[1][1] = f64::NEG_INFINITY,
            "section_weights_per_s2[1]",
            f64::NEG_INFINITY,
        ),
        (|j| j.section_weights_per_s2[0][0] = f64::NAN, "section_weights_per_s2[0]", f64::NAN),
    ];
    for case in cases {
        refused_by_name(&filtered(), case);
    }
}

#[test]
fn what_cannot_be_is_refused_by_the_name_of_its_member() {
    let most = u64::from(PHIHAT_DELAY_MAX);
    let cases: [Case; 17] = [
        (|j| j.order = 0, "order", 0.0),
        (|j| j.order = 4, "order", 4.0),
        (|j| j.order = u32::MAX, "order", f64::from(u32::MAX)),
        (|j| j.correction[1] = f64::NAN, "correction[1]", f64::NAN),
        (|j| j.correction[2] = f64::NEG_INFINITY, "correction[2]", f64::NEG_INFINITY),
        (|j| j.correction[2] = 1000.0, "correction", f64::NAN),
        (|j| j.correction = [0.0; 5], "correction", f64::NAN),
        (|j| j.velocity_correction[0] = f64::INFINITY, "velocity_correction[0]", f64::INFINITY),
        (|j| j.velocity_correction[1] = 9.0, "correction", f64::NAN),
        (|j| j.share = 0.0, "share", 0.0),
        (|j| j.share = -0.5, "share", -0.5),
        (|j| j.share = 1.25, "share", 1.25),
        (|j| j.share = f64::NAN, "share", f64::NAN),
        (|j| j.delay_samples = 5, "delay_samples", 5.0),
        (|j| j.kp_per_s2 = -1.0, "kp_per_s2", -1.0),
        (|j| j.inertia_kg_m2 = 0.0, "inertia_kg_m2", 0.0),
        (|j| j.torque_max_nm = -87.0, "torque_max_nm", -87.0),
    ];
    for case in cases {
        refused_by_name(&seeing(), case);
    }
    let unused = [
        phihat_joint { delay_samples: most, ..seeing() },
        phihat_joint { share: 1.0, ..seeing() },
        // Beyond the order, and of other forms: not looked at.
        phihat_joint { correction: [0.271, 28.5, -1000.0, f64::NAN, f64::NAN], ..seeing() },
        phihat_joint { velocity_correction: [0.0, 0.0, 0.0, f64::NAN, 1e9], ..seeing() },
        phihat_joint { a: [f64::NAN; 4], ..seeing() },
        phihat_joint { share: f64::NAN, delay_samples: u64::MAX, ..crate::support::joint() },
        // Sections beyond those that are counted, and of other forms.
        phihat_joint { section_rates: [[f64::NAN; 2]; 2], ..seeing() },
        phihat_joint { sections: 1, section_rates: [[0.02, 0.3], [-1.0, 9.0]], ..filtered() },
        phihat_joint { sections: u64::MAX, ..crate::support::joint() },
    ];
    for (status, why) in made(&unused) {
        assert_eq!(status, Status::Ok, "{}", text(&why.text));
    }
}

/// `[q, q̇, τ, q_d, q̇_d, q̈_d]` of a joint that wanders.
fn signals(k: u32, tau: f64) -> [f64; 6] {
    let t = f64::from(k) * T;
    let (s, c) = (3.0 * t).sin_cos();
    [0.1 * s + 1e-4 * (40.0 * t).sin(), 0.3 * c, tau, 0.1 * s, 0.3 * c, -0.9 * s]
}

fn sample(of: &[f64; 6]) -> phihat_sample {
    phihat_sample {
        size: size_of::<phihat_sample>(),
        joints: 1,
        q: &raw const of[0],
        dq: &raw const of[1],
        tau_applied: &raw const of[2],
        q_des: &raw const of[3],
        dq_des: &raw const of[4],
        ddq_des: &raw const of[5],
    }
}

fn command(tau: &mut f64) -> phihat_command {
    let size = size_of::<phihat_command>();
    phihat_command { size, joints: 1, tau, phi_hat: null_mut(), flags: null_mut() }
}

#[test]
fn every_number_arrives_where_it_belongs() {
    // No two numbers are alike, order 3, and a velocity.
    let joint = phihat_joint {
        order: 3,
        correction: [0.764, 422.0, -127e3, -17.5e6, -924e6],
        velocity_correction: [1e-4, 0.2, -15.0, -800.0, -20e3],
        share: 0.7,
        delay_samples: 3,
        ..seeing()
    };
    let design = PositionDesign {
        inertia: joint.inertia_kg_m2,
        kp: joint.kp_per_s2,
        kd: joint.kd_per_s,
        correction: &[0.764, 422.0, -127e3, -17.5e6, -924e6],
        velocity_correction: &[1e-4, 0.2, -15.0, -800.0, -20e3],
        share: 0.7,
        delay: 3,
        period: T,
    };
    let limits = Limits::new(Some(TORQUE), None, T).unwrap();
    let law = JointGains::<f64>::from_positions(&design).unwrap().with_limits(limits);
    let plain = same_bits(&joint, &law);
    // And two sections, in their places.
    let own = filtered();
    let sections = [0, 1].map(|i| InnovationSection {
        rates: own.section_rates[i],
        weights: own.section_weights_per_s2[i],
    });
    for count in [1, 2] {
        let with = phihat_joint {
            sections: count as u64,
            section_rates: own.section_rates,
            section_weights_per_s2: own.section_weights_per_s2,
            ..joint
        };
        let filtered = law.with_innovation_filter(&sections[..count]).unwrap();
        assert_ne!(same_bits(&with, &filtered), plain, "a filter acts");
    }
    // And a low-pass on the torque.
    let with = phihat_joint { torque_filter_hz: 90.0, ..joint };
    let behind = law.with_torque_filter(Some(90.0)).unwrap();
    assert_ne!(same_bits(&with, &behind), plain, "a low-pass acts");
}

/// The torques of a joint in C, which are those of a law of the core.
fn same_bits(joint: &phihat_joint, law: &JointGains<f64>) -> Vec<u64> {
    let mut told = Vec::new();
    let mut state = JointState::new();
    let mut handle = null_mut();
    // SAFETY: all pointers are to living values, or null where that is allowed.
    let status = unsafe { phihat_controller_create(joint, 1, T, &raw mut handle, null_mut()) };
    assert_eq!(status, Status::Ok);
    let mut last = 0.0;
    for k in 0..400 {
        let of = signals(k, last);
        let (sample, mut tau) = (sample(&of), 0.0);
        let command = command(&mut tau);
        // SAFETY: all pointers are to living values.
        let status =
            unsafe { phihat_controller_update(handle, &raw const sample, &raw const command) };
        assert_eq!(status, Status::Ok);
        let [q, dq, tau_applied, q_des, dq_des, ddq_des] = of;
        let (m, r) =
            (Measurement { q, dq, tau_applied }, Reference { q: q_des, dq: dq_des, ddq: ddq_des });
        let Command { tau: wanted, .. } = law.update(&mut state, &m, &r);
        assert_eq!(tau.to_bits(), wanted.to_bits(), "sample {k}");
        told.push(tau.to_bits());
        last = tau;
    }
    // SAFETY: a living handle, once.
    unsafe { phihat_controller_destroy(handle) };
    told
}

#[test]
fn it_runs_under_supervision() {
    for joint in [seeing(), filtered()] {
        holds(&joint);
    }
}

fn holds(joint: &phihat_joint) {
    let options = supervision();
    let mut handle = null_mut();
    // SAFETY: all pointers are to living values, or null where that is allowed.
    let status = unsafe {
        let options = &raw const options;
        phihat_supervisor_create(joint, null(), 1, options, &raw mut handle, null_mut())
    };
    assert_eq!(status, Status::Ok);
    // A joint of 0.8 kg m² that carries 6 N·m, from the torque that holds it.
    let (load, part, much, mut of, mut acting, mut mode) = (6.0, 4.5, 50.0, [0.0; 6], 6.0, 0);
    for k in 0..3000_u64 {
        let (sample, mut tau) = (sample(&of), 0.0);
        let command = command(&mut tau);
        let request = phihat_request {
            size: size_of::<phihat_request>(),
            sequence: k,
            t_ns: k * 1_000_000,
            now_ns: k * 1_000_000,
            preset: &raw const load,
            mode: if k < 10 { PHIHAT_REQUEST_ARM } else { PHIHAT_REQUEST_HOLD },
            // Some of the load is known for a while, then nothing is said, then far too much.
            feed_forward: match k {
                0..1000 => &raw const part,
                1000..2000 => null(),
                _ => &raw const much,
            },
        };
        // SAFETY: null pointers and numbers only, and zero is one.
        let mut report: phihat_report = unsafe { core::mem::zeroed() };
        report.size = size_of::<phihat_report>();
        // SAFETY: all pointers are to living values.
        let status = unsafe {
            let (sample, request) = (&raw const sample, &raw const request);
            phihat_supervisor_step(handle, sample, request, &raw const command, &raw mut report)
        };
        assert_eq!(status, Status::Ok);
        assert!((tau - load).abs() < 1e-6, "{tau} N·m at sample {k}");
        mode = report.mode;
        let ddq = (acting - load) / 0.8;
        of = [of[0] + T * (of[1] + 0.5 * T * ddq), of[1] + T * ddq, acting, 0.0, 0.0, 0.0];
        acting = tau;
    }
    assert_eq!(mode, PHIHAT_MODE_HOLDING);
    // SAFETY: a living handle, once.
    unsafe { phihat_supervisor_destroy(handle) };
}
