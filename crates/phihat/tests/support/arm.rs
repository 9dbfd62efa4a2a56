//! A supervised arm of independent joints in the laboratory: `J q̈ = τ − φ(t)`, integrated exactly under a
//! hold. What the sensor says and which sample comes are the test's to spoil.
#![allow(dead_code, reason = "each test file uses its part")]
#![allow(clippy::large_types_passed_by_value, reason = "a test reads better so")]

use phihat::{
    Answer, Form, JointDesign, JointGains, JointOptions, Limits, Measurement, ModeRequest, Options,
    Reference, Request, Sample, Stamp, Supervisor, SupervisorState,
};

/// Sample period.
pub(crate) const T: f64 = 1e-3;
/// The same in nanoseconds.
pub(crate) const T_NS: u64 = 1_000_000;
/// First order at 70 rad/s.
pub(crate) const FIRST: &[f64] = &[70.0];
/// Second order at 70 rad/s.
pub(crate) const SECOND: &[f64] = &[4900.0, 140.0];

/// 87 N·m and 1000 N·m/s around the paper-like gains, inertia 1.
pub(crate) fn gains(a: &[f64]) -> JointGains<f64> {
    let design =
        JointDesign { inertia: 1.0, kp: 400.0, kd: 40.0, a, period: T, form: Form::Observer };
    let limits = Limits::new(Some(87.0), Some(1000.0), T).unwrap();
    JointGains::new(&design).unwrap().with_limits(limits)
}

/// One joint's truth.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Truth {
    pub(crate) inertia: f64,
    pub(crate) load: f64,
    pub(crate) q: f64,
    pub(crate) dq: f64,
    pub(crate) tau: f64,
    /// Factor on the torque: 1 as commanded, 0 dead, −1 wrong sign.
    pub(crate) drive: f64,
}

/// An arm under supervision.
pub(crate) struct Arm<const N: usize> {
    pub(crate) supervisor: Supervisor<f64, N>,
    pub(crate) state: SupervisorState<f64, N>,
    pub(crate) truth: [Truth; N],
    pub(crate) k: u64,
    pub(crate) mode: ModeRequest,
    pub(crate) preset: Option<[f64; N]>,
}

/// One sample as it reaches the controller.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Seen<const N: usize> {
    pub(crate) stamp: Stamp,
    pub(crate) now_ns: u64,
    pub(crate) joints: [Measurement<f64>; N],
}

impl<const N: usize> Arm<N> {
    pub(crate) fn new(a: &[f64], joint: JointOptions<f64>) -> Self {
        Self::with(a, joint, &Options::new(T_NS))
    }

    pub(crate) fn with(a: &[f64], joint: JointOptions<f64>, options: &Options) -> Self {
        let truth = Truth { inertia: 1.0, load: 0.0, q: 0.0, dq: 0.0, tau: 0.0, drive: 1.0 };
        Self {
            supervisor: Supervisor::new([gains(a); N], &[joint; N], options).unwrap(),
            state: SupervisorState::new(),
            truth: [truth; N],
            k: 0,
            mode: ModeRequest::Idle,
            preset: None,
        }
    }

    pub(crate) fn time(&self) -> f64 {
        self.k as f64 * T
    }

    /// The undisturbed sample.
    pub(crate) fn sense(&self) -> Seen<N> {
        let t_ns = self.k * T_NS;
        let joints = self.truth.map(|j| Measurement { q: j.q, dq: j.dq, tau_applied: j.tau });
        Seen { stamp: Stamp { sequence: self.k, t_ns }, now_ns: t_ns, joints }
    }

    /// One period: the controller sees `seen`, the plant moves on.
    pub(crate) fn step_with(
        &mut self,
        seen: &Seen<N>,
        references: &[Reference<f64>; N],
    ) -> Answer<f64, N> {
        let sample = Sample { stamp: seen.stamp, now_ns: seen.now_ns, joints: &seen.joints };
        let preset = self.preset.as_ref().map(|p| &p[..]);
        let request = Request { mode: self.mode, references, preset, feed_forward: None };
        let answer = self.supervisor.step(&mut self.state, &sample, &request);
        for (joint, command) in self.truth.iter_mut().zip(&answer.commands) {
            joint.tau = command.tau;
            let ddq = (joint.drive * command.tau - joint.load) / joint.inertia;
            joint.q += T * joint.dq + 0.5 * T * T * ddq;
            joint.dq += T * ddq;
        }
        self.k += 1;
        answer
    }

    pub(crate) fn step(&mut self, references: &[Reference<f64>; N]) -> Answer<f64, N> {
        let seen = self.sense();
        self.step_with(&seen, references)
    }

    /// Arms, holds and tracks where the arm stands; the load is held from the first torque on.
    pub(crate) fn start(&mut self) {
        let here = self.truth.map(|j| Reference { q: j.q, dq: 0.0, ddq: 0.0 });
        let loads = self.truth.map(|j| j.load);
        // The brakes are closed until the torque is there.
        self.preset = Some(loads);
        for (mode, samples) in
            [(ModeRequest::Arm, 200), (ModeRequest::Hold, 1), (ModeRequest::Track, 1)]
        {
            self.mode = mode;
            for _ in 0..samples {
                let before = self.truth;
                let answer = self.step(&here);
                assert!(answer.report.refusal.is_none(), "{:?}", answer.report);
                if mode == ModeRequest::Arm {
                    for (joint, old) in self.truth.iter_mut().zip(before) {
                        (joint.q, joint.dq) = (old.q, 0.0);
                    }
                }
            }
        }
        self.preset = None;
    }
}

/// The same reference for every joint.
pub(crate) fn at<const N: usize>(q: f64, dq: f64, ddq: f64) -> [Reference<f64>; N] {
    [Reference { q, dq, ddq }; N]
}

/// Small seeded generator (SplitMix64).
pub(crate) struct Dice(pub(crate) u64);

impl Dice {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub(crate) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.bits() >> 11) as f64 / (1_u64 << 53) as f64)
    }
}
