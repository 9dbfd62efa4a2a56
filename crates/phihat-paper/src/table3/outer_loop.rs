//! PD as the paper's outer loop: (3) with the reference's acceleration, without an estimate.

use phihat_sim::{Driver, Moment};

/// `τ = M̄ (q̈_d − K_d ė − K_p e)`: (6) with φ̂ = 0.
#[derive(Debug)]
pub(super) struct OuterLoop {
    /// `M̄` per joint \[kg·m²\].
    pub(super) units: Vec<f64>,
    /// `K_p` \[1/s²\] and `K_d` \[1/s\].
    pub(super) gains: [f64; 2],
}

impl Driver for OuterLoop {
    fn drive(&mut self, moment: &Moment<'_>, tau: &mut [f64]) {
        let [kp, kd] = self.gains;
        let joints = moment.sample.joints.iter().zip(moment.references).zip(&self.units);
        for (tau, ((measured, wanted), unit)) in tau.iter_mut().zip(joints) {
            let (e, de) = (measured.q - wanted.q, measured.dq - wanted.dq);
            *tau = unit * (wanted.ddq - kd * de - kp * e);
        }
    }
}
