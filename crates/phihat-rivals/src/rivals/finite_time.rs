//! Backstepping with powers below one and an attenuation level.

use crate::card::{Card, Grade, Tick, Ticks};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::measured::{Acceleration, MeasuredMotion};
use crate::nominal::Nominal;
use crate::rival::Rival;
use crate::tuning::{Scalar, Tuning};

/// Finite-time H∞ backstepping, in the class of Liu, Tian, Wang and Zhang.
///
/// # Law
///
/// With `⌊x⌋ = x (|x| + ε)^(r − 1)`, a power `r < 1` that is smooth at zero:
///
/// ```text
/// α = q̇_d − k_1 ⌊e⌋,     z = q̇ − α                                                      (1)
/// τ = M̂ dα/dt + Ĉ α + Ĝ + F̂ α − U e − k_2 U ⌊z⌋ − (1/(2γ²) + ½) U z                     (2)
/// ```
///
/// `dα/dt` is the derivative of (1) itself. `U e` has the unit 1/s² in it.
///
/// # Guarantee
///
/// With an exact model and `V = ½ eᵀUe + ½ zᵀMz`, for every joint's sum
///
/// ```text
/// dV/dt ≤ −k_1 Σ U e⌊e⌋ − k_2 Σ U z⌊z⌋ − ½ Σ U z² + ½ γ² Σ d²/U                         (3)
/// ```
///
/// so the L2 gain from the torque disturbance `d` to `z` is at most `γ`, both per unit of inertia. Without
/// disturbance and for `ε → 0` the error is zero after a finite time.
///
/// # Not claimed
///
/// Optimality; finite time for `ε > 0`, which leaves exponential convergence near zero.
///
/// # References
///
/// H. Liu, X. Tian, G. Wang, T. Zhang, "Finite-time H∞ control for high-precision tracking in robotic manipulators
/// using backstepping control", IEEE Trans. Industrial Electronics 63(9), 2016. Grade C: no public copy of the law
/// was found. The two claims of (3), finite time and an L2 gain of at most `γ`, are also those of an open paper on
/// the same subject, "Robust finite-time tracking control for robotic manipulators with time delay estimation",
/// Mathematics 8(2), 165, 2020, <https://doi.org/10.3390/math8020165>, by its abstract. Unknown are the powers, the
/// storage function, how the derivative of the power is bounded at zero, and the gains.
#[derive(Debug)]
pub(crate) struct FiniteTime {
    rates: [f64; 2],
    power: f64,
    smooth: f64,
    /// `1/(2γ²) + ½`
    damping: f64,
    units: Vec<f64>,
    model: Nominal,
    alpha: [Vec<f64>; 2],
}

impl Rival for FiniteTime {
    const CARD: Card = Card {
        id: "finite-time",
        title: "Finite-time H∞ backstepping (Liu et al.)",
        reference: "[44]",
        source: "Liu, Tian, Wang, Zhang, IEEE T-IE 63(9), 2016",
        grade: Grade::C,
        caveat: "published law not found: derived in its class, with the power made smooth at zero in the law and in \
            its derivative alike. Unknown: the powers, the storage function, the gains",
        law: "τ = M̂ dα/dt + Ĉ α + Ĝ + F̂ α − U e − k_2 U ⌊z⌋ − (1/(2γ²) + ½) U z",
        printed: Some(Ticks {
            quantitative: Tick::Yes,
            easy: Tick::No,
            optimal: Tick::Yes,
            model_free: Tick::No,
        }),
    };
    const SCALARS: &'static [Scalar] = &[
        Scalar {
            name: "position_rate",
            unit: "rad^(1−r)/s",
            meaning: "k_1",
            default: 10.0,
            low: 1.0,
            high: 100.0,
        },
        Scalar {
            name: "velocity_rate",
            unit: "(rad/s)^(1−r)/s",
            meaning: "k_2",
            default: 40.0,
            low: 4.0,
            high: 400.0,
        },
        Scalar {
            name: "power",
            unit: "",
            meaning: "r, below 1",
            default: 0.7,
            low: 0.5,
            high: 0.95,
        },
        Scalar {
            name: "attenuation",
            unit: "s^½",
            meaning: "γ, per unit of inertia",
            default: 0.1,
            low: 0.03,
            high: 1.0,
        },
        Scalar {
            name: "smoothing",
            unit: "rad, rad/s",
            meaning: "ε",
            default: 0.01,
            low: 1e-3,
            high: 0.1,
        },
    ];
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Nominal;

    fn new(tuning: &Tuning, model: Nominal) -> Result<Self, RivalRefusal> {
        let [first, second, power, gamma, smooth] = tuning.values()?;
        if power >= 1.0 {
            return Err(RivalRefusal::Tuning(format!("power {power}: below 1 is valid")));
        }
        let zero = vec![0.0; tuning.joints()];
        Ok(Self {
            rates: [first, second],
            power,
            smooth,
            damping: 0.5 / (gamma * gamma) + 0.5,
            units: tuning.units().to_vec(),
            model,
            alpha: [zero.clone(), zero],
        })
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Acceleration<'_>,
        _: &[bool],
        tau: &mut [f64],
    ) {
        let ([k1, k2], r, smooth) = (self.rates, self.power, self.smooth);
        let [alpha, slope] = &mut self.alpha;
        for i in 0..alpha.len() {
            let (e, de) = (sees.q[i] - wants.q[i], sees.dq[i] - wants.dq[i]);
            let size = e.abs() + smooth;
            alpha[i] = wants.dq[i] - k1 * e * size.powf(r - 1.0);
            // d⌊e⌋/de = (|e| + ε)^(r − 2) (r |e| + ε)
            slope[i] = wants.ddq[i] - k1 * size.powf(r - 2.0) * (r * e.abs() + smooth) * de;
        }
        self.model.torque(sees.q, sees.dq, alpha, slope, tau);
        for (i, tau) in tau.iter_mut().enumerate() {
            let (e, z) = (sees.q[i] - wants.q[i], sees.dq[i] - alpha[i]);
            let power = z * (z.abs() + smooth).powf(r - 1.0);
            *tau -= self.units[i] * (e + k2 * power + self.damping * z);
        }
    }

    fn states(&self) -> usize {
        0
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let [_, second, power, gamma, smooth] = tuning.values().ok()?;
        let gain = second * smooth.powf(power - 1.0) + 0.5 / (gamma * gamma) + 0.5;
        let text = "(k_2 ε^(r−1) + 1/(2γ²) + ½) T below the smallest inertia's limit";
        Some(Condition::sampled(text, gain, tuning.period(), arm))
    }
}
