//! Prescribed performance control: a wall around the error that the torque defends.

use crate::card::{Card, Grade};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::facts::Nothing;
use crate::measured::{MeasuredMotion, Velocity};
use crate::rival::Rival;
use crate::shared::{DECAY, SURFACE};
use crate::tuning::{Scalar, Tuning};

/// Prescribed performance control.
///
/// # Law
///
/// ```text
/// s = ė + λ e,   ρ(t) = (ρ_0 − ρ_∞) e^{−lt} + ρ_∞,   ξ = s/ρ,   τ = −K ln((1 + ξ)/(1 − ξ))     (1)
/// ```
///
/// `ρ_0 = 2 |s(0)| + ρ_∞` is latched per joint at the start. Outside `|ξ| ≤ 0.999` the torque is that at 0.999,
/// `7.6 K`: no more is asked for at the wall, and the promise is void from then on.
///
/// # Guarantee
///
/// In continuous time, with torque without a limit, `|s| < ρ(t)` for all time and any arm, hence, with `l < λ`,
/// `|e| ≤ e^{−λt} |e(0)| + (ρ_0 − ρ_∞)(e^{−lt} − e^{−λt})/(λ − l) + ρ_∞/λ` and in the end `|e| ≤ ρ_∞/λ` (2).
///
/// # Not claimed
///
/// (2) with torque limits, noise at the wall, or sampling. The condition is the sampled one at the centre, where the
/// velocity gain is `2 K/ρ_∞`; it grows without bound towards the wall.
///
/// # References
///
/// C. P. Bechlioulis, M. V. Liarokapis, K. J. Kyriakopoulos, "Robust model free control of robotic manipulators
/// with prescribed transient and steady state performance", IROS 2014. Grade B: the law of the same first author.
#[derive(Debug)]
pub(crate) struct PrescribedPerformance {
    surface: f64,
    end: f64,
    /// `e^{−lT}`
    keep: f64,
    gain: Vec<f64>,
    /// `ρ(t) − ρ_∞` \[rad/s\] per joint.
    extra: Vec<f64>,
    started: bool,
}

/// Largest `|ξ|` that is answered.
const WALL: f64 = 0.999;

impl Rival for PrescribedPerformance {
    const CARD: Card = Card {
        id: "prescribed-performance",
        title: "Prescribed performance (Bechlioulis)",
        reference: "[35]",
        source: "Bechlioulis, Liarokapis, Kyriakopoulos, IROS 2014",
        grade: Grade::B,
        caveat: "the law of the same first author's public code; the paper's linear filters are not in it",
        law: "τ = −K ln((1 + ξ)/(1 − ξ)),  ξ = (ė + λ e)/ρ(t)",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[
        SURFACE,
        Scalar {
            name: "width",
            unit: "rad/s",
            meaning: "ρ_∞, where |s| shall stay in the end",
            default: 0.1,
            low: 0.01,
            high: 1.0,
        },
        DECAY,
        Scalar { name: "gain", unit: "1/s²", meaning: "K", default: 25.0, low: 2.5, high: 250.0 },
    ];
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Velocity<'a>;
    type Knows = Nothing;

    fn new(tuning: &Tuning, _: Nothing) -> Result<Self, RivalRefusal> {
        let [surface, end, decay, gain] = tuning.values()?;
        let (keep, extra) = ((-decay * tuning.period()).exp(), vec![0.0; tuning.joints()]);
        Ok(Self { surface, end, keep, gain: tuning.per_joint(gain), extra, started: false })
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Velocity<'_>,
        _: &[bool],
        tau: &mut [f64],
    ) {
        for (i, tau) in tau.iter_mut().enumerate() {
            let s = sees.dq[i] - wants.dq[i] + self.surface * (sees.q[i] - wants.q[i]);
            let extra = &mut self.extra[i];
            *extra = if self.started { *extra * self.keep } else { 2.0 * s.abs() };
            let xi = (s / (self.end + *extra)).clamp(-WALL, WALL);
            *tau = -self.gain[i] * ((1.0 + xi) / (1.0 - xi)).ln();
        }
        self.started = true;
    }

    fn states(&self) -> usize {
        self.extra.len()
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let [_, end, _, gain] = tuning.values().ok()?;
        let floor = arm.ratio_min(2.0 * gain / end, tuning.period());
        Some(Condition::above(
            "2K T/ρ_∞ < cμ; c = 2, behind one sample of delay 1",
            arm.ratio[0],
            floor,
        ))
    }

    fn bound(tuning: &Tuning, arm: &DeclaredArm) -> Option<Vec<f64>> {
        let [surface, end, _, _] = tuning.values().ok()?;
        Some(vec![end / surface; arm.phi_max.len()])
    }
}
