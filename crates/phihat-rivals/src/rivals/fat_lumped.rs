//! Function approximation of everything that acts, as one torque per joint.

use crate::basis::{BASIS, Basis, sum};
use crate::card::{Card, Grade, Tick, Ticks};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::facts::{Inertia, Period};
use crate::math::Weighted;
use crate::measured::{Acceleration, MeasuredMotion};
use crate::rival::Rival;
use crate::shared::{ERROR_BANDWIDTH, LEAKAGE};
use crate::tuning::{Scalar, Tuning};

/// Function approximation without the sliding variable, in the class of Kai and Huang.
///
/// # Law
///
/// ```text
/// τ = M̄ (q̈_d − K_d ė − K_p e + Ŵ z(t)),     dŴ/dt = −g (p_12 e + p_22 ė) zᵀ − σ Ŵ        (1)
/// ```
///
/// `z` as of [`Fat`](super::fat::Fat). `p_12, p_22` solve the Lyapunov equation of `ë + K_d ė + K_p e = 0` for the
/// weights `q_1` of `e²` and 1 of `ė²`. `Ŵ(0) = 0`; it stands still while any joint's torque is limited.
///
/// # Guarantee
///
/// With `φ/M̄` exactly in the span of `z`, `σ = 0`: `V = xᵀPx + tr(W̃ᵀW̃)/g` with `x = (e, ė)`, `dV/dt = −xᵀQx`.
/// Otherwise the error is bounded.
///
/// # Not claimed
///
/// That `φ` is a function of time: it contains the inertia that the law itself accelerates.
///
/// # References
///
/// C.-Y. Kai, A.-C. Huang, "A regressor-free adaptive controller for robot manipulators without Slotine and Li's
/// modification", Robotica 31(7), 2013. Grade C: no public copy of the law was found. Public is what the title says,
/// and what Hayat, Leibold and Buss say of it in Table 1: orthogonal functions in place of the regressor. Unknown are
/// what is approximated apart (the authors' monograph of 2010 approximates inertia, Coriolis term and gravity each,
/// as [`Fat`](super::fat::Fat) does), the law that updates the weights, and the gains.
#[derive(Debug)]
pub(crate) struct FatLumped {
    outer: [f64; 2],
    direction: Weighted,
    rate: f64,
    leakage: f64,
    period: f64,
    inertia: Inertia,
    basis: Basis,
    weights: Vec<f64>,
}

impl Rival for FatLumped {
    const CARD: Card = Card {
        id: "fat-lumped",
        title: "Function approximation, lumped (Kai, Huang)",
        reference: "[2]",
        source: "Kai, Huang, Robotica 31(7), 2013",
        grade: Grade::C,
        caveat: "published law not found: the lumped unknown of plain PD error dynamics is approximated. Unknown: what \
            is approximated apart, the update law, the gains",
        law: "τ = M̄ (q̈_d − K_d ė − K_p e + Ŵ z),  dŴ/dt = −g BᵀPx zᵀ − σ Ŵ",
        printed: Some(Ticks {
            quantitative: Tick::No,
            easy: Tick::No,
            optimal: Tick::No,
            model_free: Tick::Yes,
        }),
    };
    const SCALARS: &'static [Scalar] = &[
        ERROR_BANDWIDTH,
        Scalar {
            name: "damping",
            unit: "",
            meaning: "ζ of the same, K_d = 2ζω",
            default: 1.0,
            low: 0.3,
            high: 3.0,
        },
        Scalar {
            name: "adaptation",
            unit: "1/s",
            meaning: "g",
            default: 1600.0,
            low: 160.0,
            high: 16000.0,
        },
        Scalar {
            name: "position_weight",
            unit: "1/s²",
            meaning: "q_1 of e² over that of ė²",
            default: 100.0,
            low: 10.0,
            high: 1000.0,
        },
        LEAKAGE,
    ];
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = (Inertia, Period);

    fn new(tuning: &Tuning, (inertia, task): (Inertia, Period)) -> Result<Self, RivalRefusal> {
        let [omega, zeta, rate, weight, leakage] = tuning.values()?;
        let outer = [omega * omega, 2.0 * zeta * omega];
        Ok(Self {
            outer,
            direction: Weighted::with(outer, [weight, 1.0]),
            rate,
            leakage,
            period: tuning.period(),
            weights: vec![0.0; tuning.joints() * BASIS],
            basis: Basis::new(task.seconds(), tuning.period()),
            inertia,
        })
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Acceleration<'_>,
        clipped: &[bool],
        tau: &mut [f64],
    ) {
        let [kp, kd] = self.outer;
        let (z, free) = (self.basis.next(), !clipped.contains(&true));
        let keep = 1.0 - self.leakage * self.period;
        for (i, (tau, w)) in tau.iter_mut().zip(self.weights.chunks_mut(BASIS)).enumerate() {
            let (e, de) = (sees.q[i] - wants.q[i], sees.dq[i] - wants.dq[i]);
            let wanted = wants.ddq[i] - kd * de - kp * e + sum(w, &z);
            *tau = self.inertia.values()[i] * wanted;
            if free {
                let step = self.period * self.rate * self.direction.of(e, de);
                w.iter_mut().zip(&z).for_each(|(w, z)| *w = keep * *w - step * z);
            }
        }
    }

    fn states(&self) -> usize {
        self.weights.len()
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let [omega, zeta, ..] = tuning.values::<5>().ok()?;
        let (gain, period) = (2.0 * zeta * omega, tuning.period());
        Some(Condition::sampled("K_d T below the smallest inertia's limit", gain, period, arm))
    }
}
