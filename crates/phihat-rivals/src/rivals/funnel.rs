//! Funnel control for relative degree two: gains that grow where the error nears a given wall.

use crate::card::{Card, Grade};
use crate::claim::DeclaredArm;
use crate::error::RivalRefusal;
use crate::facts::Nothing;
use crate::measured::{MeasuredMotion, Velocity};
use crate::rival::Rival;
use crate::shared::DECAY;
use crate::tuning::{Scalar, Tuning};

/// Funnel control of Hackl and others.
///
/// # Law
///
/// ```text
/// τ = −κ_0 e/(ψ_0 − |e|)² − κ_1 ė/(ψ_1 − |ė|)                                          (1)
/// ψ_0 = r e^{−lt} + ψ_{0∞},    ψ_1 = (l r + 2 |ė(0)|) e^{−lt} + ψ_{1∞},    r = 2 |e(0)|
/// ```
///
/// so that `ψ_1 ≥ −ψ̇_0 + ψ_{1∞}` as the theorem asks; `r` is latched per joint at the start. Nearer to the wall
/// than a tenth of the funnel's width, and outside, the distance counts as a tenth; the promise is void from then on.
///
/// # Guarantee
///
/// In continuous time, with torque without a limit: `|e| < ψ_0(t)`, `|ė| < ψ_1(t)` for any arm.
///
/// # Not claimed
///
/// Anything with torque limits (there is a feasibility condition, which asks for bounds of the arm), sampled, or
/// noisy. There is no integral: a constant load keeps the error on its way to the wall.
///
/// # References
///
/// C. M. Hackl, N. Hopfe, A. Ilchmann, M. Mueller, S. Trenn, "Funnel control for systems with relative degree two",
/// SIAM J. Control Optim. 51(2), 2013: `τ = −k_0² e − k_1 ė`, `k_i = ς_i/(ψ_i − |e^{(i)}|)`. Grade A.
#[derive(Debug)]
pub(crate) struct Hackl {
    stiffness: Vec<f64>,
    damping: Vec<f64>,
    /// `ψ_{0∞}`, `ψ_{1∞}`
    ends: [f64; 2],
    decay: f64,
    keep: f64,
    /// Remainder of `ψ_0 − ψ_{0∞}` and of `ψ_1 − ψ_{1∞}` per joint.
    extra: Vec<[f64; 2]>,
    started: bool,
}

/// Least distance to the wall, as a share of the funnel's width.
const DISTANCE: f64 = 0.1;

impl Rival for Hackl {
    const CARD: Card = Card {
        id: "funnel-2013",
        title: "Funnel control (Hackl and others)",
        reference: "",
        source: "Hackl, Hopfe, Ilchmann, Mueller, Trenn, SIAM J. Control Optim. 51(2), 2013",
        grade: Grade::A,
        caveat: "",
        law: "τ = −κ₀ e/(ψ₀ − |e|)² − κ₁ ė/(ψ₁ − |ė|)",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[
        Scalar {
            name: "width",
            unit: "rad",
            meaning: "ψ_{0∞} around the error",
            default: 0.02,
            low: 0.002,
            high: 0.2,
        },
        Scalar {
            name: "rate_width",
            unit: "rad/s",
            meaning: "ψ_{1∞} around its rate",
            default: 0.5,
            low: 0.05,
            high: 5.0,
        },
        Scalar {
            name: "stiffness",
            unit: "rad²/s²",
            meaning: "κ₀ = ς₀²",
            default: 1.0,
            low: 0.1,
            high: 10.0,
        },
        Scalar {
            name: "damping",
            unit: "rad/s²",
            meaning: "κ₁ = ς₁",
            default: 20.0,
            low: 2.0,
            high: 200.0,
        },
        DECAY,
    ];
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Velocity<'a>;
    type Knows = Nothing;

    fn new(tuning: &Tuning, _: Nothing) -> Result<Self, RivalRefusal> {
        let [width, rate_width, stiffness, damping, decay] = tuning.values()?;
        Ok(Self {
            stiffness: tuning.per_joint(stiffness),
            damping: tuning.per_joint(damping),
            ends: [width, rate_width],
            decay,
            keep: (-decay * tuning.period()).exp(),
            extra: vec![[0.0; 2]; tuning.joints()],
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
        for (i, tau) in tau.iter_mut().enumerate() {
            let (e, de) = (sees.q[i] - wants.q[i], sees.dq[i] - wants.dq[i]);
            let extra = &mut self.extra[i];
            *extra = if self.started {
                extra.map(|x| x * self.keep)
            } else {
                let r = 2.0 * e.abs();
                [r, self.decay * r + 2.0 * de.abs()]
            };
            let [psi0, psi1] = [extra[0] + self.ends[0], extra[1] + self.ends[1]];
            let near = (psi0 - e.abs()).max(DISTANCE * psi0);
            let slow = (psi1 - de.abs()).max(DISTANCE * psi1);
            *tau = -self.stiffness[i] * e / (near * near) - self.damping[i] * de / slow;
        }
        self.started = true;
    }

    fn states(&self) -> usize {
        2 * self.extra.len()
    }

    fn bound(tuning: &Tuning, arm: &DeclaredArm) -> Option<Vec<f64>> {
        let [width, ..] = tuning.values::<5>().ok()?;
        Some(vec![width; arm.phi_max.len()])
    }
}

/// Funnel control of Berger, Ilchmann and Ryan.
///
/// # Law
///
/// ```text
/// w_1 = e/ψ,    w_2 = ϑ ė/ψ + w_1/(1 − w_1²),    τ = −K w_2/(1 − w_2²),    ψ = r e^{−lt} + ψ_∞     (1)
/// ```
///
/// `ϑ` \[s\] is the unit of time, 1 s in print. `r` is the least for which `|w_1|, |w_2| ≤ ½` at the start, latched
/// per joint. `|w_1|` and `|w_2|` count as at most 0.98; where one is larger the promise is void.
///
/// # Guarantee
///
/// In continuous time, with torque without a limit: `|e| < ψ(t)` for any arm.
///
/// # Not claimed
///
/// As for [`Hackl`].
///
/// # References
///
/// T. Berger, A. Ilchmann, E. P. Ryan, "Funnel control of nonlinear systems", Math. Control Signals Systems 33,
/// 2021. Grade A.
#[derive(Debug)]
pub(crate) struct Berger {
    gain: Vec<f64>,
    time: f64,
    end: f64,
    keep: f64,
    /// Remainder of `ψ − ψ_∞` \[rad\] per joint.
    extra: Vec<f64>,
    started: bool,
}

/// Largest `|w|` that is answered.
const WALL: f64 = 0.98;

/// `w/(1 − w²)` inside the wall.
fn steep(w: f64) -> f64 {
    let w = w.clamp(-WALL, WALL);
    w / (1.0 - w * w)
}

impl Berger {
    /// Width beyond the final one with which a start is well inside.
    fn wide_enough(&self, e: f64, de: f64) -> f64 {
        // |w_1| ≤ a and |ϑ ė|/ψ ≤ a give |w_2| ≤ a + a/(1 − a²) ≤ ½ for a = 0.24.
        (e.abs().max(self.time * de.abs()) / 0.24 - self.end).max(0.0)
    }
}

impl Rival for Berger {
    const CARD: Card = Card {
        id: "funnel-2021",
        title: "Funnel control (Berger, Ilchmann, Ryan)",
        reference: "",
        source: "Berger, Ilchmann, Ryan, Math. Control Signals Systems 33, 2021",
        grade: Grade::A,
        caveat: "",
        law: "τ = −K w₂/(1 − w₂²),  w₂ = ϑ ė/ψ + w₁/(1 − w₁²),  w₁ = e/ψ",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[
        Scalar {
            name: "width",
            unit: "rad",
            meaning: "ψ_∞ around the error",
            default: 0.05,
            low: 0.005,
            high: 0.5,
        },
        Scalar { name: "gain", unit: "1/s²", meaning: "K", default: 12.0, low: 1.2, high: 120.0 },
        Scalar {
            name: "time",
            unit: "s",
            meaning: "ϑ, what a rate counts against an error",
            default: 1.0,
            low: 0.02,
            high: 2.0,
        },
        DECAY,
    ];
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Velocity<'a>;
    type Knows = Nothing;

    fn new(tuning: &Tuning, _: Nothing) -> Result<Self, RivalRefusal> {
        let [end, gain, time, decay] = tuning.values()?;
        let (keep, extra) = ((-decay * tuning.period()).exp(), vec![0.0; tuning.joints()]);
        Ok(Self { gain: tuning.per_joint(gain), time, end, keep, extra, started: false })
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Velocity<'_>,
        _: &[bool],
        tau: &mut [f64],
    ) {
        for (i, tau) in tau.iter_mut().enumerate() {
            let (e, de) = (sees.q[i] - wants.q[i], sees.dq[i] - wants.dq[i]);
            let extra =
                if self.started { self.extra[i] * self.keep } else { self.wide_enough(e, de) };
            self.extra[i] = extra;
            let psi = extra + self.end;
            *tau = -self.gain[i] * steep(self.time * de / psi + steep(e / psi));
        }
        self.started = true;
    }

    fn states(&self) -> usize {
        self.extra.len()
    }

    fn bound(tuning: &Tuning, arm: &DeclaredArm) -> Option<Vec<f64>> {
        let [width, ..] = tuning.values::<4>().ok()?;
        Some(vec![width; arm.phi_max.len()])
    }
}
