//! Time-delay control with nonlinear error dynamics and a correction of its estimate.

use crate::card::{Card, Grade};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::facts::Inertia;
use crate::math::sig;
use crate::measured::{Acceleration, MotionAndCommand};
use crate::rival::Rival;
use crate::rivals::time_delay::{DelayRest, INERTIA_SHARE};
use crate::tuning::{Scalar, Tuning};

/// Inclusive and enhanced time-delay control.
///
/// # Law
///
/// ```text
/// D = K_D sig(ė)^{α₂} + K_P sig(e)^{α₁},   α₂ = 2 α₁/(1 + α₁)                          (1)
/// S = ė − ė(0) + ∫D dt                                                                 (2)
/// u = q̈_d − D − K_S sig(S)^{α₃},   τ = M̄ u + τ_{k−1} − M̄ (q̇_k − q̇_{k−1})/T             (3)
/// ```
///
/// `∫D` stands still while its joint's torque is limited. `α₁ = 1` and `K_S = 0` is time-delay control.
///
/// # Guarantee
///
/// The estimate converges where `M̄ < 2 cos(π d/(2d + 1)) M` for frozen inertia behind `d` samples: its input
/// is the torque that was commanded, within its limits.
///
/// # Not claimed
///
/// A bound on the error. The slope of (1) and (3) at zero is infinite: what noise does there is not counted.
///
/// # References
///
/// M. Jin, S. H. Kang, P. H. Chang, J. Lee, "Robust control of robot manipulators using inclusive and enhanced
/// time delay control", IEEE/ASME Trans. Mechatronics 22(5), 2017. Grade B: exponents from memory.
#[derive(Debug)]
pub(crate) struct EnhancedTimeDelay {
    kp: f64,
    kd: f64,
    ks: f64,
    /// `α₁, α₂, α₃`
    powers: [f64; 3],
    /// `∫D − ė(0)` \[rad/s\] per joint.
    sum: Vec<f64>,
    started: bool,
    rest: DelayRest,
    period: f64,
}

impl Rival for EnhancedTimeDelay {
    const CARD: Card = Card {
        id: "enhanced-time-delay",
        title: "Inclusive and enhanced time-delay control",
        reference: "[53]",
        source: "Jin, Kang, Chang, Lee, IEEE/ASME T-Mech 22(5), 2017",
        grade: Grade::B,
        caveat: "three parts confirmed by a public summary; the exponents are reconstructed",
        law: "τ = M̄ (q̈_d − D − K_S sig(S)^α₃) + τ₋₁ − M̄ (q̇ − q̇₋₁)/T,  D = K_D sig(ė)^α₂ + K_P sig(e)^α₁",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[
        Scalar {
            name: "proportional",
            unit: "rad^(1-α₁)/s²",
            meaning: "K_P",
            default: 100.0,
            low: 10.0,
            high: 1000.0,
        },
        Scalar {
            name: "derivative",
            unit: "(rad/s)^(1-α₂)/s",
            meaning: "K_D",
            default: 20.0,
            low: 2.0,
            high: 200.0,
        },
        Scalar {
            name: "surface",
            unit: "(rad/s)^(1-α₃)/s",
            meaning: "K_S, the correction of the estimate",
            default: 20.0,
            low: 2.0,
            high: 200.0,
        },
        Scalar {
            name: "error_power",
            unit: "",
            meaning: "α₁ of the error dynamics",
            default: 0.8,
            low: 0.5,
            high: 1.0,
        },
        Scalar {
            name: "surface_power",
            unit: "",
            meaning: "α₃ of the correction",
            default: 0.8,
            low: 0.5,
            high: 1.0,
        },
        INERTIA_SHARE,
    ];
    type Sees<'a> = MotionAndCommand<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Inertia;

    fn new(tuning: &Tuning, inertia: Inertia) -> Result<Self, RivalRefusal> {
        let [kp, kd, ks, first, third, share] = tuning.values()?;
        if let Some(power) = [first, third].into_iter().find(|power| *power > 1.0) {
            return Err(RivalRefusal::Tuning(format!("power {power}: up to 1 is valid")));
        }
        let period = tuning.period();
        let (rest, sum) =
            (DelayRest::new(&inertia, share, period), vec![0.0; inertia.values().len()]);
        let powers = [first, 2.0 * first / (1.0 + first), third];
        Ok(Self { kp, kd, ks, powers, sum, started: false, rest, period })
    }

    fn update(
        &mut self,
        sees: MotionAndCommand<'_>,
        wants: Acceleration<'_>,
        clipped: &[bool],
        tau: &mut [f64],
    ) {
        let Self { kp, kd, ks, powers: [first, second, third], sum, started, rest, period } = self;
        let wanted = |i: usize| {
            let (e, de) = (sees.q[i] - wants.q[i], sees.dq[i] - wants.dq[i]);
            let drive = *kd * sig(de, *second) + *kp * sig(e, *first);
            if !*started {
                sum[i] = -de;
            } else if !clipped[i] {
                sum[i] += *period * drive;
            }
            wants.ddq[i] - drive - *ks * sig(de + sum[i], *third)
        };
        rest.torque(sees, wanted, tau);
        *started = true;
    }

    fn states(&self) -> usize {
        self.sum.len() + self.rest.states()
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let [.., share] = tuning.values::<6>().ok()?;
        let floor = share * arm.ratio_min(1.0 / tuning.period(), tuning.period());
        Some(Condition::above("M̄ < c M; c = 2, behind one sample of delay 1", arm.ratio[0], floor))
    }
}
