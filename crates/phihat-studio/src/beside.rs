//! Another law beside phihat's, on the same arm, in the same world, with the same noise.

use phihat_compare::{Adapter, NOMINAL_MASSES, supply};
use phihat_rivals::{Entry, Needs, RIVALS, Tuning, rival};
use phihat_sim::{ControlSide, Simulation, WorldSide};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::begin::Begin;
use crate::error::StudioError;

/// A law with its free scalars.
#[derive(Debug, Clone)]
pub struct AlongsideLaw {
    entry: &'static Entry,
    values: Vec<f64>,
}

/// Request of a page: a law by its name, with its scalars in the law's order, or as published where none are
/// given; no law: the arm is alone again.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Wanted {
    law: Option<String>,
    #[serde(default)]
    values: Vec<f64>,
}

impl Wanted {
    pub(crate) fn beside(&self) -> Result<Option<AlongsideLaw>, StudioError> {
        self.law.as_deref().map(|law| AlongsideLaw::new(law, &self.values)).transpose()
    }
}

/// Laws on offer: those of `phihat compare` that need no design of their own and follow the motion in time.
fn on_offer() -> impl Iterator<Item = &'static Entry> {
    let plain = |needs: &Needs| !needs.designed && (!needs.orbit || needs.derivatives > 0);
    RIVALS.iter().filter(move |entry| plain(&entry.needs))
}

/// The laws on offer with their scalars, as a page reads them.
pub(crate) fn laws() -> Value {
    let law = |entry: &Entry| {
        let card = entry.card;
        json!({ "id": card.id, "title": card.title, "law": card.law, "scalars": entry.scalars,
            "model": entry.needs.model || entry.needs.gravity || entry.needs.regressor })
    };
    on_offer().map(law).collect()
}

impl AlongsideLaw {
    /// A law of `phihat compare` by its name, with its scalars in their order; none: as published.
    ///
    /// # Errors
    ///
    /// [`StudioError`]: there is no such law on offer, or a scalar is out of its range.
    pub fn new(law: &str, values: &[f64]) -> Result<Self, StudioError> {
        let entry = rival(law).filter(|entry| on_offer().any(|one| one.card.id == entry.card.id));
        let entry = entry.ok_or_else(|| StudioError::refused("no law of this name is on offer"))?;
        let published = || entry.scalars.iter().map(|scalar| scalar.default).collect();
        let values = if values.is_empty() { published() } else { values.to_vec() };
        if values.len() != entry.scalars.len() {
            let (given, has) = (values.len(), entry.scalars.len());
            return Err(StudioError::refused(format!("{law}: {given} scalars, it has {has}")));
        }
        for (scalar, value) in entry.scalars.iter().zip(&values) {
            let (low, high) = (scalar.low.min(scalar.default), scalar.high.max(scalar.default));
            if !(low..=high).contains(value) {
                let why = format!("{law}: {} is {low} to {high} {}", scalar.name, scalar.unit);
                return Err(StudioError::refused(why));
            }
        }
        Ok(Self { entry, values })
    }

    /// Name for people.
    pub(crate) fn title(&self) -> &'static str {
        self.entry.card.title
    }

    /// Its control side and a world for it. Units are the gains' nominal inertia; the links of a model are too light
    /// by as much as in `phihat compare`.
    pub(crate) fn sides(&self, begin: &Begin) -> Result<(ControlSide, WorldSide), StudioError> {
        let study = &begin.study;
        let told =
            |why: &dyn std::fmt::Display| StudioError::refused(format!("{}: {why}", self.title()));
        let units: Vec<f64> = begin.gains.joints.iter().map(|joint| joint.inertia_kg_m2).collect();
        let period = study.control.period_ns as f64 * 1e-9;
        let tuning = Tuning::new(&self.values, &units, period).map_err(|why| told(&why))?;
        let supply = supply(study, &units, NOMINAL_MASSES).map_err(|why| told(&why))?;
        let law = self.entry.build(&tuning, &supply).map_err(|why| told(&why))?;
        let mut driver = Adapter::new(law, units.len());
        if self.entry.needs.preview {
            driver = driver.with_preview(study)?;
        }
        Ok(Simulation::driven(study, driver, &units)?.apart())
    }
}

#[cfg(test)]
mod tests {
    use super::{AlongsideLaw, on_offer};

    #[test]
    fn laws_on_offer_take_their_published_scalars_and_refuse_others() {
        assert!(on_offer().count() > 20);
        for entry in on_offer() {
            assert!(AlongsideLaw::new(entry.card.id, &[]).is_ok(), "{}", entry.card.id);
            let many = vec![1.0; entry.scalars.len() + 1];
            assert!(AlongsideLaw::new(entry.card.id, &many).is_err(), "{}", entry.card.id);
            for not in [f64::NAN, f64::INFINITY, -1.0, 0.0, 1e300] {
                let wrong = vec![not; entry.scalars.len()];
                let refused =
                    entry.scalars.is_empty() || AlongsideLaw::new(entry.card.id, &wrong).is_err();
                assert!(refused, "{} took {not}", entry.card.id);
            }
        }
        assert!(AlongsideLaw::new("nobody's", &[]).is_err());
    }
}
