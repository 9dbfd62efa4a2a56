//! Free choices of the inputs of laws, alike for all that use them.

use core::f64::consts::TAU;

use crate::error::RivalRefusal;
use crate::handed::All;
use crate::needs::Needs;
use crate::running::Running;
use crate::tuning::Scalar;

/// Something that is free in what a law is handed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Choice {
    Inertia,
    Filter,
    Torque,
}

/// The name of the factor on the nominal inertia, under which some laws have it among their own scalars.
const INERTIA_SHARE: &str = "inertia_share";

/// The least cut-off \[Hz\].
const FILTER_MIN: f64 = 5.0;

/// Free choices for a law with these needs: none for gains that were designed for the loop as it is; a factor
/// on `M̄` where the law has it and no such factor of its own; the sensors' filter for all; which torque for
/// a law that takes one.
fn offered(needs: &Needs, scalars: &[Scalar]) -> impl Iterator<Item = Choice> {
    let own = scalars.iter().any(|scalar| scalar.name == INERTIA_SHARE);
    let free = !needs.designed;
    let inertia = free && needs.inertia && !own;
    let torque = free && needs.torque != needs.commanded;
    let all = [(inertia, Choice::Inertia), (free, Choice::Filter), (torque, Choice::Torque)];
    all.into_iter().filter_map(|(free, choice)| free.then_some(choice))
}

/// The loop that a law is handed measurements of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensedChoice {
    /// Samples per second \[Hz\].
    pub rate_hz: f64,
    /// Cut-off of the velocity's filter as it is \[Hz\]; `None`: not filtered.
    pub velocity_filter_hz: Option<f64>,
}

/// Free choices for a law, as scalars whose default values are its inputs without a choice; those whose
/// ranges may give way come first, and their number is returned.
pub(crate) fn scalars(needs: &Needs, own: &[Scalar], sensed: SensedChoice) -> (Vec<Scalar>, usize) {
    let scalar = |choice| match choice {
        Choice::Inertia => Scalar {
            name: INERTIA_SHARE,
            unit: "",
            meaning: "M̄ over the joint's nominal inertia",
            default: 1.0,
            low: 0.1,
            high: 10.0,
        },
        Choice::Filter => Scalar {
            name: "sensor_filter",
            unit: "Hz",
            meaning: "cut-off of the velocity, of the position for a law without one; none from half of the rate on",
            default: sensed.velocity_filter_hz.filter(|_| needs.velocity).unwrap_or_else(|| {
                // The middle of what counts as none.
                sensed.rate_hz * 0.5_f64.sqrt()
            }),
            low: FILTER_MIN,
            high: sensed.rate_hz,
        },
        Choice::Torque => Scalar {
            name: "torque_fed",
            unit: "",
            meaning: "below 1 the torque that acted, else the one commanded last",
            default: if needs.commanded { 2.0 } else { 0.5 },
            low: 0.1,
            high: 10.0,
        },
    };
    let all: Vec<Scalar> = offered(needs, own).map(scalar).collect();
    let wide = all.iter().take_while(|scalar| scalar.name == INERTIA_SHARE).count();
    (all, wide)
}

/// Values of what is free for a law; what is `None` is as the law declares it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Chosen {
    /// The nominal inertia in the law over the joint's.
    pub inertia_share: Option<f64>,
    /// Cut-off of the velocity's filter, or, for a law that takes none, of the position's \[Hz\].
    pub filter_hz: Option<f64>,
    /// True if a law that takes a torque receives the one commanded last, not the one that acted.
    pub commanded: Option<bool>,
}

impl Chosen {
    pub(crate) fn of(needs: &Needs, own: &[Scalar], values: &[f64]) -> Result<Self, RivalRefusal> {
        let free: Vec<Choice> = offered(needs, own).collect();
        if values.is_empty() {
            return Ok(Self::default());
        }
        if values.len() != free.len() || values.iter().any(|v| !(v.is_finite() && *v > 0.0)) {
            let why = format!("{values:?} for {} choices of what it is handed", free.len());
            return Err(RivalRefusal::Tuning(why));
        }
        let mut chosen = Self::default();
        for (choice, value) in free.into_iter().zip(values) {
            match choice {
                Choice::Inertia => chosen.inertia_share = Some(*value),
                Choice::Filter => chosen.filter_hz = Some(*value),
                Choice::Torque => chosen.commanded = Some(*value >= 1.0),
            }
        }
        Ok(chosen)
    }

    /// The cut-off of the velocity's filter \[Hz\] where the sensors have one: below half of the rate.
    pub fn velocity_filter_hz(&self, rate_hz: f64) -> Option<f64> {
        self.filter_hz.filter(|cutoff| *cutoff < 0.5 * rate_hz)
    }

    /// The law behind these choices; the law itself where they leave all samples as they are.
    pub(crate) fn before(
        &self,
        law: Box<dyn Running>,
        needs: &Needs,
        (joints, period): (usize, f64),
    ) -> Box<dyn Running> {
        let cutoff = self.velocity_filter_hz(1.0 / period).filter(|_| !needs.velocity);
        let share = cutoff.map(|cutoff| -(-TAU * cutoff * period).exp_m1());
        let swaps = self.commanded.is_some_and(|commanded| commanded != needs.commanded);
        if share.is_none() && !swaps {
            return law;
        }
        Box::new(AsChosen { law, share, swaps, q: vec![0.0; joints], started: false })
    }
}

/// A law that is fed with the other torque, or with positions behind a low-pass of first order.
#[derive(Debug)]
struct AsChosen {
    law: Box<dyn Running>,
    /// Share of the way to the measured position that is gone in one sample.
    share: Option<f64>,
    swaps: bool,
    q: Vec<f64>,
    started: bool,
}

impl Running for AsChosen {
    fn update(&mut self, all: &All<'_>, tau: &mut [f64]) {
        let mut seen = *all;
        if self.swaps {
            (seen.tau, seen.commanded) = (all.commanded, all.tau);
        }
        if let Some(share) = self.share {
            let share = if self.started { share } else { 1.0 };
            for (q, measured) in self.q.iter_mut().zip(all.q) {
                *q += share * (measured - *q);
            }
            self.started = true;
            seen.q = &self.q;
        }
        self.law.update(&seen, tau);
    }

    fn states(&self) -> usize {
        self.law.states() + if self.share.is_some() { self.q.len() } else { 0 }
    }
}
