//! PHIHAT_STATUS_REFUSED, as the header states it: every joint holds, and no joint remembers the sample.
//! Wrong if an arm that saw garbage answers the next good sample otherwise than one that did not.
#![allow(unsafe_code, reason = "plays the part of a C program")]

use core::ptr::null_mut;

use phihat_c::{
    PHIHAT_FORM_LITERAL, PHIHAT_FORM_OBSERVER, PHIHAT_FORM_POSITIONS, PHIHAT_REFUSED, Status,
    phihat_command, phihat_controller, phihat_controller_create, phihat_controller_destroy,
    phihat_controller_resume, phihat_controller_update, phihat_joint, phihat_sample,
};

const N: usize = 3;

fn joint(form: u32, kp: f64) -> phihat_joint {
    if form == PHIHAT_FORM_POSITIONS {
        return phihat_joint { kp_per_s2: kp, ..crate::support::seeing() };
    }
    phihat_joint {
        kp_per_s2: kp,
        a: [24_010_000.0, 1_372_000.0, 29_400.0, 280.0],
        order: 4,
        form,
        torque_rate_max_nm_s: 1000.0,
        ..crate::support::joint()
    }
}

/// A controller as a C program holds it.
struct Arm(*mut phihat_controller);

/// Six signals of each joint.
type Signals = [[f64; N]; 6];

impl Arm {
    fn new(joints: &[phihat_joint; N], period: f64) -> Self {
        let mut handle = null_mut();
        // SAFETY: all pointers are to living values.
        let status = unsafe {
            phihat_controller_create(joints.as_ptr(), N, period, &raw mut handle, null_mut())
        };
        assert_eq!(status, Status::Ok);
        Self(handle)
    }

    /// Status, torques, estimates, flags.
    fn update(&self, signals: &Signals) -> (Status, [u64; N], [u64; N], [u32; N]) {
        let (mut tau, mut phi_hat, mut flags) = ([0.0; N], [0.0; N], [0; N]);
        let sample = sample(signals);
        let command = phihat_command {
            size: size_of::<phihat_command>(),
            joints: N,
            tau: tau.as_mut_ptr(),
            phi_hat: phi_hat.as_mut_ptr(),
            flags: flags.as_mut_ptr(),
        };
        // SAFETY: all pointers are to living values with N entries.
        let status =
            unsafe { phihat_controller_update(self.0, &raw const sample, &raw const command) };
        (status, tau.map(f64::to_bits), phi_hat.map(f64::to_bits), flags)
    }

    fn resume(&self, signals: &Signals, tau: [f64; N]) -> Status {
        let sample = sample(signals);
        // SAFETY: all pointers are to living values with N entries.
        unsafe { phihat_controller_resume(self.0, &raw const sample, tau.as_ptr()) }
    }
}

impl Drop for Arm {
    fn drop(&mut self) {
        // SAFETY: a living handle, once.
        unsafe { phihat_controller_destroy(self.0) };
    }
}

fn sample([q, dq, tau_applied, q_des, dq_des, ddq_des]: &Signals) -> phihat_sample {
    phihat_sample {
        size: size_of::<phihat_sample>(),
        joints: N,
        q: q.as_ptr(),
        dq: dq.as_ptr(),
        tau_applied: tau_applied.as_ptr(),
        q_des: q_des.as_ptr(),
        dq_des: dq_des.as_ptr(),
        ddq_des: ddq_des.as_ptr(),
    }
}

fn good(k: u32) -> Signals {
    let t = f64::from(k) * 1e-3;
    let signal = |i: f64| [1.0, 1.3, 1.7].map(|w| (w * t + i).sin());
    [signal(0.0), signal(1.0), signal(2.0), signal(0.01), signal(1.01), signal(3.0)]
}

#[test]
fn garbage_is_refused_and_not_remembered() {
    for form in [PHIHAT_FORM_OBSERVER, PHIHAT_FORM_LITERAL, PHIHAT_FORM_POSITIONS] {
        for value in [f64::NAN, f64::INFINITY, -f64::MAX, 1e305, -1e100, 1e12, 4.3e9] {
            for (which, at) in (0..6).flat_map(|w| (0..N).map(move |j| (w, j))) {
                let [arm, clean] = [(); 2].map(|()| Arm::new(&[joint(form, 400.0); N], 1e-3));
                let mut held = [0; N];
                for k in 0..12 {
                    if k == 6 {
                        let mut signals = good(k);
                        signals[which][at] = value;
                        let (status, tau, _, flags) = arm.update(&signals);
                        assert_eq!((status, tau), (Status::Refused, held), "{value:e}");
                        assert_eq!(flags, [PHIHAT_REFUSED; N], "every joint");
                        assert_eq!(arm.resume(&signals, [1.0; N]), Status::Refused);
                        let mut tau = [1.0; N];
                        tau[at] = value;
                        assert_eq!(arm.resume(&good(k), tau), Status::Refused);
                    }
                    let told = arm.update(&good(k));
                    assert_eq!(told.0, Status::Ok, "{value:e}");
                    assert_eq!(told, clean.update(&good(k)), "{value:e} at sample {k}");
                    held = told.1;
                }
            }
        }
    }
}

#[test]
fn one_joint_that_overflows_holds_the_whole_arm() {
    // Large gains, a long period and an error as large as one can be: the integrals of one joint leave all bounds.
    let mut joints = [joint(PHIHAT_FORM_OBSERVER, 400.0); N];
    joints[1] = joint(PHIHAT_FORM_LITERAL, 1e270);
    let arm = Arm::new(&joints, 1e3);
    let mut signals = good(0);
    signals[0][1] = 4e9;
    let mut last = arm.update(&signals);
    let mut refused = 0;
    for k in 0..10_000 {
        signals[0][0] = f64::from(k % 7);
        let told = arm.update(&signals);
        if told.0 == Status::Refused {
            assert_eq!((told.1, told.2), (last.1, last.2), "the last torque of every joint");
            assert_eq!(told.3, [PHIHAT_REFUSED; N]);
            refused += 1;
        }
        last = told;
    }
    assert!(refused > 5000, "this test can fail: {refused}");
}
