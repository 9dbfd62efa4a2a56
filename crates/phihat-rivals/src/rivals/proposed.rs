//! The paper's law, in the form that a robot runs: the core of this project, first and second order.

use phihat::{Form, JointDesign, JointGains, JointState, Measurement, Reference};

use crate::card::{Card, Grade, Tick, Ticks};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::facts::Inertia;
use crate::math::peak_gain;
use crate::measured::{Acceleration, MotionAndTorque};
use crate::rival::Rival;
use crate::supply::DesignedJoint;
use crate::tuning::{Scalar, Tuning};

/// The paper's law of order 1: [`JointGains`] in its observer form, limits left to the loop around it.
///
/// # Law
///
/// ```text
/// τ = M̄ (q̈_d − K_d ė − K_p e) + φ̂,     Φ̂(s) = a_0/(s + a_0) Φ(s),     φ = τ_applied − M̄ q̈     (1)
/// ```
///
/// # Guarantee
///
/// Frozen inertia of ratio `μ` to `M̄`: stable inside the window (2), its lower end from sampling and delay
/// ([`DeclaredArm::ratio_min`]: `c` is 2 without delay and 1 behind one sample), its upper end in continuous
/// time. The error of a joint by peak gains, with `G(s) = s/((s² + K_d s + K_p)(s + a_0))` and `‖·‖₁` the
/// integral of the impulse response's modulus:
///
/// ```text
/// (K_d + a_0) T / c < μ < (K_d + a_0)(K_p + a_0 K_d)/(a_0 K_p)                         (2)
/// M̄ |e| ≤ ‖G/s‖₁ max|φ̇| + ‖G‖₁ max|jump of φ|                                          (3)
/// ```
///
/// # Not claimed
///
/// (2) to the digit behind a delay: the observer knows the torque that acted, and bears somewhat less inertia
/// than the rule says. (3) for an arm whose `φ` is not the declared one: `φ` holds `(M − M̄) q̈`, and the
/// declared one is that along the reference. The certificates of `phihat-design` are stricter; this is the
/// claim that any user can compute.
///
/// # References
///
/// Hayat, Leibold, Buss (2018), (6), (8); the observer form is this project's.
#[derive(Debug)]
pub(crate) struct ProposedFirst(ProposedLaw);

/// The paper's law of order 2, estimator poles of damping `ζ_o`.
///
/// # Law
///
/// ```text
/// Φ̂(s) = (a_1 s + a_0)/(s² + a_1 s + a_0) Φ(s),     a_0 = ω_o²,  a_1 = 2 ζ_o ω_o               (1)
/// ```
///
/// # Guarantee
///
/// As for order 1, with `G(s) = s²/((s² + K_d s + K_p)(s² + a_1 s + a_0))`. With `c_i` the coefficients of that
/// denominator the upper end is where Routh's criterion fails, at `μ = (c_3 c_2 c_1 − c_3² c_0)/c_1²`.
#[derive(Debug)]
pub(crate) struct Second(ProposedLaw);

#[derive(Debug)]
pub(crate) struct ProposedLaw {
    gains: Vec<JointGains<f64>>,
    states: Vec<JointState<f64>>,
}

pub(crate) const PRINTED: Ticks =
    Ticks { quantitative: Tick::Yes, easy: Tick::Yes, optimal: Tick::Yes, model_free: Tick::Yes };

pub(crate) const BANDWIDTH: Scalar = Scalar {
    name: "bandwidth",
    unit: "rad/s",
    meaning: "ω of the outer loop, K_p = ω²",
    default: 20.0,
    low: 2.0,
    high: 200.0,
};
pub(crate) const DAMPING: Scalar = Scalar {
    name: "damping",
    unit: "",
    meaning: "ζ of the outer loop, K_d = 2ζω",
    default: 1.0,
    low: 0.3,
    high: 3.0,
};
const ESTIMATOR: Scalar = Scalar {
    name: "estimator_bandwidth",
    unit: "rad/s",
    meaning: "ω_o of the estimator",
    default: 69.6,
    low: 7.0,
    high: 700.0,
};
const ESTIMATOR_DAMPING: Scalar = Scalar {
    name: "estimator_damping",
    unit: "",
    meaning: "ζ_o of the estimator; above 1/√2 it can be certified",
    default: 1.0,
    low: 0.5,
    high: 3.0,
};

impl ProposedLaw {
    pub(crate) fn joints(&self) -> usize {
        self.states.len()
    }

    pub(crate) fn new(
        tuning: &Tuning,
        inertia: &Inertia,
        outer: [f64; 2],
        a: &[f64],
    ) -> Result<Self, RivalRefusal> {
        let [kp, kd] = outer_gains(outer[0], outer[1]);
        let joint = |inertia: &f64| DesignedJoint { inertia: *inertia, kp, kd, a: a.to_vec() };
        let joints: Vec<_> = inertia.values().iter().map(joint).collect();
        Self::of(&joints, tuning.period())
    }

    /// The law of every joint by itself, sampled every `period` \[s\].
    pub(crate) fn of(joints: &[DesignedJoint], period: f64) -> Result<Self, RivalRefusal> {
        let gains = joints.iter().map(|joint| {
            JointGains::new(&JointDesign {
                inertia: joint.inertia,
                kp: joint.kp,
                kd: joint.kd,
                a: &joint.a,
                period,
                form: Form::Observer,
            })
        });
        let gains: Result<Vec<_>, _> = gains.collect();
        let gains = gains.map_err(|e| RivalRefusal::Tuning(e.to_string()))?;
        Ok(Self { states: vec![JointState::new(); gains.len()], gains })
    }

    pub(crate) fn update(
        &mut self,
        sees: MotionAndTorque<'_>,
        wants: Acceleration<'_>,
        tau: &mut [f64],
    ) {
        for (i, tau) in tau.iter_mut().enumerate() {
            let measured = Measurement { q: sees.q[i], dq: sees.dq[i], tau_applied: sees.tau[i] };
            let wanted = Reference { q: wants.q[i], dq: wants.dq[i], ddq: wants.ddq[i] };
            *tau = self.gains[i].update(&mut self.states[i], &measured, &wanted).tau;
        }
    }
}

/// (2): whether the arm's inertia is inside the window of the first-order law.
pub(crate) fn window(kp: f64, kd: f64, a0: f64, period: f64, arm: &DeclaredArm) -> Condition {
    let ceiling = (kd + a0) * (kp + a0 * kd) / (a0 * kp);
    Condition::inside(
        "(K_d + a₀)T/c < μ < (K_d + a₀)(K_p + a₀K_d)/(a₀K_p); c = 2, behind one sample of delay 1",
        arm.ratio,
        [arm.ratio_min(kd + a0, period), ceiling],
    )
}

/// (3): the error by peak gains of the loop with denominator `c` and an estimator of some order.
pub(crate) fn error_by_peak_gains(
    order: usize,
    c: &[f64],
    tuning: &Tuning,
    arm: &DeclaredArm,
) -> Option<Vec<f64>> {
    let (rate, jump) = (peak_gain(order - 1, c)?, peak_gain(order, c)?);
    let joints = tuning.units().iter().zip(arm.phi_rate.iter().zip(&arm.phi_jump));
    Some(joints.map(|(unit, (dphi, phi))| (rate * dphi + jump * phi) / unit).collect())
}

/// `K_p, K_d` of a bandwidth and a damping.
pub(crate) fn outer_gains(omega: f64, zeta: f64) -> [f64; 2] {
    [omega * omega, 2.0 * zeta * omega]
}

/// Coefficients of `(s² + K_d s + K_p)(s + a_0)`, from that of `s⁰`.
pub(crate) fn first_order_loop(kp: f64, kd: f64, a0: f64) -> [f64; 3] {
    [a0 * kp, kp + a0 * kd, kd + a0]
}

impl Rival for ProposedFirst {
    const CARD: Card = Card {
        id: "proposed-1",
        title: "Proposed, m = 1 (this project)",
        reference: "proposed",
        source: "Hayat, Leibold, Buss, 2018, in observer form with M̄",
        grade: Grade::A,
        caveat: "",
        law: "τ = M̄ (q̈_d − K_d ė − K_p e) + φ̂,  φ̂ = a_0/(s + a_0) φ",
        printed: Some(PRINTED),
    };
    const SCALARS: &'static [Scalar] = &[BANDWIDTH, DAMPING, ESTIMATOR];
    type Sees<'a> = MotionAndTorque<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Inertia;

    fn new(tuning: &Tuning, inertia: Inertia) -> Result<Self, RivalRefusal> {
        let [omega, zeta, estimator] = tuning.values()?;
        ProposedLaw::new(tuning, &inertia, [omega, zeta], &[estimator]).map(Self)
    }

    fn update(
        &mut self,
        sees: MotionAndTorque<'_>,
        wants: Acceleration<'_>,
        _: &[bool],
        tau: &mut [f64],
    ) {
        self.0.update(sees, wants, tau);
    }

    fn states(&self) -> usize {
        self.0.joints()
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let [omega, zeta, a0] = tuning.values().ok()?;
        let [kp, kd] = outer_gains(omega, zeta);
        Some(window(kp, kd, a0, tuning.period(), arm))
    }

    fn bound(tuning: &Tuning, arm: &DeclaredArm) -> Option<Vec<f64>> {
        let [omega, zeta, a0] = tuning.values().ok()?;
        let [kp, kd] = outer_gains(omega, zeta);
        error_by_peak_gains(1, &first_order_loop(kp, kd, a0), tuning, arm)
    }
}

impl Rival for Second {
    const CARD: Card = Card {
        id: "proposed-2",
        title: "Proposed, m = 2 (this project)",
        reference: "proposed",
        source: "Hayat, Leibold, Buss, 2018, in observer form with M̄",
        grade: Grade::A,
        caveat: "",
        law: "τ = M̄ (q̈_d − K_d ė − K_p e) + φ̂,  φ̂ = (a_1 s + a_0)/(s² + a_1 s + a_0) φ",
        printed: Some(PRINTED),
    };
    const SCALARS: &'static [Scalar] = &[BANDWIDTH, DAMPING, ESTIMATOR, ESTIMATOR_DAMPING];
    type Sees<'a> = MotionAndTorque<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Inertia;

    fn new(tuning: &Tuning, inertia: Inertia) -> Result<Self, RivalRefusal> {
        let [omega, zeta, estimator, damping] = tuning.values()?;
        let a = [estimator * estimator, 2.0 * damping * estimator];
        ProposedLaw::new(tuning, &inertia, [omega, zeta], &a).map(Self)
    }

    fn update(
        &mut self,
        sees: MotionAndTorque<'_>,
        wants: Acceleration<'_>,
        _: &[bool],
        tau: &mut [f64],
    ) {
        self.0.update(sees, wants, tau);
    }

    fn states(&self) -> usize {
        2 * self.0.joints()
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let c = Self::closed_loop(tuning)?;
        let ceiling = (c[3] * c[2] * c[1] - c[3] * c[3] * c[0]) / (c[1] * c[1]);
        let floor = arm.ratio_min(c[3], tuning.period());
        Some(Condition::inside(
            "(K_d + a₁)T/c < μ < (c₃c₂c₁ − c₃²c₀)/c₁² of (s² + K_d s + K_p)(s² + a₁s + a₀); c = 2, behind one sample \
                of delay 1",
            arm.ratio,
            [floor, ceiling],
        ))
    }

    fn bound(tuning: &Tuning, arm: &DeclaredArm) -> Option<Vec<f64>> {
        error_by_peak_gains(2, &Self::closed_loop(tuning)?, tuning, arm)
    }
}

impl Second {
    /// Coefficients of `(s² + K_d s + K_p)(s² + a_1 s + a_0)`, from that of `s⁰`.
    fn closed_loop(tuning: &Tuning) -> Option<[f64; 4]> {
        let [omega, zeta, estimator, damping] = tuning.values().ok()?;
        let [kp, kd] = outer_gains(omega, zeta);
        let [a0, a1] = outer_gains(estimator, damping);
        Some([kp * a0, kp * a1 + kd * a0, kp + kd * a1 + a0, kd + a1])
    }
}
