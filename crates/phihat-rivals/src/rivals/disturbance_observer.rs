//! The disturbance observer on top of a PD with feed-forward of the acceleration.

use crate::card::{Card, Grade};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::facts::Inertia;
use crate::measured::{Acceleration, MotionAndTorque};
use crate::rival::Rival;
use crate::rivals::proposed::{BANDWIDTH, DAMPING, ProposedFirst};
use crate::tuning::{Scalar, Tuning};

/// Disturbance observer of first order.
///
/// # Law
///
/// ```text
/// φ̂ = z − g M̄ q̇,     ż = g (τ_applied − φ̂),     τ = M̄ (q̈_d − K_d ė − K_p e) + φ̂             (1)
/// ```
///
/// That is the paper's law of order 1 with `a_0 = g`, as algebra has it and as a test shows for (1) integrated on
/// its own. So both are one implementation, [`ProposedFirst`]: rows of the table that differ do so by their tuning.
///
/// # Guarantee
///
/// The inertia window and the error by peak gains, as for `proposed-1`.
///
/// # Not claimed
///
/// Anything in the paper's sense of optimal: a disturbance observer is not derived from a cost.
///
/// # References
///
/// K. Ohnishi, M. Shibata, T. Murakami, "Motion control for advanced mechatronics", IEEE/ASME Trans. Mechatronics
/// 1(1), 1996. Grade A.
#[derive(Debug)]
pub(crate) struct DisturbanceObserver(ProposedFirst);

impl Rival for DisturbanceObserver {
    const CARD: Card = Card {
        id: "disturbance-observer",
        title: "Disturbance observer",
        reference: "",
        source: "Ohnishi, Shibata, Murakami, IEEE/ASME T-Mech 1(1), 1996",
        grade: Grade::A,
        caveat: "",
        law: "τ = M̄ (q̈_d − K_d ė − K_p e) + φ̂,  φ̂ = g/(s + g) (τ_applied − M̄ q̈)",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[
        BANDWIDTH,
        DAMPING,
        Scalar {
            name: "cutoff",
            unit: "rad/s",
            meaning: "g of the observer",
            default: 100.0,
            low: 10.0,
            high: 700.0,
        },
    ];
    type Sees<'a> = MotionAndTorque<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Inertia;

    fn new(tuning: &Tuning, inertia: Inertia) -> Result<Self, RivalRefusal> {
        ProposedFirst::new(tuning, inertia).map(Self)
    }

    fn update(
        &mut self,
        sees: MotionAndTorque<'_>,
        wants: Acceleration<'_>,
        clipped: &[bool],
        tau: &mut [f64],
    ) {
        self.0.update(sees, wants, clipped, tau);
    }

    fn states(&self) -> usize {
        self.0.states()
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        ProposedFirst::condition(tuning, arm)
    }

    fn bound(tuning: &Tuning, arm: &DeclaredArm) -> Option<Vec<f64>> {
        ProposedFirst::bound(tuning, arm)
    }
}
