//! The adaptive controller of Slotine and Li.

use crate::adaptation::AdaptedEstimate;
use crate::card::{Card, Grade, Tick, Ticks};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::measured::{Acceleration, MeasuredMotion};
use crate::regressor::{ParameterGroup, Regressor};
use crate::rival::Rival;
use crate::shared::{ADAPTATION, LEAKAGE, SLIDING, SLIDING_DAMPING};
use crate::sliding::Sliding;
use crate::tuning::{Scalar, Tuning};

/// Passivity-based adaptive control.
///
/// # Law
///
/// With `s = ė + Λ e`, `q̇_r = q̇_d − Λ e`, `q̈_r = q̈_d − Λ ė`:
///
/// ```text
/// τ = Y(q, q̇, q̇_r, q̈_r) θ̂ − K_D s,     dθ̂/dt = −Γ Yᵀ s − σ θ̂,     θ̂(0) = 0              (1)
/// ```
///
/// `Y` has the identifiable columns only. `Γ` and `K_D` are per unit of the joint's inertia. The estimate stands
/// still while any joint's torque is limited.
///
/// # Guarantee
///
/// For `σ = 0`, continuous time and no disturbance, from anywhere: `V = ½ sᵀMs + ½ θ̃ᵀΓ⁻¹θ̃`,
/// `dV/dt = −sᵀ(K_D + F)s`, so that `e, ė → 0`. With leakage the error stays bounded.
///
/// # Not claimed
///
/// That the estimates find the parameters: only where the motion excites them. Dry friction has no column.
///
/// # References
///
/// J.-J. E. Slotine, W. Li, "On the adaptive control of robot manipulators", Int. J. Robotics Research 6(3), 1987.
/// Leakage: P. A. Ioannou, P. V. Kokotović, 1984. Grade A.
#[derive(Debug)]
pub(crate) struct SlotineLi {
    sliding: Sliding,
    gain: Vec<f64>,
    leakage: f64,
    period: f64,
    estimate: AdaptedEstimate,
}

impl SlotineLi {
    fn with(
        [sliding, damping, leakage]: [f64; 3],
        tuning: &Tuning,
        estimate: AdaptedEstimate,
    ) -> Self {
        Self {
            sliding: Sliding::new(sliding, tuning.joints()),
            gain: tuning.per_joint(damping),
            leakage,
            period: tuning.period(),
            estimate,
        }
    }
}

impl Rival for SlotineLi {
    const CARD: Card = Card {
        id: "slotine-li",
        title: "Adaptive (Slotine, Li)",
        reference: "[23]",
        source: "Slotine, Li, Int. J. Robotics Research 6(3), 1987",
        grade: Grade::A,
        caveat: "",
        law: "τ = Y θ̂ − K_D s,  dθ̂/dt = −Γ Yᵀ s − σ θ̂",
        printed: Some(Ticks {
            quantitative: Tick::No,
            easy: Tick::No,
            optimal: Tick::No,
            model_free: Tick::No,
        }),
    };
    const SCALARS: &'static [Scalar] = &[SLIDING, SLIDING_DAMPING, ADAPTATION, LEAKAGE];
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Regressor;

    fn new(tuning: &Tuning, regressor: Regressor) -> Result<Self, RivalRefusal> {
        let [sliding, damping, adaptation, leakage] = tuning.values()?;
        let estimate = AdaptedEstimate::new(regressor, tuning, adaptation);
        Ok(Self::with([sliding, damping, leakage], tuning, estimate))
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Acceleration<'_>,
        clipped: &[bool],
        tau: &mut [f64],
    ) {
        self.sliding.update(&sees, &wants);
        let Sliding { s, v, a, .. } = &self.sliding;
        self.estimate.torque(sees.q, sees.dq, v, a, tau);
        for (i, tau) in tau.iter_mut().enumerate() {
            *tau -= self.gain[i] * s[i];
        }
        if !clipped.contains(&true) {
            self.estimate.adapt(s, self.leakage, self.period);
        }
    }

    fn states(&self) -> usize {
        self.estimate.parameters()
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let [_, damping, ..] = tuning.values::<4>().ok()?;
        let period = tuning.period();
        Some(Condition::sampled("K_D T below the smallest inertia's limit", damping, period, arm))
    }
}

/// [`SlotineLi`] with a rate for the parameters of each unit: masses, first moments, inertias, friction.
///
/// # Law
///
/// As there, with `Γ = γ_g U_j` for a parameter of joint `j` and unit `g`. With all four rates alike it is
/// the same law, and a test checks that.
///
/// # References
///
/// J.-J. E. Slotine, W. Li, 1987: `Γ` is any positive definite matrix there. Grade A.
#[derive(Debug)]
pub(crate) struct ByUnit(SlotineLi);

/// Rate of the parameters of a unit.
const fn rate(name: &'static str, unit: &'static str, meaning: &'static str) -> Scalar {
    Scalar { name, unit, meaning, ..ADAPTATION }
}

impl Rival for ByUnit {
    const CARD: Card = Card {
        id: "slotine-li-units",
        title: "Adaptive (Slotine, Li), a rate per unit",
        reference: "",
        source: "Slotine, Li, Int. J. Robotics Research 6(3), 1987",
        grade: Grade::A,
        caveat: "",
        law: "τ = Y θ̂ − K_D s,  dθ̂/dt = −Γ Yᵀ s − σ θ̂,  Γ by unit: kg, kg·m, kg·m², N·m·s/rad",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[
        SLIDING,
        SLIDING_DAMPING,
        rate("adaptation_mass", "s²/m⁴", "γ of masses"),
        rate("adaptation_moment", "s²/m²", "γ of first moments"),
        rate("adaptation_inertia", "s²", "γ of inertias"),
        rate("adaptation_friction", "", "γ of viscous friction"),
        LEAKAGE,
    ];
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Regressor;

    fn new(tuning: &Tuning, regressor: Regressor) -> Result<Self, RivalRefusal> {
        let [sliding, damping, mass, moment, inertia, friction, leakage] = tuning.values()?;
        let gain = |group: ParameterGroup| match group {
            ParameterGroup::Mass => mass,
            ParameterGroup::Moment => moment,
            ParameterGroup::Inertia => inertia,
            ParameterGroup::Friction => friction,
        };
        let estimate = AdaptedEstimate::by_group(regressor, tuning, gain);
        Ok(Self(SlotineLi::with([sliding, damping, leakage], tuning, estimate)))
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Acceleration<'_>,
        clipped: &[bool],
        tau: &mut [f64],
    ) {
        self.0.update(sees, wants, clipped, tau);
    }

    fn states(&self) -> usize {
        self.0.states()
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let [_, damping, ..] = tuning.values::<7>().ok()?;
        let period = tuning.period();
        Some(Condition::sampled("K_D T below the smallest inertia's limit", damping, period, arm))
    }
}
