//! The motion that a tube is around.

use phihat_study::Study;

/// The motion at every sample, rows of `n`.
#[derive(Debug, Clone, PartialEq)]
pub struct Desired {
    /// `q_d` \[rad\].
    pub q: Vec<f64>,
    /// `q̇_d` \[rad/s\].
    pub dq: Vec<f64>,
    /// `q̈_d` \[rad/s²\].
    pub ddq: Vec<f64>,
}

impl Desired {
    /// The same with accelerations added to those that are fed forward, row by row \[rad/s²\].
    #[must_use]
    pub fn feeding(mut self, rows: &[Vec<f64>]) -> Self {
        self.ddq.iter_mut().zip(rows.iter().flatten()).for_each(|(own, more)| *own += more);
        self
    }

    /// Samples a motion `(joint, t) → q_d, q̇_d, q̈_d` as a study's run does.
    pub fn of(study: &Study, at: impl Fn(usize, f64) -> [f64; 3]) -> Self {
        let n = study.robot.joints.len();
        let period_ns = study.control.period_ns;
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the study bounds duration and rate"
        )]
        let samples = ((study.duration * 1e9 / period_ns as f64).round() as u64).max(1);
        let mut out = Self { q: Vec::new(), dq: Vec::new(), ddq: Vec::new() };
        for k in 0..samples {
            let t = (k * period_ns) as f64 * 1e-9;
            for joint in 0..n {
                let [q, dq, ddq] = at(joint, t);
                out.q.push(q);
                out.dq.push(dq);
                out.ddq.push(ddq);
            }
        }
        out
    }
}
