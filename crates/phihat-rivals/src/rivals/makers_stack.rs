//! Control stack of a robot maker: joint impedance, a filter of the torque, a limit of its rate.

use core::f64::consts::TAU;

use crate::card::{Card, Grade};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::facts::Drives;
use crate::measured::{MeasuredMotion, Velocity};
use crate::nominal::Nominal;
use crate::rival::Rival;
use crate::rivals::proposed::{BANDWIDTH, DAMPING, outer_gains};
use crate::tuning::{Scalar, Tuning};

/// Joint impedance with compensation of gravity and Coriolis torques, behind the interface's filter and rate limit.
///
/// # Law
///
/// ```text
/// u = −K_P e − K_D ė + Ĉ(q, q̇) q̇ + Ĝ(q),     K_P = U ω²,  K_D = 2 ζ ω U                  (1)
/// f_k = f_{k−1} + g (u_k − f_{k−1}),     g = T/(T + 1/(2π f_c))                            (2)
/// τ_k = τ_{k−1} + clip(f_k − τ_{k−1}, ± rate T)                                            (3)
/// ```
///
/// `f_c` is 100 Hz as shipped; the rate is the arm's, and (3) is left out where the arm states none. The
/// first sample goes through (2) and (3) as it is.
///
/// # Not claimed
///
/// Tracking without error: inertia, friction, and what the model lacks leave `e ≈ −(load)/K_P`. That it is
/// the code of a robot: there gravity is compensated below the interface, and the gains are one stiffness and
/// damping per joint.
///
/// # References
///
/// libfranka: `examples/joint_impedance_control.cpp`, `lowpassFilter` (cut-off 100 Hz by default) and
/// `limitRate` (1000 N·m/s). Grade B.
#[derive(Debug)]
pub(crate) struct MakersStack {
    proportional: Vec<f64>,
    derivative: Vec<f64>,
    share: f64,
    /// The most change in one sample \[N·m\] per joint, where there is a limit.
    step_max: Vec<Option<f64>>,
    model: Nominal,
    filtered: Vec<f64>,
    sent: Vec<f64>,
    zero: Vec<f64>,
    started: bool,
}

impl Rival for MakersStack {
    const CARD: Card = Card {
        id: "makers-stack",
        title: "Joint impedance, filter, rate limit",
        reference: "",
        source: "libfranka: joint_impedance_control, lowpassFilter, limitRate",
        grade: Grade::B,
        caveat: "gains per unit of inertia in place of one stiffness and damping per joint; gravity by the nominal \
            model",
        law: "u = −K_P e − K_D ė + Ĉ q̇ + Ĝ,  f = f₋₁ + g (u − f₋₁),  τ = τ₋₁ + clip(f − τ₋₁, ± rate T)",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[
        BANDWIDTH,
        DAMPING,
        Scalar {
            name: "torque_filter",
            unit: "Hz",
            meaning: "f_c of the torque",
            default: 100.0,
            low: 10.0,
            high: 1000.0,
        },
    ];
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Velocity<'a>;
    type Knows = (Nominal, Drives);

    fn new(tuning: &Tuning, (model, drives): (Nominal, Drives)) -> Result<Self, RivalRefusal> {
        let [omega, zeta, cutoff] = tuning.values()?;
        let ([kp, kd], period) = (outer_gains(omega, zeta), tuning.period());
        let n = tuning.joints();
        let step = |joint: usize| drives.limits(joint).1.map(|rate| rate * period);
        Ok(Self {
            proportional: tuning.per_joint(kp),
            derivative: tuning.per_joint(kd),
            share: period / (period + 1.0 / (TAU * cutoff)),
            step_max: (0..n).map(step).collect(),
            model,
            filtered: vec![0.0; n],
            sent: vec![0.0; n],
            zero: vec![0.0; n],
            started: false,
        })
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Velocity<'_>,
        _: &[bool],
        tau: &mut [f64],
    ) {
        self.model.rigid(sees.q, sees.dq, &self.zero, tau);
        for (i, tau) in tau.iter_mut().enumerate() {
            let (e, de) = (sees.q[i] - wants.q[i], sees.dq[i] - wants.dq[i]);
            let wanted = *tau - self.proportional[i] * e - self.derivative[i] * de;
            if self.started {
                self.filtered[i] += self.share * (wanted - self.filtered[i]);
                let step = self.filtered[i] - self.sent[i];
                self.sent[i] += self.step_max[i].map_or(step, |most| step.clamp(-most, most));
            } else {
                (self.filtered[i], self.sent[i]) = (wanted, wanted);
            }
            *tau = self.sent[i];
        }
        self.started = true;
    }

    fn states(&self) -> usize {
        2 * self.sent.len()
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let [omega, zeta, _] = tuning.values().ok()?;
        let (gain, period) = (2.0 * zeta * omega, tuning.period());
        Some(Condition::sampled("K_D T below the smallest inertia's limit", gain, period, arm))
    }
}
