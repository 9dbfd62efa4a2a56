//! Feed-forward where a supervisor is between the motion and the law.

use phihat::{JointMemory, Reference};
use phihat_study::Study;

use crate::error::SimError;
use crate::feedforward::FeedForwardTorque;
use crate::motion::Motion;
use crate::spline::Jet;

/// Feed-forward of a study along the reference in force, which is blended, shaped or held by the supervisor.
///
/// # Method
///
/// The reference in force is known one sample late. While the study's motion is followed, the prediction is
/// that motion plus the difference of the two at the last sample, extrapolated; otherwise, on the way to a
/// commanded position or at rest, the reference in force itself is extrapolated from there:
///
/// ```text
/// x(t + h) = (q + h q̇ + h² q̈/2,  q̇ + h q̈,  q̈)
///            (h: from the last sample to the instant of the feed-forward)
/// ```
///
/// If nothing is blended or shaped, the difference is zero and the feed-forward is that of the motion, as
/// without a supervisor.
#[derive(Debug)]
pub(crate) struct InForce {
    own: FeedForwardTorque,
    inertia: Vec<f64>,
    /// Sample period \[s\].
    period: f64,
    /// The reference in force at the last answered sample, and the requested one at that time.
    last: Vec<(Reference<f64>, Reference<f64>)>,
    /// `τ_ff` \[N·m\].
    torque: Vec<f64>,
}

impl InForce {
    /// `None`: the study feeds nothing forward but `M̄ q̈_d`.
    ///
    /// # Errors
    ///
    /// As [`FeedForwardTorque::of`].
    pub(crate) fn of(study: &Study, inertia: Vec<f64>) -> Result<Option<Self>, SimError> {
        let n = inertia.len();
        let period = study.control.period_ns as f64 * 1e-9;
        let with = |own| Self {
            own,
            inertia,
            period,
            last: vec![(Reference::default(), Reference::default()); n],
            torque: vec![0.0; n],
        };
        Ok(FeedForwardTorque::of(study)?.map(with))
    }

    /// `τ_ff` \[N·m\] per joint, `samples` samples after the last answered one; `motion` with the time on its
    /// clock \[s\], where it is followed.
    pub(crate) fn torque(&mut self, motion: Option<(&Motion, f64)>, samples: u32) -> &[f64] {
        let Self { own, inertia, period, last, torque } = self;
        let ahead = own.ahead();
        let h = f64::from(samples) * *period + ahead;
        let jet = |i: usize| {
            let (in_force, asked) = last[i];
            let Some((motion, t)) = motion else { return carried_on(&in_force, h) };
            let apart = Reference {
                q: in_force.q - asked.q,
                dq: in_force.dq - asked.dq,
                ddq: in_force.ddq - asked.ddq,
            };
            let [at, more] = [motion.at(i, t + ahead), carried_on(&apart, h)];
            [at[0] + more[0], at[1] + more[1], at[2] + more[2]]
        };
        own.torque(jet, inertia, torque);
        torque
    }

    /// A sample was answered: what was asked for, and what came of it.
    pub(crate) fn answered(&mut self, asked: &[Reference<f64>], joints: &[JointMemory<f64>]) {
        for ((last, asked), memory) in self.last.iter_mut().zip(asked).zip(joints) {
            *last = (*memory.reference(), *asked);
        }
    }
}

/// Reference after a time `h` \[s\] at constant acceleration.
fn carried_on(from: &Reference<f64>, h: f64) -> Jet {
    let Reference { q, dq, ddq } = *from;
    [q + h * (dq + 0.5 * h * ddq), dq + h * ddq, ddq]
}
