//! Incremental nonlinear dynamic inversion: torque and acceleration through one filter.

use crate::card::{Card, Grade};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::facts::Inertia;
use crate::filter::{LowPass, Passed};
use crate::measured::{Acceleration, MotionAndTorque};
use crate::rival::Rival;
use crate::rivals::proposed::{BANDWIDTH, DAMPING, outer_gains};
use crate::rivals::time_delay::INERTIA_SHARE;
use crate::tuning::{Scalar, Tuning};

/// Incremental nonlinear dynamic inversion (INDI) of every joint.
///
/// # Law
///
/// With `ν = q̈_d − K_d ė − K_p e` and one filter `H(s) = ω_f²/(s² + 2 ζ_f ω_f s + ω_f²)`:
///
/// ```text
/// τ = τ_f + M̄ (ν − q̈_f),     τ_f = H τ_applied,     q̈_f = H (q̇_k − q̇_{k−1})/T              (1)
/// ```
///
/// `τ_applied` is the torque that acted while `q̇` changed: both signals are of the same interval, whatever
/// the delay, and are late by the same filter. What `H` lets through of `τ_applied − M̄ q̈` is all that is
/// known of the arm's dynamics.
///
/// # Guarantee
///
/// Frozen inertia of ratio `μ` to `M̄`, in continuous time, of `H` and the loop:
///
/// ```text
/// μ s² (s² + 2 ζ_f ω_f s + ω_f²) + (K_d s + K_p)(s² + 2 ζ_f ω_f s + ω_f²) − (μ − 1) ω_f² s²      (2)
/// ```
///
/// and the upper end of the window is where (2) is no longer Hurwitz; the lower end, by sampling and delay,
/// is that of the velocity gain `K_d + ω_f/(2 ζ_f)`, `1/(s + …)` being what `H/(1 − H)` is for slow signals.
///
/// # Not claimed
///
/// The window's lower end to the digit: the filter turns the phase of what goes through it. A bound on the error.
///
/// # References
///
/// E. J. J. Smeur, Q. Chu, G. C. H. E. de Croon, "Adaptive incremental nonlinear dynamic inversion for
/// attitude control of micro air vehicles", J. Guidance, Control, and Dynamics 39(3), 2016 (filter of 50
/// rad/s, damping 0.55); S. Sieberling, Q. P. Chu, J. A. Mulder, J. Guidance, Control, and Dynamics
/// 33(6), 2010. There the inverted matrix is that of the actuators; here it is one nominal inertia per joint.
/// Grade A.
#[derive(Debug)]
pub(crate) struct Incremental {
    kp: f64,
    kd: f64,
    inertia: Vec<f64>,
    filter: LowPass,
    /// Of the torque that acted and of the acceleration, per joint.
    passed: Vec<[Passed; 2]>,
    dq: Vec<f64>,
    started: bool,
    period: f64,
}

impl Rival for Incremental {
    const CARD: Card = Card {
        id: "indi",
        title: "Incremental dynamic inversion (INDI)",
        reference: "",
        source: "Smeur, Chu, de Croon, J. Guidance Control Dyn. 39(3), 2016",
        grade: Grade::A,
        caveat: "",
        law: "τ = H τ_applied + M̄ (q̈_d − K_d ė − K_p e − H q̈),  H = ω_f²/(s² + 2 ζ_f ω_f s + ω_f²)",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[
        BANDWIDTH,
        DAMPING,
        Scalar {
            name: "filter",
            unit: "rad/s",
            meaning: "ω_f of H",
            default: 50.0,
            low: 5.0,
            high: 1000.0,
        },
        Scalar {
            name: "filter_damping",
            unit: "",
            meaning: "ζ_f of H",
            default: 0.55,
            low: 0.2,
            high: 3.0,
        },
        Scalar { default: 1.0, ..INERTIA_SHARE },
    ];
    type Sees<'a> = MotionAndTorque<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Inertia;

    fn new(tuning: &Tuning, inertia: Inertia) -> Result<Self, RivalRefusal> {
        let [omega, zeta, cutoff, damping, share] = tuning.values()?;
        let [kp, kd] = outer_gains(omega, zeta);
        let inertia: Vec<f64> = inertia.values().iter().map(|inertia| share * inertia).collect();
        let n = inertia.len();
        Ok(Self {
            kp,
            kd,
            inertia,
            filter: LowPass::new(cutoff, damping, tuning.period()),
            passed: vec![[[0.0; 2]; 2]; n],
            dq: vec![0.0; n],
            started: false,
            period: tuning.period(),
        })
    }

    fn update(
        &mut self,
        sees: MotionAndTorque<'_>,
        wants: Acceleration<'_>,
        _: &[bool],
        tau: &mut [f64],
    ) {
        for (i, tau) in tau.iter_mut().enumerate() {
            let m = self.inertia[i];
            let (mut acted, mut ddq) = (0.0, 0.0);
            if self.started {
                let [of_torque, of_motion] = &mut self.passed[i];
                acted = self.filter.pass(of_torque, sees.tau[i]);
                ddq = self.filter.pass(of_motion, (sees.dq[i] - self.dq[i]) / self.period);
            }
            self.dq[i] = sees.dq[i];
            let (e, de) = (sees.q[i] - wants.q[i], sees.dq[i] - wants.dq[i]);
            *tau = acted + m * (wants.ddq[i] - self.kd * de - self.kp * e - ddq);
        }
        self.started = true;
    }

    fn states(&self) -> usize {
        5 * self.dq.len()
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let [omega, zeta, w, damping, share] = tuning.values().ok()?;
        let [kp, kd] = outer_gains(omega, zeta);
        let floor = arm.ratio_min(kd + 0.5 * w / damping, tuning.period());
        let window = [share * floor, share * ceiling([kp, kd], [w * w, 2.0 * damping * w])];
        let text =
            "(K_d + ω_f/(2 ζ_f)) T/c < μ, and (2) Hurwitz; c = 2, behind one sample of delay 1";
        Some(Condition::inside(text, arm.ratio, window))
    }
}

/// The largest `μ` at which (2) is Hurwitz, by Routh's criterion on
/// `μ s⁴ + (μ b + K_d) s³ + (K_p + b K_d + c) s² + (c K_d + b K_p) s + c K_p`, `b = 2 ζ_f ω_f`, `c = ω_f²`:
///
/// ```text
/// c_3 c_2 c_1 > c_3² c_0 + μ c_1²,     c_3 = μ b + K_d                                   (3)
/// ```
///
/// a parabola in `μ` that opens downwards: its larger root.
fn ceiling([kp, kd]: [f64; 2], [c, b]: [f64; 2]) -> f64 {
    let (c2, c1, c0) = (kp + b * kd + c, c * kd + b * kp, c * kp);
    // −b² c_0 μ² + (b c_2 c_1 − 2 b K_d c_0 − c_1²) μ + K_d c_2 c_1 − K_d² c_0 = 0
    let (x2, x1, x0) =
        (b * b * c0, b * c2 * c1 - 2.0 * b * kd * c0 - c1 * c1, kd * (c2 * c1 - kd * c0));
    let root = (x1 * x1 + 4.0 * x2 * x0).max(0.0).sqrt();
    (x1 + root) / (2.0 * x2)
}
