//! Adaptive control from positions alone.

use crate::adaptation::AdaptedEstimate;
use crate::card::{Card, Grade, Tick, Ticks};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::measured::{Acceleration, MeasuredPositions};
use crate::regressor::Regressor;
use crate::rival::Rival;
use crate::shared::{ADAPTATION, LEAKAGE};
use crate::tuning::{Scalar, Tuning};

/// Adaptive output feedback after Pagilla and Tomizuka.
///
/// # Law
///
/// With `f(e) = e/(1 + |e|)` and `Y_d = Y(q_d, q̇_d, q̇_d, q̈_d)`:
///
/// ```text
/// dq̂/dt = q̇_d + w + 2 p q̃,     dw/dt = p² q̃,     q̃ = q − q̂                             (1)
/// τ = Y_d θ̂ − K_P e − K_V (dq̂/dt − q̇_d + λ f(e))                                        (2)
/// θ̂ = −Γ [Y_dᵀ e + ∫(λ Y_dᵀ f(e) − Ẏ_dᵀ e + σ-leakage) dt]                               (3)
/// ```
///
/// (3) is `dθ̂/dt = −Γ Y_dᵀ(ė + λ f(e))` by parts, so that no velocity is in it; `Ẏ_d` is the difference of `Y_d` over
/// a sample, and `θ̂(0) = 0`. The integral stands still while any joint's torque is limited.
///
/// # Guarantee
///
/// Semi-global asymptotic stability is what the abstract states. The reconstruction has no proof of its own.
///
/// # Not claimed
///
/// A size of gains for a given initial error.
///
/// # References
///
/// R. P. Pagilla, M. Tomizuka, "An adaptive output feedback controller for robot arms: stability and experiments",
/// Automatica 37(7), 2001. Grade B: reconstructed after its abstract.
#[derive(Debug)]
pub(crate) struct OutputFeedback {
    lambda: f64,
    gain: [Vec<f64>; 2],
    /// `p`
    observer: f64,
    leakage: f64,
    period: f64,
    estimate: AdaptedEstimate,
    /// `Y_d` a sample ago.
    before: Vec<f64>,
    /// The integral of (3), one entry per parameter.
    integral: Vec<f64>,
    position: Vec<f64>,
    extra: Vec<f64>,
    started: bool,
    e: Vec<f64>,
}

impl Rival for OutputFeedback {
    const CARD: Card = Card {
        id: "output-feedback",
        title: "Adaptive output feedback (Pagilla, Tomizuka)",
        reference: "[28]",
        source: "Pagilla, Tomizuka, Automatica 37(7), 2001",
        grade: Grade::B,
        caveat: "observer and update are reconstructed after the abstract",
        law: "τ = Y_d θ̂ − K_P e − K_V (ê˙ + λ f(e)),  θ̂ = −Γ [Y_dᵀ e + ∫(λ Y_dᵀ f(e) − Ẏ_dᵀ e)]",
        printed: Some(Ticks {
            quantitative: Tick::No,
            easy: Tick::No,
            optimal: Tick::No,
            model_free: Tick::No,
        }),
    };
    const SCALARS: &'static [Scalar] = &[
        Scalar {
            name: "ratio",
            unit: "1/s",
            meaning: "λ, of position to velocity",
            default: 5.0,
            low: 0.5,
            high: 50.0,
        },
        Scalar {
            name: "stiffness",
            unit: "1/s²",
            meaning: "K_P",
            default: 400.0,
            low: 40.0,
            high: 4000.0,
        },
        Scalar {
            name: "damping",
            unit: "1/s",
            meaning: "K_V",
            default: 80.0,
            low: 8.0,
            high: 400.0,
        },
        Scalar {
            name: "observer",
            unit: "rad/s",
            meaning: "p, double pole of the observer",
            default: 100.0,
            low: 20.0,
            high: 400.0,
        },
        ADAPTATION,
        LEAKAGE,
    ];
    type Sees<'a> = MeasuredPositions<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Regressor;

    fn new(tuning: &Tuning, regressor: Regressor) -> Result<Self, RivalRefusal> {
        let [lambda, stiffness, damping, observer, adaptation, leakage] = tuning.values()?;
        let estimate = AdaptedEstimate::new(regressor, tuning, adaptation);
        let zero = vec![0.0; tuning.joints()];
        Ok(Self {
            lambda,
            gain: [tuning.per_joint(stiffness), tuning.per_joint(damping)],
            observer,
            leakage,
            period: tuning.period(),
            before: vec![0.0; estimate.y.len()],
            integral: vec![0.0; estimate.parameters()],
            estimate,
            position: zero.clone(),
            extra: zero.clone(),
            started: false,
            e: zero,
        })
    }

    fn update(
        &mut self,
        sees: MeasuredPositions<'_>,
        wants: Acceleration<'_>,
        clipped: &[bool],
        tau: &mut [f64],
    ) {
        for (i, e) in self.e.iter_mut().enumerate() {
            *e = sees.q[i] - wants.q[i];
        }
        self.estimate.torque(wants.q, wants.dq, wants.dq, wants.ddq, tau);
        self.adapt(clipped.contains(&true));
        if !self.started {
            self.position.copy_from_slice(sees.q);
            self.started = true;
        }
        let (p, h, y) = (self.observer, self.period, &self.estimate.y);
        for (i, tau) in tau.iter_mut().enumerate() {
            let row = y.chunks(self.estimate.theta.len()).nth(i).unwrap_or_default();
            *tau = row.iter().zip(&self.estimate.theta).map(|(y, theta)| y * theta).sum();
            let (e, off) = (self.e[i], sees.q[i] - self.position[i]);
            let rate = self.extra[i] + 2.0 * p * off;
            *tau -= self.gain[0][i] * e + self.gain[1][i] * (rate + self.lambda * squash(e));
            self.position[i] += h * (wants.dq[i] + rate);
            self.extra[i] += h * p * p * off;
        }
    }

    fn states(&self) -> usize {
        2 * self.e.len() + self.integral.len()
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let [_, _, damping, ..] = tuning.values::<6>().ok()?;
        let period = tuning.period();
        Some(Condition::sampled("K_V T below the smallest inertia's limit", damping, period, arm))
    }
}

impl OutputFeedback {
    /// (3), from `Y_d` now and a sample ago.
    fn adapt(&mut self, frozen: bool) {
        let p = self.integral.len();
        for k in 0..p {
            let (mut now, mut slope) = (0.0, 0.0);
            for (i, e) in self.e.iter().enumerate() {
                let (y, before) = (self.estimate.y[i * p + k], self.before[i * p + k]);
                now += y * e;
                slope += self.period * self.lambda * y * squash(*e) - (y - before) * e;
            }
            if !self.started {
                self.integral[k] = -now;
            } else if !frozen {
                let leak = self.leakage * self.estimate.theta[k] / self.estimate.rate[k];
                self.integral[k] += slope + self.period * leak;
            }
            self.estimate.theta[k] = -self.estimate.rate[k] * (now + self.integral[k]);
        }
        self.before.copy_from_slice(&self.estimate.y);
    }
}

/// `f(e) = e/(1 + |e|)`
fn squash(e: f64) -> f64 {
    e / (1.0 + e.abs())
}
