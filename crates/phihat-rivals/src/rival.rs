//! A rival, and rivals of any kind in one list.

use core::fmt::Debug;

use crate::card::Card;
use crate::choice::{self, Chosen, SensedChoice};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::friction::WithFriction;
use crate::handed::{All, Knows, Sees, Wants};
use crate::needs::Needs;
use crate::running::Running;
use crate::supply::Supply;
use crate::tuning::{Scalar, Tuning};

/// A controller of somebody else's. What it needs is in its types, and it is handed only that.
pub trait Rival: Debug + Send + Sized + 'static {
    /// Name, origin, grade, the paper's ticks.
    const CARD: Card;
    /// Its free scalars, in the order of [`Tuning::values`].
    const SCALARS: &'static [Scalar];
    /// The measurements that it takes.
    type Sees<'a>: Sees<'a>;
    /// The reference that it takes.
    type Wants<'a>: Wants<'a>;
    /// Knowledge of the arm that it takes.
    type Knows: Knows;

    /// Builds it.
    ///
    /// # Errors
    ///
    /// [`RivalRefusal`]: the law does not apply to this arm, or not with this tuning.
    fn new(tuning: &Tuning, knows: Self::Knows) -> Result<Self, RivalRefusal>;

    /// One sample: leaves the torques \[N·m\] in `tau`, before any limit. `clipped`: which joints' last torque
    /// met a limit. What is to be latched at the start is latched at the first call.
    fn update(
        &mut self,
        sees: Self::Sees<'_>,
        wants: Self::Wants<'_>,
        clipped: &[bool],
        tau: &mut [f64],
    );

    /// Scalars that it remembers from one sample to the next.
    fn states(&self) -> usize;

    /// Its published or derived stability condition, checked for an arm. By default it has none that a number
    /// could be given to.
    fn condition(_tuning: &Tuning, _arm: &DeclaredArm) -> Option<Condition> {
        None
    }

    /// The condition that its authors' proof of optimality puts on the gains; `None` where there is no such proof, or
    /// none that is known here.
    fn optimality(_tuning: &Tuning) -> Option<Condition> {
        None
    }

    /// Largest |e| \[rad\] per joint after the transient that it promises before a run; `None` where it makes no
    /// such promise. `arm` has what is declared of the arm and its load.
    fn bound(_tuning: &Tuning, _arm: &DeclaredArm) -> Option<Vec<f64>> {
        None
    }
}

#[derive(Debug)]
struct Handed<R>(R);

impl<R: Rival> Running for Handed<R> {
    fn update(&mut self, all: &All<'_>, tau: &mut [f64]) {
        let (sees, wants) = (R::Sees::of(all), R::Wants::of(all));
        self.0.update(sees, wants, all.clipped, tau);
    }

    fn states(&self) -> usize {
        self.0.states()
    }
}

type BuiltRival = Result<Box<dyn Running>, RivalRefusal>;

/// Constructor of a law that is not of this crate.
pub type Make = dyn Fn(&Tuning, &Supply) -> Result<Box<dyn Running>, RivalRefusal> + Sync;

#[derive(Clone, Copy)]
enum Build {
    Rival(fn(&Tuning, &Supply) -> BuiltRival),
    Own(&'static Make),
}

impl Debug for Build {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Rival(_) => "Rival",
            Self::Own(_) => "Own",
        })
    }
}

/// A rival in the list, of whatever type.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// Name, origin, grade, the paper's ticks.
    pub card: &'static Card,
    /// Needs of the law, read from its types.
    pub needs: Needs,
    /// Its free scalars.
    pub scalars: &'static [Scalar],
    /// Version of a law that is not of this crate, whose earlier versions have other results; else empty.
    pub edition: &'static str,
    build: Build,
    condition: fn(&Tuning, &DeclaredArm) -> Option<Condition>,
    optimality: fn(&Tuning) -> Option<Condition>,
    bound: fn(&Tuning, &DeclaredArm) -> Option<Vec<f64>>,
}

impl Entry {
    /// The entry of a rival.
    pub const fn of<R: Rival>() -> Self {
        Self {
            card: &R::CARD,
            needs: R::Knows::NEEDS
                .and(<R::Sees<'static> as Sees>::NEEDS)
                .and(<R::Wants<'static> as Wants>::NEEDS),
            scalars: R::SCALARS,
            edition: "",
            build: Build::Rival(|tuning, supply| {
                Ok(Box::new(Handed(R::new(tuning, R::Knows::of(supply)?)?)))
            }),
            condition: R::condition,
            optimality: R::optimality,
            bound: R::bound,
        }
    }

    /// A law that is not of this crate: what it needs is what its author says. It makes no claim that could be checked.
    /// Its `edition` must change whenever the law does.
    pub const fn own(
        card: &'static Card,
        needs: Needs,
        scalars: &'static [Scalar],
        edition: &'static str,
        make: &'static Make,
    ) -> Self {
        Self {
            card,
            needs,
            scalars,
            edition,
            build: Build::Own(make),
            condition: |_, _| None,
            optimality: |_| None,
            bound: |_, _| None,
        }
    }

    /// Builds the rival, handing it what it declares to need.
    ///
    /// # Errors
    ///
    /// [`RivalRefusal`]: the law does not apply to this arm, or not with this tuning.
    pub fn build(
        &self,
        tuning: &Tuning,
        supply: &Supply,
    ) -> Result<Box<dyn Running>, RivalRefusal> {
        match self.build {
            Build::Rival(build) => build(tuning, supply),
            Build::Own(make) => make(tuning, supply),
        }
    }

    /// Free choices of its inputs, in addition to its own scalars, and the number of these with ranges that
    /// may give way; they come first. The default values are the inputs with
    /// [`build_with_friction`](Self::build_with_friction).
    ///
    /// A factor on the nominal inertia for a law that has it in itself and no such factor of its own; the
    /// cut-off of the filter on its velocity, on its position if it takes no velocity; and for a law that
    /// takes a torque, whether that is the one that acted or the one commanded last. Gains that were designed
    /// for the loop as it is leave nothing free.
    pub fn choices(&self, sensed: SensedChoice) -> (Vec<Scalar>, usize) {
        choice::scalars(&self.needs, self.scalars, sensed)
    }

    /// Values of [`choices`](Self::choices), in their order, taken apart; none at all: as the law declares it.
    ///
    /// # Errors
    ///
    /// [`Refusal::Tuning`]: another number of values, or one that is not above 0 and finite.
    pub fn chosen(&self, values: &[f64]) -> Result<Chosen, RivalRefusal> {
        Chosen::of(&self.needs, self.scalars, values)
    }

    /// Builds the rival with identified dry friction as feed-forward along the reference's velocity, where it
    /// is one that takes a model and has no feed-forward of friction itself; any other is built as it is.
    ///
    /// # Errors
    ///
    /// As [`build`](Self::build).
    pub fn build_with_friction(
        &self,
        tuning: &Tuning,
        supply: &Supply,
    ) -> Result<Box<dyn Running>, RivalRefusal> {
        self.build_as_chosen(tuning, supply, &Chosen::default())
    }

    /// The same with choices of its inputs. The filter of a velocity is the sensors' own: the caller sets it
    /// there, by [`Chosen::velocity_filter_hz`].
    ///
    /// # Errors
    ///
    /// As [`build`](Self::build).
    pub fn build_as_chosen(
        &self,
        tuning: &Tuning,
        supply: &Supply,
        chosen: &Chosen,
    ) -> Result<Box<dyn Running>, RivalRefusal> {
        let law = match chosen.inertia_share {
            Some(share) => {
                let mut handed = supply.clone();
                handed.inertia.iter_mut().for_each(|inertia| *inertia *= share);
                self.build(tuning, &handed)?
            }
            None => self.build(tuning, supply)?,
        };
        let law = chosen.before(law, &self.needs, (supply.joints(), tuning.period()));
        if !self.needs.model || self.needs.dry || self.needs.derivatives == 0 {
            return Ok(law);
        }
        Ok(Box::new(WithFriction::new(law, supply)?))
    }

    /// See [`Rival::condition`].
    pub fn condition(&self, tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        (self.condition)(tuning, arm)
    }

    /// See [`Rival::optimality`].
    pub fn optimality(&self, tuning: &Tuning) -> Option<Condition> {
        (self.optimality)(tuning)
    }

    /// See [`Rival::bound`].
    pub fn bound(&self, tuning: &Tuning, arm: &DeclaredArm) -> Option<Vec<f64>> {
        (self.bound)(tuning, arm)
    }
}
