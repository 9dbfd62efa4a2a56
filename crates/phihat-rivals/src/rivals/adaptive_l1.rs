//! L1 adaptive control: fast estimates behind a filter.

use crate::card::{Card, Grade};
use crate::error::RivalRefusal;
use crate::facts::Inertia;
use crate::measured::{Acceleration, MotionAndTorque};
use crate::rival::Rival;
use crate::rivals::proposed::{BANDWIDTH, DAMPING, outer_gains};
use crate::rivals::time_delay::INERTIA_SHARE;
use crate::tuning::{Scalar, Tuning};

/// L1 adaptive control of every joint with piecewise-constant adaptation.
///
/// # Law
///
/// A predictor of the velocity, an estimate `σ̂` \[rad/s²\] of all that the nominal joint lacks, and a low-pass of it:
///
/// ```text
/// dv̂/dt = −a (v̂ − q̇) + τ_applied/M̄ + σ̂,     ṽ = v̂ − q̇                                   (1)
/// σ̂_k = −a e^{−aT}/(1 − e^{−aT}) ṽ_k                                                      (2)
/// τ = M̄ (q̈_d − K_d ė − K_p e − σ_f),     σ_f = ω_c/(s + ω_c) σ̂                              (3)
/// ```
///
/// (1) is solved exactly for a velocity that is straight between samples.
///
/// # Guarantee
///
/// As (1), (2) have it in samples, `σ̂_k = e^{−aT} σ_k`, with `σ_k` what was missing on the mean since the
/// last sample: a load that stays leaves `e = (1 − e^{−aT}) load/(M̄ K_p)`. Tests check both.
///
/// # Not claimed
///
/// The transient bounds of its authors: they count a Lipschitz constant of the arm's dynamics that is not
/// declared here.
///
/// # References
///
/// N. Hovakimyan, C. Cao, "L1 Adaptive Control Theory: Guaranteed Robustness with Fast Adaptation", 2010,
/// section 3.3 (piecewise-constant adaptation). There it augments a state feedback of the plant's own; here
/// it augments a PD in one nominal inertia per joint. Grade B.
#[derive(Debug)]
pub(crate) struct AdaptiveL1 {
    kp: f64,
    kd: f64,
    inertia: Vec<f64>,
    /// `e^{−aT}` and `(1 − e^{−aT})/a`.
    predictor: [f64; 2],
    /// `1 − e^{−ω_c T}`
    share: f64,
    joints: Vec<Predicted>,
    started: bool,
    period: f64,
}

/// State of a joint.
#[derive(Debug, Clone, Copy, Default)]
struct Predicted {
    /// Measured before.
    dq: f64,
    /// `ṽ`
    off: f64,
    /// `σ̂`
    estimate: f64,
    /// `σ_f`
    filtered: f64,
}

impl Rival for AdaptiveL1 {
    const CARD: Card = Card {
        id: "l1-adaptive",
        title: "L1 adaptive",
        reference: "",
        source: "Hovakimyan, Cao, L1 Adaptive Control Theory, 2010, 3.3",
        grade: Grade::B,
        caveat: "augments a PD in one nominal inertia per joint, in place of a state feedback of the plant",
        law: "τ = M̄ (q̈_d − K_d ė − K_p e − σ_f),  dv̂/dt = −a ṽ + τ_applied/M̄ + σ̂,\n\
              σ̂ = −a e^(−aT)/(1 − e^(−aT)) ṽ,  σ_f = ω_c/(s + ω_c) σ̂",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[
        BANDWIDTH,
        DAMPING,
        Scalar {
            name: "predictor",
            unit: "1/s",
            meaning: "a of the predictor",
            default: 1.0,
            low: 0.1,
            high: 100.0,
        },
        Scalar {
            name: "filter",
            unit: "rad/s",
            meaning: "ω_c of the filter",
            default: 70.0,
            low: 7.0,
            high: 700.0,
        },
        Scalar { default: 1.0, ..INERTIA_SHARE },
    ];
    type Sees<'a> = MotionAndTorque<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Inertia;

    fn new(tuning: &Tuning, inertia: Inertia) -> Result<Self, RivalRefusal> {
        let [omega, zeta, a, cutoff, share] = tuning.values()?;
        let [kp, kd] = outer_gains(omega, zeta);
        let period = tuning.period();
        let inertia: Vec<f64> = inertia.values().iter().map(|inertia| share * inertia).collect();
        Ok(Self {
            kp,
            kd,
            predictor: [(-a * period).exp(), -(-a * period).exp_m1() / a],
            share: -(-cutoff * period).exp_m1(),
            joints: vec![Predicted::default(); inertia.len()],
            inertia,
            started: false,
            period,
        })
    }

    fn update(
        &mut self,
        sees: MotionAndTorque<'_>,
        wants: Acceleration<'_>,
        _: &[bool],
        tau: &mut [f64],
    ) {
        let [decay, grown] = self.predictor;
        for (i, tau) in tau.iter_mut().enumerate() {
            let (m, joint) = (self.inertia[i], &mut self.joints[i]);
            if self.started {
                let rate = (sees.dq[i] - joint.dq) / self.period;
                joint.off = decay * joint.off + grown * (sees.tau[i] / m + joint.estimate - rate);
                joint.estimate = -decay / grown * joint.off;
                joint.filtered += self.share * (joint.estimate - joint.filtered);
            }
            joint.dq = sees.dq[i];
            let (e, de) = (sees.q[i] - wants.q[i], sees.dq[i] - wants.dq[i]);
            *tau = m * (wants.ddq[i] - self.kd * de - self.kp * e - joint.filtered);
        }
        self.started = true;
    }

    fn states(&self) -> usize {
        4 * self.joints.len()
    }
}
