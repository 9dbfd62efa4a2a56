//! PID with feed-forward, as a user of an industrial drive would set it up.

use crate::card::{Card, Grade};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::facts::Inertia;
use crate::measured::{Acceleration, MeasuredMotion};
use crate::nominal::{Gravity, Viscous};
use crate::rival::Rival;
use crate::rivals::proposed::{BANDWIDTH, DAMPING, outer_gains};
use crate::shared::INTEGRAL_RATE;
use crate::tuning::{Scalar, Tuning};

/// PID of every joint with feed-forward of acceleration, viscous friction and gravity.
///
/// # Law
///
/// ```text
/// τ = M̄ q̈_d + F̂ q̇_d + Ĝ(q) − K_P e − K_D ė − K_I ∫e                                   (1)
/// K_P = U ω²,  K_D = 2 ζ ω U,  K_I = K_P/T_i
/// ```
///
/// The inertia is one number per joint, the friction the nominal one along the reference, gravity the nominal
/// model's at the measured posture, as arms with gravity compensation in their interface have it. The integral
/// stands still while its joint's torque is limited.
///
/// # Guarantee
///
/// Frozen inertia of ratio `μ` to `U`: stable for `K_D T/U < 2μ` (sampling; with delay less) and
/// `μ < 2 ζ ω T_i` (Routh).
///
/// # Not claimed
///
/// A bound on the error; a proof for the coupled arm.
///
/// # References
///
/// Textbook; B. Siciliano and others, "Robotics: Modelling, Planning and Control", 2009, section 8.3. Grade A.
#[derive(Debug)]
pub(crate) struct IndustrialPid {
    proportional: Vec<f64>,
    derivative: Vec<f64>,
    /// `K_I T` per joint.
    integral: Vec<f64>,
    inertia: Inertia,
    gravity: Gravity,
    viscous: Viscous,
    /// `K_I ∫e` \[N·m\] per joint.
    sums: Vec<f64>,
}

impl Rival for IndustrialPid {
    const CARD: Card = Card {
        id: "industrial-pid",
        title: "PID with feed-forward",
        reference: "",
        source: "textbook; Siciliano and others, Robotics, 2009, 8.3",
        grade: Grade::A,
        caveat: "",
        law: "τ = M̄ q̈_d + F̂ q̇_d + Ĝ(q) − K_P e − K_D ė − K_I ∫e",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[BANDWIDTH, DAMPING, INTEGRAL_RATE];
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = (Inertia, (Gravity, Viscous));

    fn new(tuning: &Tuning, knows: Self::Knows) -> Result<Self, RivalRefusal> {
        let [omega, zeta, rate] = tuning.values()?;
        let (inertia, (gravity, viscous)) = knows;
        let [kp, kd] = outer_gains(omega, zeta);
        Ok(Self {
            proportional: tuning.per_joint(kp),
            derivative: tuning.per_joint(kd),
            integral: tuning.per_joint(kp * rate * tuning.period()),
            inertia,
            gravity,
            viscous,
            sums: vec![0.0; tuning.joints()],
        })
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Acceleration<'_>,
        clipped: &[bool],
        tau: &mut [f64],
    ) {
        self.gravity.torque(sees.q, tau);
        for (i, tau) in tau.iter_mut().enumerate() {
            let (e, de) = (sees.q[i] - wants.q[i], sees.dq[i] - wants.dq[i]);
            if !clipped[i] {
                self.sums[i] += self.integral[i] * e;
            }
            *tau += self.inertia.values()[i] * wants.ddq[i]
                + self.viscous.values()[i] * wants.dq[i]
                - self.proportional[i] * e
                - self.derivative[i] * de
                - self.sums[i];
        }
    }

    fn states(&self) -> usize {
        self.sums.len()
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let [omega, zeta, rate] = tuning.values().ok()?;
        let kd = 2.0 * zeta * omega;
        let floor = arm.ratio_min(kd, tuning.period());
        let text = "2 ζ ω T/c < μ < 2 ζ ω T_i; c = 2, behind one sample of delay 1";
        Some(Condition::inside(text, arm.ratio, [floor, kd / rate]))
    }
}
