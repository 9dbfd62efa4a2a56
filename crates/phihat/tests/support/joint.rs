//! One supervised joint that is where the test says, sample by sample.
#![allow(dead_code, reason = "each test file uses its part")]
#![allow(clippy::large_types_passed_by_value, reason = "a test reads better so")]

use phihat::{
    Answer, Form, JointDesign, JointGains, JointOptions, Measurement, ModeRequest, Options,
    Reference, Request, Sample, Stamp, Supervisor, SupervisorState,
};

/// Nominal inertia.
pub(crate) const INERTIA: f64 = 0.7;
/// Sample period.
pub(crate) const T: f64 = 1e-3;
/// The same in nanoseconds.
pub(crate) const T_NS: u64 = 1_000_000;

/// Gains without limits.
pub(crate) fn gains(kp: f64, kd: f64, a: &[f64]) -> JointGains<f64> {
    let design = JointDesign { inertia: INERTIA, kp, kd, a, period: T, form: Form::Observer };
    JointGains::new(&design).unwrap()
}

/// `M̄ (q̈_d − K_d ė − K_p e)`.
pub(crate) fn outer(kp: f64, kd: f64, m: &Measurement<f64>, r: &Reference<f64>) -> f64 {
    INERTIA * (r.ddq - kd * (m.dq - r.dq) - kp * (m.q - r.q))
}

/// One joint.
pub(crate) struct Joint {
    pub(crate) arm: Supervisor<f64, 1>,
    pub(crate) state: SupervisorState<f64, 1>,
    pub(crate) k: u64,
}

impl Joint {
    pub(crate) fn new(gains: JointGains<f64>, joint: JointOptions<f64>, options: &Options) -> Self {
        let options = Options { start_mismatch_max: 100.0, ..*options };
        let arm = Supervisor::new([gains], &[joint], &options).unwrap();
        Self { arm, state: SupervisorState::new(), k: 0 }
    }

    pub(crate) fn step(
        &mut self,
        mode: ModeRequest,
        m: Measurement<f64>,
        r: Reference<f64>,
    ) -> Answer<f64, 1> {
        let t_ns = self.k * T_NS;
        let stamp = Stamp { sequence: self.k, t_ns };
        self.k += 1;
        let sample = Sample { stamp, now_ns: t_ns, joints: &[m] };
        self.arm.step(
            &mut self.state,
            &sample,
            &Request { mode, references: &[r], preset: None, feed_forward: None },
        )
    }

    /// No sample came.
    pub(crate) fn miss(&mut self, mode: ModeRequest, r: Reference<f64>) -> Answer<f64, 1> {
        let t_ns = self.k * T_NS;
        self.k += 1;
        let joints = [Measurement::default()];
        let stamp = Stamp { sequence: 0, t_ns };
        let sample = Sample { stamp, now_ns: u64::MAX, joints: &joints };
        self.arm.step(
            &mut self.state,
            &sample,
            &Request { mode, references: &[r], preset: None, feed_forward: None },
        )
    }

    /// Armed, then holding where it is measured.
    pub(crate) fn hold(&mut self, m: Measurement<f64>, r: Reference<f64>) -> Answer<f64, 1> {
        self.step(ModeRequest::Arm, m, r);
        self.step(ModeRequest::Hold, m, r)
    }
}
