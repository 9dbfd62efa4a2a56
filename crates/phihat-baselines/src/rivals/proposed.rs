//! The paper's law, in the form that a robot runs: the core of this project, first and second order.

use phihat::{Form, JointDesign, JointGains, JointState, Measurement, Reference};

use crate::card::{Card, Grade, Tick, Ticks};
use crate::error::Refusal;
use crate::needs::{Acceleration, Inertia, MotionAndTorque};
use crate::rival::Rival;
use crate::tuning::{Scalar, Tuning};

/// The paper's law of order 1: [`JointGains`] in its observer form, limits left to the loop around it.
///
/// # Law
///
/// ```text
/// τ = M̄ (q̈_d − K_d ė − K_p e) + φ̂,     Φ̂(s) = a_0/(s + a_0) Φ(s),     φ = τ_applied − M̄ q̈     (1)
/// ```
///
/// # References
///
/// Hayat, Leibold, Buss (2018), (6), (8); the observer form is this project's.
#[derive(Debug)]
pub(crate) struct First(Law);

/// The paper's law of order 2, estimator poles of damping `ζ_o`.
///
/// # Law
///
/// ```text
/// Φ̂(s) = (a_1 s + a_0)/(s² + a_1 s + a_0) Φ(s),     a_0 = ω_o²,  a_1 = 2 ζ_o ω_o               (2)
/// ```
#[derive(Debug)]
pub(crate) struct Second(Law);

#[derive(Debug)]
struct Law {
    gains: Vec<JointGains<f64>>,
    states: Vec<JointState<f64>>,
}

const PRINTED: Ticks =
    Ticks { quantitative: Tick::Yes, easy: Tick::Yes, optimal: Tick::Yes, model_free: Tick::Yes };

const BANDWIDTH: Scalar = Scalar {
    name: "bandwidth",
    unit: "rad/s",
    meaning: "ω of the outer loop, K_p = ω²",
    default: 20.0,
    low: 2.0,
    high: 200.0,
};
const DAMPING: Scalar = Scalar {
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

impl Law {
    fn new(
        tuning: &Tuning,
        inertia: &Inertia,
        outer: [f64; 2],
        a: &[f64],
    ) -> Result<Self, Refusal> {
        let [omega, zeta] = outer;
        let joint = |inertia: &f64| {
            JointGains::new(&JointDesign {
                inertia: *inertia,
                kp: omega * omega,
                kd: 2.0 * zeta * omega,
                a,
                period: tuning.period(),
                form: Form::Observer,
            })
        };
        let gains: Result<Vec<_>, _> = inertia.values().iter().map(joint).collect();
        let gains = gains.map_err(|e| Refusal::Tuning(e.to_string()))?;
        Ok(Self { states: vec![JointState::new(); gains.len()], gains })
    }

    fn update(&mut self, sees: MotionAndTorque<'_>, wants: Acceleration<'_>, tau: &mut [f64]) {
        for (i, tau) in tau.iter_mut().enumerate() {
            let measured = Measurement { q: sees.q[i], dq: sees.dq[i], tau_applied: sees.tau[i] };
            let wanted = Reference { q: wants.q[i], dq: wants.dq[i], ddq: wants.ddq[i] };
            *tau = self.gains[i].update(&mut self.states[i], &measured, &wanted).tau;
        }
    }
}

impl Rival for First {
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

    fn new(tuning: &Tuning, inertia: Inertia) -> Result<Self, Refusal> {
        let [omega, zeta, estimator] = tuning.values()?;
        Law::new(tuning, &inertia, [omega, zeta], &[estimator]).map(Self)
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
        self.0.states.len()
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

    fn new(tuning: &Tuning, inertia: Inertia) -> Result<Self, Refusal> {
        let [omega, zeta, estimator, damping] = tuning.values()?;
        let a = [estimator * estimator, 2.0 * damping * estimator];
        Law::new(tuning, &inertia, [omega, zeta], &a).map(Self)
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
        2 * self.0.states.len()
    }
}
