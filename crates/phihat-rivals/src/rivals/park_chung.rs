//! Nonlinear H-infinity control of Park and Chung: the PID with the model ahead of it.

use crate::card::{Card, Grade};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::measured::{Acceleration, MeasuredMotion};
use crate::nominal::Nominal;
use crate::rival::Rival;
use crate::rivals::h_infinity_pid::{HInfinityPid, certificate, proof};
use crate::tuning::{Scalar, Tuning};

/// H-infinity PID with compensation by the model.
///
/// # Law
///
/// ```text
/// s = ė + K_P e + K_I ∫e,    q̇_r = q̇ − s,    q̈_r = q̈_d − K_P ė − K_I e                     (1)
/// τ = M̂ q̈_r + Ĉ(q, q̇) q̇_r + Ĝ + F̂ q̇_r − (K + 1/γ²) s
/// ```
///
/// The integral stands still while its joint's torque is limited.
///
/// # Guarantee
///
/// That of the H-infinity PID with `w` the mismatch of the models only, so that with an exact model its `V` falls
/// along every motion. Condition: `K_P² > 2 K_I`, and the sampled one.
///
/// # Not claimed
///
/// A bound on the error: it takes a bound on the mismatch.
///
/// # References
///
/// J. Park, W. K. Chung, "Analytic nonlinear H-infinity inverse-optimal control for Euler-Lagrange system", IEEE
/// Trans. Robotics and Automation 16(6), 2000. Grade B: known at second hand.
#[derive(Debug)]
pub(crate) struct ParkChung {
    pid: HInfinityPid,
    model: Nominal,
    ddq_r: Vec<f64>,
    dq_r: Vec<f64>,
    feedback: Vec<f64>,
}

impl Rival for ParkChung {
    const CARD: Card = Card {
        id: "park-chung",
        title: "Nonlinear H∞ (Park, Chung)",
        reference: "[13]",
        source: "Park, Chung, IEEE T-RA 16(6), 2000",
        grade: Grade::B,
        caveat: "the law at second hand; viscous friction is compensated along the reference velocity",
        law: "τ = M̂ q̈_r + Ĉ q̇_r + Ĝ + F̂ q̇_r − (K + 1/γ²) s,  s = ė + K_P e + K_I ∫e,  q̇_r = q̇ − s",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = HInfinityPid::SCALARS;
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Nominal;

    fn new(tuning: &Tuning, model: Nominal) -> Result<Self, RivalRefusal> {
        let pid = HInfinityPid::with(tuning.values()?, tuning);
        let zero = vec![0.0; model.joints()];
        Ok(Self { pid, model, ddq_r: zero.clone(), dq_r: zero.clone(), feedback: zero })
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Acceleration<'_>,
        clipped: &[bool],
        tau: &mut [f64],
    ) {
        self.pid.answer(sees, [wants.q, wants.dq], clipped, &mut self.feedback);
        let [proportional, integral] = self.pid.error_gains();
        for i in 0..tau.len() {
            let (e, de) = (sees.q[i] - wants.q[i], sees.dq[i] - wants.dq[i]);
            self.ddq_r[i] = wants.ddq[i] - proportional * de - integral * e;
            self.dq_r[i] = sees.dq[i] + self.feedback[i] / self.pid.gain(i);
        }
        self.model.torque(sees.q, sees.dq, &self.dq_r, &self.ddq_r, tau);
        for (tau, feedback) in tau.iter_mut().zip(&self.feedback) {
            *tau += feedback;
        }
    }

    fn states(&self) -> usize {
        self.pid.states()
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        Some(certificate(tuning.values().ok()?, tuning.period(), arm))
    }

    fn optimality(tuning: &Tuning) -> Option<Condition> {
        let [proportional, integral, ..] = tuning.values::<4>().ok()?;
        Some(proof([proportional, integral]))
    }
}
