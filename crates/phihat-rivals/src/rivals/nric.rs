//! Nonlinear robust internal-loop compensator of Kim, Choi and Chung.

use crate::card::{Card, Grade, Tick, Ticks};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::facts::TorqueMax;
use crate::measured::{Acceleration, MeasuredMotion};
use crate::nominal::Nominal;
use crate::rival::Rival;
use crate::rivals::h_infinity_pid::{self, HInfinityPid};
use crate::rivals::proposed::{BANDWIDTH, DAMPING, outer_gains};
use crate::tuning::{Scalar, Tuning};

/// A nominal arm is simulated and controlled; the real one is made to follow it.
///
/// # Law
///
/// ```text
/// a   = q̈_d − K_d (q̇_n − q̇_d) − K_p (q_n − q_d)                                        (1)
/// τ_c = M̂(q_n) a + Ĉ(q_n, q̇_n) q̇_n + Ĝ(q_n) + F̂ q̇_n                                     nominal arm
/// τ   = τ_c − (K + 1/γ²) s,   s = (q̇ − q̇_n) + K_P (q − q_n) + K_I ∫(q − q_n)              (2)
/// ```
///
/// `(q_n, q̇_n)` starts on the arm's own state and moves with `a`. Where the arm states torque limits, `τ_c` is
/// limited by them first and the nominal arm moves as its forward dynamics then say. The integral stands still
/// while its joint's torque is limited.
///
/// # Guarantee
///
/// That of the H-infinity PID for (2), with `w` the mismatch of the models only: `K_P² > 2 K_I`.
///
/// # Not claimed
///
/// That it is model-free, as the row of Table 1 that it shares has it: it computes with a whole model.
///
/// # References
///
/// M. J. Kim, Y. Choi, W. K. Chung, "Bringing nonlinear H-infinity optimality to robot controllers", IEEE Trans.
/// Robotics 31(3), 2015. Grade A: three public implementations agree.
#[derive(Debug)]
pub(crate) struct Nric {
    kp: f64,
    kd: f64,
    pid: HInfinityPid,
    model: Nominal,
    limits: Option<TorqueMax>,
    q: Vec<f64>,
    dq: Vec<f64>,
    ddq: Vec<f64>,
    nominal_tau: Vec<f64>,
    started: bool,
    period: f64,
}

impl Nric {
    /// (1): leaves `a` and the nominal torque, limited both.
    fn command(&mut self, wants: Acceleration<'_>) {
        for (i, ddq) in self.ddq.iter_mut().enumerate() {
            let (e, de) = (self.q[i] - wants.q[i], self.dq[i] - wants.dq[i]);
            *ddq = wants.ddq[i] - self.kd * de - self.kp * e;
        }
        self.model.torque(&self.q, &self.dq, &self.dq, &self.ddq, &mut self.nominal_tau);
        let Some(limits) = &self.limits else { return };
        let mut limited = false;
        for (tau, max) in self.nominal_tau.iter_mut().zip(limits.values()) {
            limited |= tau.abs() > *max;
            *tau = tau.clamp(-max, *max);
        }
        if limited {
            self.model.acceleration(&self.q, &self.dq, &self.nominal_tau, &mut self.ddq);
        }
    }
}

impl Rival for Nric {
    const CARD: Card = Card {
        id: "nric",
        title: "Nonlinear robust internal-loop compensator",
        reference: "[5]",
        source: "Kim, Choi, Chung, IEEE T-RO 31(3), 2015",
        grade: Grade::A,
        caveat: "",
        law: "τ = τ_c − (K + 1/γ²)(ė_n + K_P e_n + K_I ∫e_n),  e_n = q − q_n of a simulated nominal arm under τ_c",
        printed: Some(Ticks {
            quantitative: Tick::Yes,
            easy: Tick::No,
            optimal: Tick::Yes,
            model_free: Tick::Yes,
        }),
    };
    const SCALARS: &'static [Scalar] = &[
        BANDWIDTH,
        DAMPING,
        h_infinity_pid::PROPORTIONAL,
        h_infinity_pid::INTEGRAL,
        h_infinity_pid::GAIN,
        h_infinity_pid::ATTENUATION,
    ];
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = (Nominal, Option<TorqueMax>);

    fn new(tuning: &Tuning, (model, limits): Self::Knows) -> Result<Self, RivalRefusal> {
        let [omega, zeta, proportional, integral, gain, gamma] = tuning.values()?;
        let [kp, kd] = outer_gains(omega, zeta);
        let pid = HInfinityPid::with([proportional, integral, gain, gamma], tuning);
        let zero = vec![0.0; model.joints()];
        Ok(Self {
            kp,
            kd,
            pid,
            model,
            limits,
            q: zero.clone(),
            dq: zero.clone(),
            ddq: zero.clone(),
            nominal_tau: zero,
            started: false,
            period: tuning.period(),
        })
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Acceleration<'_>,
        clipped: &[bool],
        tau: &mut [f64],
    ) {
        if !self.started {
            self.q.copy_from_slice(sees.q);
            self.dq.copy_from_slice(sees.dq);
            self.started = true;
        }
        self.command(wants);
        self.pid.answer(sees, [&self.q, &self.dq], clipped, tau);
        let h = self.period;
        for (i, tau) in tau.iter_mut().enumerate() {
            *tau += self.nominal_tau[i];
            self.q[i] += h * self.dq[i] + 0.5 * h * h * self.ddq[i];
            self.dq[i] += h * self.ddq[i];
        }
    }

    fn states(&self) -> usize {
        self.pid.states() + self.q.len() + self.dq.len()
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let [_, _, proportional, integral, gain, gamma] = tuning.values().ok()?;
        let values = [proportional, integral, gain, gamma];
        Some(h_infinity_pid::certificate(values, tuning.period(), arm))
    }

    fn optimality(tuning: &Tuning) -> Option<Condition> {
        let [_, _, proportional, integral, ..] = tuning.values::<6>().ok()?;
        Some(h_infinity_pid::proof([proportional, integral]))
    }
}
