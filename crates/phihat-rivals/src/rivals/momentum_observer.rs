//! Computed torque with the observer of the generalised momentum, and identified friction.

use crate::card::{Card, Grade};
use crate::error::RivalRefusal;
use crate::friction::Dry;
use crate::measured::{Acceleration, MotionAndTorque};
use crate::nominal::Nominal;
use crate::rival::Rival;
use crate::rivals::proposed::{BANDWIDTH, DAMPING, outer_gains};
use crate::tuning::{Scalar, Tuning};

/// Computed torque less what the momentum observer finds.
///
/// # Law
///
/// With `p = M̂(q) q̇` and dry friction as it was identified, along the reference:
///
/// ```text
/// r = K_O [p − p(0) − ∫(τ_applied + Ĉᵀ q̇ − Ĝ − F̂ q̇ − ĉ(q̇_d) + r) dt]                      (1)
/// τ = M̂ (q̈_d − K_d ė − K_p e) + Ĉ q̇ + Ĝ + F̂ q̇ + ĉ(q̇_d) − r                               (2)
/// ```
///
/// `r = K_O/(s + K_O) τ_ext` for a load `τ_ext` \[N·m\] on an arm with the model's parameters; no
/// acceleration is needed. (1) has its exact sampled pole.
///
/// # Guarantee
///
/// With an exact model and a load that stays, `e → 0`.
///
/// # Not claimed
///
/// Stability for a wrong model: what the model lacks goes through the observer, inertia included.
///
/// # References
///
/// A. De Luca, R. Mattone, "Sensorless robot collision detection and hybrid force/motion control", ICRA 2005;
/// A. De Luca, A. Albu-Schäffer, S. Haddadin, G. Hirzinger, IROS 2006, where `r` finds collisions. That it is
/// taken off a computed torque is common practice. Grade B.
#[derive(Debug)]
pub(crate) struct MomentumObserver {
    kp: f64,
    kd: f64,
    /// `K_O`, and `1 − e^{−K_O T}`.
    observer: [f64; 2],
    model: Nominal,
    dry: Dry,
    /// `r` \[N·m\]
    rest: Vec<f64>,
    /// `p` at the sample before, and `Ĉᵀ q̇ − Ĝ − F̂ q̇ − ĉ` there.
    momentum: Vec<f64>,
    change: Vec<f64>,
    room: [Vec<f64>; 3],
    started: bool,
    period: f64,
}

impl MomentumObserver {
    /// (1) over the sample that ends now; `friction` is `ĉ` now.
    fn observe(&mut self, sees: MotionAndTorque<'_>, friction: &[f64]) {
        let [now, change, scratch] = &mut self.room;
        self.model.momentum(sees.q, sees.dq, now);
        self.model.momentum_change(sees.q, sees.dq, scratch, change);
        let [_, share] = self.observer;
        for i in 0..self.rest.len() {
            change[i] -= friction[i];
            if self.started {
                let mean = 0.5 * (change[i] + self.change[i]);
                let external = (now[i] - self.momentum[i]) / self.period - sees.tau[i] - mean;
                self.rest[i] += share * (external - self.rest[i]);
            }
        }
        self.momentum.copy_from_slice(now);
        self.change.copy_from_slice(change);
        self.started = true;
    }
}

impl Rival for MomentumObserver {
    const CARD: Card = Card {
        id: "momentum-observer",
        title: "Computed torque with momentum observer",
        reference: "",
        source: "De Luca, Mattone, ICRA 2005; De Luca and others, IROS 2006",
        grade: Grade::B,
        caveat: "the observer is its authors'; that its residual is taken off a computed torque is common practice",
        law: "τ = M̂ (q̈_d − K_d ė − K_p e) + Ĉ q̇ + Ĝ + F̂ q̇ + ĉ(q̇_d) − r,\n\
              r = K_O [M̂ q̇ − ∫(τ_applied + Ĉᵀ q̇ − Ĝ − F̂ q̇ − ĉ + r)]",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[
        BANDWIDTH,
        DAMPING,
        Scalar {
            name: "observer_rate",
            unit: "1/s",
            meaning: "K_O",
            default: 50.0,
            low: 5.0,
            high: 500.0,
        },
    ];
    type Sees<'a> = MotionAndTorque<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = (Nominal, Dry);

    fn new(tuning: &Tuning, (model, dry): (Nominal, Dry)) -> Result<Self, RivalRefusal> {
        let [omega, zeta, rate] = tuning.values()?;
        let [kp, kd] = outer_gains(omega, zeta);
        let zero = vec![0.0; model.joints()];
        Ok(Self {
            kp,
            kd,
            observer: [rate, -(-rate * tuning.period()).exp_m1()],
            model,
            dry,
            rest: zero.clone(),
            momentum: zero.clone(),
            change: zero.clone(),
            room: [zero.clone(), zero.clone(), zero],
            started: false,
            period: tuning.period(),
        })
    }

    fn update(
        &mut self,
        sees: MotionAndTorque<'_>,
        wants: Acceleration<'_>,
        _: &[bool],
        tau: &mut [f64],
    ) {
        let friction: Vec<f64> =
            wants.dq.iter().enumerate().map(|(i, dq)| self.dry.torque(i, *dq)).collect();
        self.observe(sees, &friction);
        let wanted = &mut self.room[2];
        for (i, wanted) in wanted.iter_mut().enumerate() {
            let (e, de) = (sees.q[i] - wants.q[i], sees.dq[i] - wants.dq[i]);
            *wanted = wants.ddq[i] - self.kd * de - self.kp * e;
        }
        self.model.torque(sees.q, sees.dq, sees.dq, wanted, tau);
        for (i, tau) in tau.iter_mut().enumerate() {
            *tau += friction[i] - self.rest[i];
        }
    }

    fn states(&self) -> usize {
        3 * self.rest.len()
    }
}
