//! A run that counts: its name, its id, its study, and what it comes to.

use phihat_sim::Outcome;
use phihat_study::Study;
use serde::{Deserialize, Serialize};

use super::ground::{CompareError, Task};
use super::judge::{Bars, judge, sketch};
use super::plan::{EDITION, Known, Plan};
use super::promise;
use super::record::Comparison;
use super::row::{Fate, Figures, GainsKind, Sketch, TuningRecord};
use super::trial::run;
use phihat_session::short_hash;

/// A run that counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Case {
    pub(crate) ground: usize,
    pub(crate) rival: usize,
    pub(crate) world: usize,
    pub(crate) gains: GainsKind,
    pub(crate) seed: u64,
}

/// What is recorded of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Scored {
    pub(crate) fate: Fate,
    pub(crate) figures: Option<Figures>,
    pub(crate) sketch: Option<Sketch>,
}

impl Plan {
    /// The name of a run.
    pub(crate) fn name(&self, case: &Case) -> String {
        let gains = match case.gains {
            GainsKind::Default => "default",
            GainsKind::Tuned => "tuned",
        };
        let (ground, rival) = (&self.grounds[case.ground], self.rivals[case.rival]);
        format!(
            "{}/{}/{}/{gains}/{}",
            ground.name, rival.card.id, self.worlds[case.world].name, case.seed
        )
    }

    pub(crate) fn case_id(&self, case: &Case, known: &[Known]) -> String {
        let values = self.values(case, known).map(|values| format!("{values:?}"));
        let span = self.span(case.ground);
        short_hash(&[
            EDITION,
            env!("CARGO_PKG_VERSION"),
            &self.grounds[case.ground].study.sha256,
            &self.name(case),
            &values.unwrap_or_default(),
            &format!("{span:?}"),
        ])
    }

    /// The gains of a run.
    fn values<'k>(&self, case: &Case, known: &'k [Known]) -> Option<&'k [f64]> {
        let place = case.ground * self.rivals.len() + case.rival;
        let tuning = known[place].tuning.as_ref().ok()?;
        Some(of_kind(tuning, case.gains))
    }

    /// The study of a run that counts.
    fn study(&self, case: &Case) -> Result<Study, CompareError> {
        let (ground, world) = (&self.grounds[case.ground], self.worlds[case.world]);
        ground.in_world(world, Task::Score(case.seed), self.span(case.ground))
    }

    pub(crate) fn score(&self, case: &Case, known: &[Known]) -> Scored {
        let refused =
            |why: String| Scored { fate: Fate::Refused(why), figures: None, sketch: None };
        let place = case.ground * self.rivals.len() + case.rival;
        let values = match &known[place].tuning {
            Ok(tuning) => of_kind(tuning, case.gains),
            Err(why) => return refused(why.clone()),
        };
        let (ground, entry) = (&self.grounds[case.ground], self.rivals[case.rival]);
        let study = match self.study(case) {
            Ok(study) => study,
            Err(e) => return refused(e.to_string()),
        };
        let bound = promise::bound(ground, entry, values, &study);
        let bars =
            Bars { error_max: &ground.error_max, limits: &ground.limits, bound: bound.as_deref() };
        match run(ground, entry, values, &study) {
            Ok(trial) => {
                let (fate, figures) = judge(&study, &trial.outcome, trial.broken, &bars);
                let sketch = (case.seed == 1).then(|| sketch(&trial.outcome.trace)).flatten();
                Scored { fate, figures, sketch }
            }
            Err(e) => refused(e.to_string()),
        }
    }

    /// Repeats a run of a comparison by its name, with everything that it leaves: its study and its outcome.
    ///
    /// # Errors
    ///
    /// [`CompareError`]: there is no such run, or it cannot begin.
    pub fn repeat(
        &self,
        comparison: &Comparison,
        name: &str,
    ) -> Result<(Study, Outcome), CompareError> {
        let unknown = || CompareError::Run(name.to_owned());
        let cases = self.cases();
        let case = cases.iter().find(|case| self.name(case) == name).ok_or_else(unknown)?;
        let (ground, entry) = (&self.grounds[case.ground], self.rivals[case.rival]);
        let mut rows = comparison.rows_of(&ground.name);
        let row = rows.find(|row| row.rival == entry.card.id).ok_or_else(unknown)?;
        let tuning = row.tuning.as_ref().ok_or_else(unknown)?;
        let study = self.study(case)?;
        let trial = run(ground, entry, of_kind(tuning, case.gains), &study)
            .map_err(|e| CompareError::Begin(e.into()))?;
        Ok((study, trial.outcome))
    }
}

pub(crate) fn of_kind(tuning: &TuningRecord, gains: GainsKind) -> &[f64] {
    match gains {
        GainsKind::Default => &tuning.default,
        GainsKind::Tuned => &tuning.tuned,
    }
}
