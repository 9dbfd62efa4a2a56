//! This project's law from positions, of the core: one law for all joints, first and second order, and a law
//! per joint by design.

use core::f64::consts::TAU;
use core::fmt::Debug;
use core::marker::PhantomData;

use phihat::{JointGains, JointState, Limits, Measurement, PositionDesign, Reference};

use crate::card::{Card, Grade};
use crate::error::RivalRefusal;
use crate::facts::{DesignedFilters, DesignedPositions, Drives, Inertia};
use crate::handed::Knows;
use crate::measured::{PositionsAndTorque, Preview};
use crate::observer::{ObserverPoles, correction};
use crate::rival::Rival;
use crate::rivals::proposed::{BANDWIDTH, DAMPING, outer_gains};
use crate::supply::DesignedPosition;
use crate::tuning::{Scalar, Tuning};

/// The law from positions of order 1: [`JointGains::from_positions`], one law for all joints per unit of `M̄`.
///
/// # Law
///
/// At a sample, with `x = (ê, ė̂, φ̂)`, `d` samples of delay and `r = τ_{k−1} − ff_{k−1}` as the limits let it through:
///
/// ```text
/// x    ← F x + G (τ_applied − ff_{k−1−d})/M̄,   x ← x + ℓ (q − q_d − ê),
/// x⁺   = x through the d torques on their way                                          (1)
/// τ_k  = ff_k + r + g (φ̂⁺ − M̄ (K_d ė̂⁺ + K_p ê⁺) − r),     g = 1 − e^{−2πfT},
/// ff_k = M̄ mean of q̈_d where τ_k acts                                                  (2)
/// ```
///
/// `ℓ` by the observer's poles, one real and a pair.
///
/// # Inputs
///
/// Encoder positions and the torque that acted, and no velocity. It knows the loop's delay and torque limits,
/// which other laws do not request, and gets the reference's acceleration in the interval in which its torque
/// will act; other laws get it at the sample. What it begins with is what ADRC begins with: a triple pole, 20
/// rad/s, damping 1.
///
/// # Not claimed
///
/// An inertia window in a closed form. The comparison computes a bound on the error by peak gains of the
/// sampled loop, as for the paper's law; the tube of `phihat design` belongs to one motion.
///
/// # References
///
/// This project: `docs/theory/positions.md`.
#[derive(Debug)]
pub(crate) struct PositionsFirst;

/// The law of [`PositionsFirst`] with one more state, `φ̂'`, and one more real pole: a load that grows steadily leaves
/// no error.
#[derive(Debug)]
pub(crate) struct PositionsSecond;

/// The law of [`PositionsFirst`] and [`PositionsSecond`] with gains and order of its own for each joint, from the
/// search of `phihat design` for the least error whose torque steps, as far as the encoder makes them, stay within the
/// comparison's allowance of noise.
///
/// # Not claimed
///
/// That these are the gains of least measured error: the search computes joint by joint, over the arm's range
/// of inertia, with the load along the study's own motion. No tube was requested: it belongs to one motion,
/// and a comparison has many.
#[derive(Debug)]
pub(crate) struct ByDesign;

/// The law of [`ByDesign`] with a filter on the innovation of each joint's observer, two sections of second
/// order alongside, from the search of `phihat design` with the key `innovation_filter`.
///
/// # Law
///
/// With `ν` the innovation of (1) and `x, δ` the states of a section, the wanted torque of (2) has
/// `M̄ Σ (b₀ x + b₁ δ)` more:
///
/// ```text
/// x ← x + δ,    δ ← δ + ν − c₀ x − c₁ δ                                                (3)
/// ```
///
/// # Inputs
///
/// Those of [`ByDesign`]. Its filter was weighted by tubes of that law along the study's own motion, and may
/// change the torque by as much, by its estimate, as that law does by its tube. Where there is no such tube
/// it is that law.
///
/// # Not claimed
///
/// As for [`ByDesign`].
#[derive(Debug)]
pub(crate) struct PositionsFiltered;

/// The law itself, whatever its gains are from.
#[derive(Debug)]
pub(crate) struct RivalFromPositions {
    gains: Vec<JointGains<f64>>,
    states: Vec<JointState<f64>>,
    delay: usize,
    /// Sections of the innovation filters of all joints.
    sections: usize,
}

const REAL_POLE: Scalar = Scalar {
    name: "observer_bandwidth",
    unit: "rad/s",
    meaning: "real pole of the observer",
    default: 150.0,
    low: 15.0,
    high: 1500.0,
};
const PAIR: Scalar = Scalar {
    name: "observer_pair",
    unit: "rad/s",
    meaning: "the observer's pair of poles",
    default: 150.0,
    low: 15.0,
    high: 1500.0,
};
const PAIR_DAMPING: Scalar = Scalar {
    name: "observer_pair_damping",
    unit: "",
    meaning: "damping of the pair",
    default: 1.0,
    low: 0.1,
    high: 3.0,
};
const TORQUE_BANDWIDTH: Scalar = Scalar {
    name: "torque_bandwidth",
    unit: "Hz",
    meaning: "f of g = 1 − e^(−2πfT): how fast the torque follows what is wanted",
    default: 50.0,
    low: 5.0,
    high: 500.0,
};
const SLOW_POLE: Scalar = Scalar {
    name: "observer_slow_pole",
    unit: "rad/s",
    meaning: "the observer's second real pole",
    default: 20.0,
    low: 2.0,
    high: 200.0,
};

/// The law from positions of a row with free scalars, at unit inertia; `None` where the row, or the number of
/// values, is another.
pub fn position_law(id: &str, values: &[f64], period: f64) -> Option<DesignedPosition> {
    let (scalars, slow) = match (id, values) {
        ("proposed-positions-1", scalars) => (scalars, None),
        ("proposed-positions-2", [scalars @ .., slow]) => (scalars, Some(*slow)),
        _ => return None,
    };
    let &[omega, zeta, real, pair, damping, hz] = scalars else { return None };
    let [kp, kd] = outer_gains(omega, zeta);
    let mut poles = vec![ObserverPoles::Real(real), ObserverPoles::Pair([pair, damping])];
    poles.extend(slow.map(ObserverPoles::Real));
    let share = -(-TAU * hz * period).exp_m1();
    Some(DesignedPosition {
        inertia: 1.0,
        kp,
        kd,
        correction: correction(&poles, period),
        share,
        innovation_filter: Vec::new(),
    })
}

impl RivalFromPositions {
    /// The same law for every joint: a row's with its values.
    fn shared(
        id: &str,
        tuning: &Tuning,
        values: &[f64],
        (inertia, drives): &(Inertia, Drives),
    ) -> Result<Self, RivalRefusal> {
        let law = position_law(id, values, tuning.period());
        let law =
            law.ok_or_else(|| RivalRefusal::Tuning(format!("{id} has no law of these values")))?;
        let joint = |inertia: &f64| DesignedPosition { inertia: *inertia, ..law.clone() };
        let joints: Vec<_> = inertia.values().iter().map(joint).collect();
        Self::of(&joints, drives, tuning.period())
    }

    /// The law of every joint by itself, sampled every `period` \[s\].
    fn of(joints: &[DesignedPosition], drives: &Drives, period: f64) -> Result<Self, RivalRefusal> {
        let delay = usize::try_from(drives.delay()).unwrap_or(usize::MAX);
        let each = |(i, joint): (usize, &DesignedPosition)| {
            let design = PositionDesign {
                inertia: joint.inertia,
                kp: joint.kp,
                kd: joint.kd,
                correction: &joint.correction,
                velocity_correction: &[],
                share: joint.share,
                delay,
                period,
            };
            let (most, rate) = drives.limits(i);
            let limits = Limits::new(most, rate, period)?;
            let mut gains = JointGains::from_positions(&design)?;
            if !joint.innovation_filter.is_empty() {
                gains = gains.with_innovation_filter(&joint.innovation_filter)?;
            }
            Ok(gains.with_limits(limits))
        };
        let gains: Result<Vec<_>, phihat::GainError> =
            joints.iter().enumerate().map(each).collect();
        let gains = gains.map_err(|e| RivalRefusal::Tuning(e.to_string()))?;
        let sections = joints.iter().map(|joint| joint.innovation_filter.len()).sum();
        Ok(Self { states: vec![JointState::new(); gains.len()], gains, delay, sections })
    }

    fn update(&mut self, sees: PositionsAndTorque<'_>, wants: Preview<'_>, tau: &mut [f64]) {
        for (i, tau) in tau.iter_mut().enumerate() {
            // The law is asked for no velocity, but says where it is at its first sample: at the reference's.
            let measured = Measurement { q: sees.q[i], dq: wants.dq[i], tau_applied: sees.tau[i] };
            let wanted = Reference { q: wants.q[i], dq: wants.dq[i], ddq: wants.ddq_acting[i] };
            *tau = self.gains[i].update(&mut self.states[i], &measured, &wanted).tau;
        }
    }

    /// Of a joint: `ê`, `ė̂`, `φ̂` and its derivatives, the torques on their way, and the feed-forward in
    /// them and in the one that acted; two of every section of a filter.
    fn states(&self) -> usize {
        let pending = self.delay.max(1) + self.delay + 1;
        let joints = self.gains.iter().map(|gains| 2 + gains.order() + pending);
        joints.sum::<usize>() + 2 * self.sections
    }
}

/// Kind of a row of the law: its free scalars, its knowledge, and the gains that result from these.
pub(crate) trait RowKind: Debug + Send + 'static {
    const CARD: Card;
    const SCALARS: &'static [Scalar];
    type Knows: Knows;

    fn law(tuning: &Tuning, knows: Self::Knows) -> Result<RivalFromPositions, RivalRefusal>;
}

/// A row of the law from positions.
#[derive(Debug)]
pub(crate) struct PositionsRow<K>(RivalFromPositions, PhantomData<K>);

impl<K: RowKind> Rival for PositionsRow<K> {
    const CARD: Card = K::CARD;
    const SCALARS: &'static [Scalar] = K::SCALARS;
    type Sees<'a> = PositionsAndTorque<'a>;
    type Wants<'a> = Preview<'a>;
    type Knows = K::Knows;

    fn new(tuning: &Tuning, knows: Self::Knows) -> Result<Self, RivalRefusal> {
        Ok(Self(K::law(tuning, knows)?, PhantomData))
    }

    fn update(
        &mut self,
        sees: PositionsAndTorque<'_>,
        wants: Preview<'_>,
        _: &[bool],
        tau: &mut [f64],
    ) {
        self.0.update(sees, wants, tau);
    }

    fn states(&self) -> usize {
        self.0.states()
    }
}

impl RowKind for PositionsFirst {
    const CARD: Card = Card {
        id: "proposed-positions-1",
        title: "Proposed, from positions, m = 1 (this project)",
        reference: "",
        source: "this project, docs/theory/positions.md",
        grade: Grade::A,
        caveat: "",
        law: "τ = ff + r + g (φ̂⁺ − M̄ (K_d ė̂⁺ + K_p ê⁺) − r),  ê, ė̂, φ̂ observed from q",
        printed: None,
    };
    const SCALARS: &'static [Scalar] =
        &[BANDWIDTH, DAMPING, REAL_POLE, PAIR, PAIR_DAMPING, TORQUE_BANDWIDTH];
    type Knows = (Inertia, Drives);

    fn law(tuning: &Tuning, knows: Self::Knows) -> Result<RivalFromPositions, RivalRefusal> {
        let values: [f64; 6] = tuning.values()?;
        RivalFromPositions::shared(Self::CARD.id, tuning, &values, &knows)
    }
}

impl RowKind for PositionsSecond {
    const CARD: Card = Card {
        id: "proposed-positions-2",
        title: "Proposed, from positions, m = 2 (this project)",
        reference: "",
        source: "this project, docs/theory/positions.md",
        grade: Grade::A,
        caveat: "",
        law: "τ = ff + r + g (φ̂⁺ − M̄ (K_d ė̂⁺ + K_p ê⁺) − r),  ê, ė̂, φ̂, φ̂' observed from q",
        printed: None,
    };
    const SCALARS: &'static [Scalar] =
        &[BANDWIDTH, DAMPING, REAL_POLE, PAIR, PAIR_DAMPING, TORQUE_BANDWIDTH, SLOW_POLE];
    type Knows = (Inertia, Drives);

    fn law(tuning: &Tuning, knows: Self::Knows) -> Result<RivalFromPositions, RivalRefusal> {
        let values: [f64; 7] = tuning.values()?;
        RivalFromPositions::shared(Self::CARD.id, tuning, &values, &knows)
    }
}

impl RowKind for ByDesign {
    const CARD: Card = Card {
        id: "proposed-positions-designed",
        title: "Proposed, from positions, a law per joint by design (this project)",
        reference: "",
        source: "this project, docs/theory/positions.md; the search of `phihat design`",
        grade: Grade::A,
        caveat: "",
        law: "τ_i = ff + r + g_i (φ̂⁺ − M̄_i (K_d,i ė̂⁺ + K_p,i ê⁺) − r),  all gains by design, for each joint",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[];
    type Knows = (DesignedPositions, Drives);

    fn law(tuning: &Tuning, knows: Self::Knows) -> Result<RivalFromPositions, RivalRefusal> {
        let (designed, drives) = knows;
        RivalFromPositions::of(designed.joints(), &drives, tuning.period())
    }
}

impl RowKind for PositionsFiltered {
    const CARD: Card = Card {
        id: "proposed-positions-filtered",
        title: "Proposed, from positions, a law per joint and a filter by design (this project)",
        reference: "",
        source: "this project, docs/theory/positions.md; the search of `phihat design`, `innovation_filter`",
        grade: Grade::A,
        caveat: "",
        law: "τ_i = ff + r + g_i (φ̂⁺ − M̄_i (K_d,i ė̂⁺ + K_p,i ê⁺) + M̄_i Σ (b₀ x + b₁ δ) − r),  all gains by design, \
            for each joint",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[];
    type Knows = (DesignedFilters, Drives);

    fn law(tuning: &Tuning, knows: Self::Knows) -> Result<RivalFromPositions, RivalRefusal> {
        let (designed, drives) = knows;
        RivalFromPositions::of(designed.joints(), &drives, tuning.period())
    }
}
