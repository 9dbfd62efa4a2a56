//! Wang's adaptive controller in task space: neither kinematics nor dynamics are known.

use crate::adaptation::AdaptedEstimate;
use crate::card::{Card, Grade, Tick, Ticks};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::measured::{Acceleration, MeasuredMotion};
use crate::planar::{LINKS, Planar, Tip, running};
use crate::regressor::Regressor;
use crate::rival::Rival;
use crate::rivals::slotine_li::SlotineLi;
use crate::shared::ADAPTATION;
use crate::tuning::{Scalar, Tuning};

/// Adaptive control with uncertain kinematics and dynamics, of a planar arm with three joints.
///
/// # Law
///
/// `Δx = x − x_d` of the measured tip, `Ĵ` the Jacobian with estimated lengths `l̂`,
/// `Ĵ q̇ = Z(q, q̇) l̂ + (0, 0, ω_3)`:
///
/// ```text
/// q̇_r = Ĵ⁻¹ (ẋ_d − α Δx),   q̈_r = Ĵ⁻¹ (ẍ_d − α Δẋ − (dĴ/dt) q̇_r),   s = q̇ − q̇_r       (1)
/// τ = Y(q, q̇, q̇_r, q̈_r) θ̂ − K s,   dθ̂/dt = −Γ Yᵀ s,   dl̂/dt = Γ_k Zᵀ Δx                 (2)
/// ```
///
/// # Guarantee
///
/// Without disturbance and away from singular postures: the dynamic loop alone gives `s ∈ L_2`; with
/// `V = ½ |Δx|² + ½ l̃ᵀΓ_k⁻¹l̃`, `dV/dt = −α |Δx|² + Δxᵀ Ĵ s`, so that `Δx → 0`.
///
/// # Not claimed
///
/// Anything where the first two links are in line, as at the paper's start: there `|sin(φ_2 − φ_1)|` is held at 0.05,
/// which is no part of the law. Both estimates stand still while a torque is limited. `θ̂` leaks at 0.01 1/s.
///
/// # References
///
/// H. Wang, "Adaptive control of robot manipulators with uncertain kinematics and dynamics", IEEE Trans. Automatic
/// Control 62(2), 2017 (arXiv 1403.5204). Grade B: reconstructed from the abstract, with the proof above.
#[derive(Debug)]
pub(crate) struct TaskSpace {
    rate: f64,
    lengths_rate: f64,
    gain: Vec<f64>,
    period: f64,
    arm: Planar,
    lengths: [f64; LINKS],
    /// `dl̂/dt` of the last sample, which `dĴ/dt` contains \[m/s\].
    lengths_slope: [f64; LINKS],
    estimate: AdaptedEstimate,
}

/// Leakage of `θ̂` \[1/s\].
const LEAKAGE: f64 = 0.01;
/// Smallest `|sin(φ_2 − φ_1)|` that is divided by.
const SINGULAR: f64 = 0.05;
/// Largest factor between a length and its first estimate, either way.
const BELIEF: f64 = 3.0;

impl Rival for TaskSpace {
    const CARD: Card = Card {
        id: "task-space",
        title: "Adaptive, uncertain kinematics (Wang)",
        reference: "[29]",
        source: "Wang, IEEE T-AC 62(2), 2017",
        grade: Grade::B,
        caveat: "reconstructed from the abstract; planar arms of three joints only",
        law: "τ = Y θ̂ − K s,  s = q̇ − Ĵ⁻¹(ẋ_d − α Δx),  dθ̂/dt = −Γ Yᵀ s,  dl̂/dt = Γ_k Zᵀ Δx",
        printed: Some(Ticks {
            quantitative: Tick::Partly,
            easy: Tick::No,
            optimal: Tick::No,
            model_free: Tick::No,
        }),
    };
    const SCALARS: &'static [Scalar] = &[
        Scalar {
            name: "task_rate",
            unit: "1/s",
            meaning: "α, of the tip's error",
            default: 10.0,
            low: 1.0,
            high: 100.0,
        },
        Scalar {
            name: "damping",
            unit: "1/s",
            meaning: "K of s",
            default: 160.0,
            low: 16.0,
            high: 800.0,
        },
        ADAPTATION,
        Scalar {
            name: "length_adaptation",
            unit: "",
            meaning: "Γ_k, of the lengths",
            default: 5.0,
            low: 0.5,
            high: 50.0,
        },
    ];
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = (Regressor, Planar);

    fn new(tuning: &Tuning, (regressor, arm): (Regressor, Planar)) -> Result<Self, RivalRefusal> {
        let [rate, damping, adaptation, lengths_rate] = tuning.values()?;
        Ok(Self {
            rate,
            lengths_rate,
            gain: tuning.per_joint(damping),
            period: tuning.period(),
            lengths: arm.believed(),
            lengths_slope: [0.0; LINKS],
            arm,
            estimate: AdaptedEstimate::new(regressor, tuning, adaptation),
        })
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Acceleration<'_>,
        clipped: &[bool],
        tau: &mut [f64],
    ) {
        let [x, dx] = self.arm.tip(sees.q, sees.dq);
        let [x_d, dx_d, ddx_d] = self.arm.motion(wants.q, wants.dq, wants.ddq);
        let (phi, omega) = (self.arm.angles(sees.q), running(sees.dq));
        let e: Tip = core::array::from_fn(|k| x[k] - x_d[k]);
        let wanted: Tip = core::array::from_fn(|k| dx_d[k] - self.rate * e[k]);
        let nu = self.rates(&phi, wanted);
        let drift = self.drift(&phi, &omega, &nu);
        let slope: Tip =
            core::array::from_fn(|k| ddx_d[k] - self.rate * (dx[k] - dx_d[k]) - drift[k]);
        let (v, a) = (relative(nu), relative(self.rates(&phi, slope)));
        let s: [f64; LINKS] = core::array::from_fn(|i| sees.dq[i] - v[i]);
        self.estimate.torque(sees.q, sees.dq, &v, &a, tau);
        for (i, tau) in tau.iter_mut().enumerate() {
            *tau -= self.gain[i] * s[i];
        }
        self.lengths_slope = [0.0; LINKS];
        if !clipped.contains(&true) {
            self.estimate.adapt(&s, LEAKAGE, self.period);
            self.learn(&phi, &omega, &e);
        }
    }

    fn states(&self) -> usize {
        self.estimate.parameters() + LINKS
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        SlotineLi::condition(tuning, arm)
    }
}

impl TaskSpace {
    /// Angular velocities against the base whose tip velocity is `x`, with the lengths believed in.
    fn rates(&self, phi: &[f64; LINKS], x: Tip) -> [f64; LINKS] {
        let [l1, l2, l3] = self.lengths;
        let (s3, c3) = phi[2].sin_cos();
        let (bx, by) = (x[0] + l3 * s3 * x[2], x[1] - l3 * c3 * x[2]);
        let ((s1, c1), (s2, c2)) = (phi[0].sin_cos(), phi[1].sin_cos());
        let sine = s2 * c1 - c2 * s1;
        let sine = sine.abs().max(SINGULAR).copysign(sine);
        // The two links' columns are l_i (−sin φ_i, cos φ_i).
        [(bx * c2 + by * s2) / (l1 * sine), -(bx * c1 + by * s1) / (l2 * sine), x[2]]
    }

    /// `(dĴ/dt) q̇_r`, with `ν` the angular velocities against the base of `q̇_r`.
    fn drift(&self, phi: &[f64; LINKS], omega: &[f64; LINKS], nu: &[f64; LINKS]) -> Tip {
        let mut drift = [0.0; LINKS];
        for i in 0..LINKS {
            let (sin, cos) = phi[i].sin_cos();
            let (grown, turned) = (self.lengths_slope[i], self.lengths[i] * omega[i]);
            drift[0] -= (grown * sin + turned * cos) * nu[i];
            drift[1] += (grown * cos - turned * sin) * nu[i];
        }
        drift
    }

    /// `dl̂/dt = Γ_k Zᵀ Δx` over one period.
    fn learn(&mut self, phi: &[f64; LINKS], omega: &[f64; LINKS], e: &Tip) {
        let first = self.arm.believed();
        for i in 0..LINKS {
            let (sin, cos) = phi[i].sin_cos();
            self.lengths_slope[i] = self.lengths_rate * omega[i] * (cos * e[1] - sin * e[0]);
            let grown = self.lengths[i] + self.period * self.lengths_slope[i];
            self.lengths[i] = grown.clamp(first[i] / BELIEF, first[i] * BELIEF);
        }
    }
}

/// Joint velocities of angular velocities against the base.
fn relative(nu: [f64; LINKS]) -> [f64; LINKS] {
    [nu[0], nu[1] - nu[0], nu[2] - nu[1]]
}
