//! The authors' earlier law: the estimator also hears the error.

use crate::card::{Card, Grade};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::facts::Inertia;
use crate::lumped::Lumped;
use crate::math::Weighted;
use crate::measured::{Acceleration, MotionAndTorque};
use crate::rival::Rival;
use crate::rivals::proposed::{BANDWIDTH, DAMPING, error_by_peak_gains, outer_gains};
use crate::tuning::{Scalar, Tuning};

/// The law of order 1 with a term of the error in its estimator.
///
/// # Law
///
/// ```text
/// τ = M̄ (q̈_d − K_d ė − K_p e) + φ̂,    φ̂˙ = −a_0 (φ̂ − φ) − Γ M̄ BᵀP x,    x = (e, ė)        (1)
/// ```
///
/// `P` solves `AᵀP + PA = −diag(100 1/s², 1)` for the error dynamics. `Γ = 0` is the law of 2018.
///
/// # Guarantee
///
/// With `φ̃ = (φ̂ − φ)/M̄` and `V = ½ xᵀPx + φ̃²/(2Γ)` per joint, `V̇ = −½ xᵀQx − a_0 φ̃²/Γ − φ̃ φ̇/(M̄ Γ)`:
/// input-to-state stable from `φ̇` for any `a_0, Γ > 0`, `φ` treated as acting from outside. For frozen
/// inertia of ratio `μ`, with `BᵀPx = b_e e + b_d ė`, the characteristic polynomial is (2) and its window as
/// for order 1; its peak gains bound the error likewise.
///
/// ```text
/// μ s³ + (K_d + a_0) s² + (K_p + a_0 K_d + Γ b_d) s + a_0 K_p + Γ b_e                  (2)
/// ```
///
/// # Not claimed
///
/// That this is the law of 2016: its function of the error was not found. (1) has the one that closes the proof.
///
/// # References
///
/// R. Hayat, M. Buss, "Model identification for robot manipulators using regressor-free adaptive control", UKACC
/// Control 2016. Grade C.
#[derive(Debug)]
pub(crate) struct HayatBuss2016 {
    kp: f64,
    kd: f64,
    /// `Γ T BᵀP`
    correction: Weighted,
    inertia: Vec<f64>,
    lumped: Lumped,
}

/// `c` of (2) at `μ = 1`, from that of `s⁰`.
fn closed_loop(tuning: &Tuning) -> Option<[f64; 3]> {
    let [omega, zeta, a0, gamma] = tuning.values().ok()?;
    let [kp, kd] = outer_gains(omega, zeta);
    let b = Weighted::new(kp, kd);
    Some([a0 * kp + gamma * b.on_error, kp + a0 * kd + gamma * b.on_rate, kd + a0])
}

impl Rival for HayatBuss2016 {
    const CARD: Card = Card {
        id: "hayat-buss-2016",
        title: "Hayat, Buss 2016 (class)",
        reference: "[15]",
        source: "Hayat, Buss, UKACC Control 2016",
        grade: Grade::C,
        caveat: "the function of the error in the estimator was not found; this one closes the proof",
        law: "τ = M̄ (q̈_d − K_d ė − K_p e) + φ̂,  φ̂˙ = −a₀ (φ̂ − φ) − Γ M̄ BᵀP x",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[
        BANDWIDTH,
        DAMPING,
        Scalar {
            name: "estimator_bandwidth",
            unit: "rad/s",
            meaning: "a₀",
            default: 69.6,
            low: 7.0,
            high: 700.0,
        },
        Scalar {
            name: "correction",
            unit: "1/s²",
            meaning: "Γ of the error's part",
            default: 20.0,
            low: 2.0,
            high: 2e4,
        },
    ];
    type Sees<'a> = MotionAndTorque<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Inertia;

    fn new(tuning: &Tuning, inertia: Inertia) -> Result<Self, RivalRefusal> {
        let [omega, zeta, a0, gamma] = tuning.values()?;
        let [kp, kd] = outer_gains(omega, zeta);
        let Weighted { on_error, on_rate } = Weighted::new(kp, kd);
        let step = gamma * tuning.period();
        let correction = Weighted { on_error: step * on_error, on_rate: step * on_rate };
        let lumped = Lumped::new(inertia.values(), a0, tuning.period());
        Ok(Self { kp, kd, correction, inertia: inertia.values().to_vec(), lumped })
    }

    fn update(
        &mut self,
        sees: MotionAndTorque<'_>,
        wants: Acceleration<'_>,
        _: &[bool],
        tau: &mut [f64],
    ) {
        let phi = self.lumped.advance(sees);
        for (i, tau) in tau.iter_mut().enumerate() {
            let m = self.inertia[i];
            let (e, de) = (sees.q[i] - wants.q[i], sees.dq[i] - wants.dq[i]);
            phi[i] -= m * self.correction.of(e, de);
            *tau = m * (wants.ddq[i] - self.kd * de - self.kp * e) + phi[i];
        }
    }

    fn states(&self) -> usize {
        self.lumped.states()
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let c = closed_loop(tuning)?;
        let window = [arm.ratio_min(c[2], tuning.period()), c[2] * c[1] / c[0]];
        let text = "(K_d + a₀)T/c < μ < c₂c₁/c₀ of (2); c = 2, behind one sample of delay 1";
        Some(Condition::inside(text, arm.ratio, window))
    }

    fn bound(tuning: &Tuning, arm: &DeclaredArm) -> Option<Vec<f64>> {
        error_by_peak_gains(1, &closed_loop(tuning)?, tuning, arm)
    }
}
