//! Time-delay control: what the last sample did not explain is what acts now.

use crate::card::{Card, Grade};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::facts::Inertia;
use crate::measured::{Acceleration, MotionAndCommand};
use crate::rival::Rival;
use crate::rivals::proposed::{BANDWIDTH, DAMPING, outer_gains, window};
use crate::tuning::{Scalar, Tuning};

/// Time-delay control.
///
/// # Law
///
/// ```text
/// τ_k = M̄ (q̈_d − K_d ė − K_p e) + τ_{k−1} − M̄ (q̇_k − q̇_{k−1})/T                        (1)
/// ```
///
/// `τ_{k−1}` is the torque that was commanded last, within its limits: without a delay it is the one that
/// acted while `q̇` went from one sample to the other, and this is the paper's law of order 1, by forward
/// Euler, with `a_0 = 1/T`; a test compares the two.
///
/// # Guarantee
///
/// `|1 − M⁻¹ M̄| < 1` for frozen inertia, that is `M̄ < 2 M`; with the outer loop and the delay counted, the
/// lower end of the window of the first-order law at `a_0 = 1/T`. Behind `d` samples, with `r = M̄/M`, the
/// loop's polynomial is
///
/// ```text
/// z^d (z − 1)³ + r [(z − 1)² + K_d T z (z − 1) + ½ K_p T² z (z + 1)]                    (2)
/// ```
///
/// # Not claimed
///
/// A bound on the error. That a delay costs nothing: with the torque that *acted*, (1) would be `d + 1`
/// integrators that take turns, with a pole near `z = −1` for every small `r`; so it is not.
///
/// # References
///
/// K. Youcef-Toumi, O. Ito, "A time delay controller for systems with unknown dynamics", J. Dyn. Sys. Meas.
/// Control 112, 1990; T. C. Hsia, L. S. Gao, ICRA 1990. Grade A.
#[derive(Debug)]
pub(crate) struct TimeDelay {
    kp: f64,
    kd: f64,
    rest: DelayRest,
}

/// The time-delay estimate `τ_{k−1} − M̄ (q̇_k − q̇_{k−1})/T` of the lumped dynamics; 0 at the first sample.
#[derive(Debug)]
pub(crate) struct DelayRest {
    inertia: Vec<f64>,
    dq: Vec<f64>,
    started: bool,
    period: f64,
}

/// `M̄` is the law's gain against noise: its authors raise it from small values until noise shows. At a tenth of the
/// joint's mean inertia it does not yet, with an encoder; behind a sample of delay and a velocity filter it does.
pub(crate) const INERTIA_SHARE: Scalar = Scalar {
    name: "inertia_share",
    unit: "",
    meaning: "M̄ over the joint's nominal inertia",
    default: 0.1,
    low: 0.01,
    high: 2.0,
};

impl DelayRest {
    /// With `M̄` a share of the joints' nominal inertia.
    pub(crate) fn new(inertia: &Inertia, share: f64, period: f64) -> Self {
        let inertia: Vec<f64> = inertia.values().iter().map(|inertia| share * inertia).collect();
        Self { dq: vec![0.0; inertia.len()], inertia, started: false, period }
    }

    /// `τ = M̄ u +` the estimate, with `u` of each joint from its index.
    pub(crate) fn torque(
        &mut self,
        sees: MotionAndCommand<'_>,
        mut wanted: impl FnMut(usize) -> f64,
        tau: &mut [f64],
    ) {
        for (i, tau) in tau.iter_mut().enumerate() {
            let m = self.inertia[i];
            let jerked = m * (sees.dq[i] - self.dq[i]) / self.period;
            let estimate = if self.started { sees.commanded[i] - jerked } else { 0.0 };
            *tau = m * wanted(i) + estimate;
            self.dq[i] = sees.dq[i];
        }
        self.started = true;
    }

    /// Scalars that it remembers.
    pub(crate) fn states(&self) -> usize {
        self.dq.len()
    }
}

impl Rival for TimeDelay {
    const CARD: Card = Card {
        id: "time-delay",
        title: "Time-delay control",
        reference: "",
        source: "Youcef-Toumi, Ito, J. Dyn. Sys. Meas. Control 112, 1990",
        grade: Grade::A,
        caveat: "",
        law: "τ = M̄ (q̈_d − K_d ė − K_p e) + τ₋₁ − M̄ (q̇ − q̇₋₁)/T",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[BANDWIDTH, DAMPING, INERTIA_SHARE];
    type Sees<'a> = MotionAndCommand<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Inertia;

    fn new(tuning: &Tuning, inertia: Inertia) -> Result<Self, RivalRefusal> {
        let [omega, zeta, share] = tuning.values()?;
        let [kp, kd] = outer_gains(omega, zeta);
        Ok(Self { kp, kd, rest: DelayRest::new(&inertia, share, tuning.period()) })
    }

    fn update(
        &mut self,
        sees: MotionAndCommand<'_>,
        wants: Acceleration<'_>,
        _: &[bool],
        tau: &mut [f64],
    ) {
        let (kp, kd) = (self.kp, self.kd);
        let wanted = |i: usize| {
            wants.ddq[i] - kd * (sees.dq[i] - wants.dq[i]) - kp * (sees.q[i] - wants.q[i])
        };
        self.rest.torque(sees, wanted, tau);
    }

    fn states(&self) -> usize {
        self.rest.states()
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let [omega, zeta, share] = tuning.values().ok()?;
        let [kp, kd] = outer_gains(omega, zeta);
        let arm = DeclaredArm { ratio: arm.ratio.map(|ratio| ratio / share), ..arm.clone() };
        Some(window(kp, kd, 1.0 / tuning.period(), tuning.period(), &arm))
    }
}
