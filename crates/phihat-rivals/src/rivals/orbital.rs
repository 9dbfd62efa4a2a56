//! Orbital stabilisation: the path is followed, the time table is not.

use crate::card::{Card, Grade, Tick, Ticks};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::measured::{Acceleration, MeasuredMotion, NoReference};
use crate::nominal::Nominal;
use crate::orbit::Orbit;
use crate::rival::Rival;
use crate::rivals::pd::Pd;
use crate::rivals::pd_plus::PdPlus;
use crate::tuning::{Scalar, Tuning};

/// PD+ around the nearest point of the path, after Pchelkin et al.
///
/// # Law
///
/// With `θ = argmin |q − Φ(θ)|²`, and `θ̇ = 1` the task's own speed along its path `q = Φ(θ)`:
///
/// ```text
/// q_d := Φ(θ),   q̇_d := Φ′(θ),   q̈_d := Φ″(θ)      in the law of PD+                     (1)
/// ```
///
/// The feedback is time-invariant. The error that is left is transversal, `eᵀΦ′ = 0`. `θ` is looked for on the whole
/// path at the first sample, then followed.
///
/// # Guarantee
///
/// With an exact model the orbit is exponentially stable nearby, by its transverse linearisation.
///
/// # Not claimed
///
/// To be anywhere at a given time: what the model lacks slows the phase and nothing catches up. To be judged by the
/// distance to the path. Nothing is said of starts far from the path, where the nearest point may jump.
///
/// # References
///
/// S. S. Pchelkin et al., "On orbital stabilization for industrial manipulators: case study in evaluating
/// performances of modified PD+ and inverse dynamics controllers", IEEE Trans. Control Systems Technology
/// 25(1), 2017. Grade C: no public copy of the law was found. The title says what (1) is: PD+, modified for orbital
/// stabilisation. Unknown are how `θ` is computed from the state, whether the speed along the path is controlled, the
/// compensation of friction, and the gains.
#[derive(Debug)]
pub(crate) struct Orbital {
    law: PdPlus,
    orbit: Orbit,
    /// `θ` \[s\], once there was a measurement.
    theta: Option<f64>,
}

impl Rival for Orbital {
    const CARD: Card = Card {
        id: "orbital",
        title: "Orbital stabilisation, PD+ (Pchelkin et al.)",
        reference: "[20]",
        source: "Pchelkin et al., IEEE T-CST 25(1), 2017",
        grade: Grade::C,
        caveat: "details of the published law not found: PD+ with time replaced by the nearest place on the path. \
            Unknown: how θ is computed, whether the speed along the path is controlled",
        law: "PD+ with q_d = Φ(θ), q̇_d = Φ′(θ), q̈_d = Φ″(θ),  θ = argmin |q − Φ(θ)|",
        printed: Some(Ticks {
            quantitative: Tick::Yes,
            easy: Tick::No,
            optimal: Tick::Partly,
            model_free: Tick::No,
        }),
    };
    const SCALARS: &'static [Scalar] = Pd::SCALARS;
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = NoReference;
    type Knows = (Nominal, Orbit);

    fn new(tuning: &Tuning, (model, orbit): (Nominal, Orbit)) -> Result<Self, RivalRefusal> {
        Ok(Self { law: PdPlus::new(tuning, model)?, orbit, theta: None })
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        _: NoReference,
        clipped: &[bool],
        tau: &mut [f64],
    ) {
        let from = self.theta.unwrap_or_else(|| self.orbit.search(sees.q));
        self.theta = Some(self.orbit.project(sees.q, from));
        let [q, dq, ddq] = self.orbit.place();
        self.law.update(sees, Acceleration { q, dq, ddq }, clipped, tau);
    }

    fn states(&self) -> usize {
        1
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        PdPlus::condition(tuning, arm)
    }
}
