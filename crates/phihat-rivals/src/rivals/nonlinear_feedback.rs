//! Computed torque with composite nonlinear feedback.

use crate::card::{Card, Grade, Tick, Ticks};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::math::Weighted;
use crate::measured::{Acceleration, MeasuredMotion};
use crate::nominal::Nominal;
use crate::rival::Rival;
use crate::shared::ERROR_BANDWIDTH;
use crate::tuning::{Scalar, Tuning};

/// Computed torque with composite nonlinear feedback, in the class of Peng, Lin and Su.
///
/// # Law
///
/// ```text
/// τ = M̂ (q̈_d − ω² e − 2 ζ_0 ω ė + ρ(e)(p_12 e + p_22 ė)) + Ĉ q̇ + Ĝ + F̂ q̇               (1)
/// ρ(e) = −β |exp(−α |e|/|e_0|) − exp(−α)|                                                (2)
/// ```
///
/// Little damping far away, for speed; more close by, against overshoot. `p_12, p_22` solve the Lyapunov equation of
/// the linear part for `W = diag(100 s⁻², W_2)`. `e_0` is the error at the first sample, at least 1 mrad.
///
/// # Guarantee
///
/// With an exact model, and while no torque is limited, any `ρ ≤ 0` keeps `V = xᵀPx` decreasing:
/// `dV/dt = −xᵀWx + 2ρ(BᵀPx)²`.
///
/// # Not claimed
///
/// Anything about what the model lacks. The published design picks `ω` so that the linear part stays within the
/// torque limits; here `ω` is free.
///
/// # References
///
/// W. Peng, Z. Lin, J. Su, "Computed torque control-based composite nonlinear feedback controller for robot
/// manipulators with bounded torques", IET Control Theory & Applications 3(6), 2009. Grade C for the arm; the
/// feedback is textbook (B. M. Chen, T. H. Lee, K. Peng, V. Venkataramanan, 2003). The title, and Table 1 of Hayat,
/// Leibold and Buss, say that computed torque is inside and the outer loop is modified. Unknown are the function
/// `ρ(e)`, how the torque limits enter it and the reference, and the gains.
#[derive(Debug)]
pub(crate) struct NonlinearFeedback {
    linear: [f64; 2],
    direction: Weighted,
    growth: f64,
    shape: f64,
    model: Nominal,
    /// `|e_0|` \[rad\], after the first sample.
    first: Vec<f64>,
    latched: bool,
    wanted: Vec<f64>,
}

impl Rival for NonlinearFeedback {
    const CARD: Card = Card {
        id: "cnf",
        title: "Composite nonlinear feedback (Peng, Lin, Su)",
        reference: "[26]",
        source: "Peng, Lin, Su, IET Control Theory & Applications 3(6), 2009",
        grade: Grade::C,
        caveat: "the arm version was not found: textbook composite nonlinear feedback around computed torque. Unknown: \
            ρ(e), how the torque limits enter, the gains",
        law: "τ = M̂ (q̈_d − ω² e − 2ζ_0 ω ė + ρ(e) BᵀPx) + Ĉ q̇ + Ĝ + F̂ q̇",
        printed: Some(Ticks {
            quantitative: Tick::Partly,
            easy: Tick::Yes,
            optimal: Tick::No,
            model_free: Tick::No,
        }),
    };
    const SCALARS: &'static [Scalar] = &[
        ERROR_BANDWIDTH,
        Scalar {
            name: "damping",
            unit: "",
            meaning: "ζ_0 far from the reference",
            default: 0.4,
            low: 0.2,
            high: 1.0,
        },
        Scalar { name: "growth", unit: "", meaning: "β", default: 30.0, low: 3.0, high: 300.0 },
        Scalar { name: "shape", unit: "", meaning: "α", default: 2.0, low: 0.5, high: 8.0 },
        Scalar {
            name: "velocity_weight",
            unit: "",
            meaning: "W_2 of the Lyapunov equation",
            default: 30.0,
            low: 1.0,
            high: 300.0,
        },
    ];
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Nominal;

    fn new(tuning: &Tuning, model: Nominal) -> Result<Self, RivalRefusal> {
        let [omega, zeta, growth, shape, weight] = tuning.values()?;
        let linear = [omega * omega, 2.0 * zeta * omega];
        let wanted = vec![0.0; tuning.joints()];
        Ok(Self {
            linear,
            direction: Weighted::with(linear, [POSITION_WEIGHT, weight]),
            growth,
            shape,
            model,
            first: vec![FIRST_MIN; tuning.joints()],
            latched: false,
            wanted,
        })
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Acceleration<'_>,
        _: &[bool],
        tau: &mut [f64],
    ) {
        let [kp, kd] = self.linear;
        for (i, wanted) in self.wanted.iter_mut().enumerate() {
            let (e, de) = (sees.q[i] - wants.q[i], sees.dq[i] - wants.dq[i]);
            if !self.latched {
                self.first[i] = e.abs().max(FIRST_MIN);
            }
            let near = (-self.shape * e.abs() / self.first[i]).exp() - (-self.shape).exp();
            let rho = -self.growth * near.abs();
            *wanted = wants.ddq[i] - kp * e - kd * de + rho * self.direction.of(e, de);
        }
        self.latched = true;
        self.model.torque(sees.q, sees.dq, sees.dq, &self.wanted, tau);
    }

    fn states(&self) -> usize {
        self.first.len()
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let [omega, zeta, growth, shape, weight] = tuning.values().ok()?;
        let linear = [omega * omega, 2.0 * zeta * omega];
        let p22 = Weighted::with(linear, [POSITION_WEIGHT, weight]).on_rate;
        let gain = linear[1] + growth * (1.0 - (-shape).exp()) * p22;
        // The gain is on M̂ itself: every eigenvalue of M⁻¹M̂ is taken as 1.
        let arm = DeclaredArm { ratio: [1.0, 1.0], ..arm.clone() };
        let text = "(2ζ_0 ω + β (1 − e^−α) p_22) T < 2 with M̂ = M";
        Some(Condition::sampled(text, gain, tuning.period(), &arm))
    }
}

/// `W_1` \[1/s²\]
const POSITION_WEIGHT: f64 = 100.0;

/// Least `|e_0|` \[rad\]: a run may start on its reference.
const FIRST_MIN: f64 = 1e-3;
