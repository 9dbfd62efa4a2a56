//! Runs that count: their gains, their studies, and what they come to.

use phihat_session::short_hash;
use phihat_sim::SimulationOutcome;
use phihat_study::Study;

use crate::arm_in_world::ComparisonTask;
use crate::case::{ComparisonCase, Scored};
use crate::error::CompareError;
use crate::judge::{Bars, judge, sketch};
use crate::plan::{ComparisonPlan, EDITION, with_edition};
use crate::prepare::Preparation;
use crate::promise;
use crate::record::Comparison;
use crate::row::{GainsKind, TuningRecord};
use crate::run_outcome::RunOutcome;
use crate::trial::run;

impl ComparisonPlan {
    /// Equal ids, equal outcomes: an edition, the arm's text, the run's name, its gains, its length.
    pub(crate) fn case_id(&self, case: &ComparisonCase, known: &[Preparation]) -> String {
        let values = self.values(case, known).map(|values| format!("{values:?}"));
        let (values, span) = (values.unwrap_or_default(), format!("{:?}", self.span(case.arm)));
        let (sum, name) = (&self.arms[case.arm].study.sha256, self.name(case));
        let parts = [EDITION, env!("CARGO_PKG_VERSION"), sum, &name, &values, &span];
        short_hash(&with_edition(&parts, self.rivals[case.rival].edition))
    }

    /// The gains of a run.
    fn values<'k>(&self, case: &ComparisonCase, known: &'k [Preparation]) -> Option<&'k [f64]> {
        let place = case.arm * self.rivals.len() + case.rival;
        let tuning = known[place].tuning.as_ref().ok()?;
        Some(of_kind(tuning, case.gains))
    }

    /// The study of a run that counts.
    fn study(&self, case: &ComparisonCase) -> Result<Study, CompareError> {
        let (arm, world) = (&self.arms[case.arm], self.worlds[case.world]);
        arm.in_world(world, ComparisonTask::Score(case.seed), self.span(case.arm))
    }

    pub(crate) fn score(&self, case: &ComparisonCase, known: &[Preparation]) -> Scored {
        let refused =
            |why: String| Scored { outcome: RunOutcome::Refused(why), figures: None, sketch: None };
        let place = case.arm * self.rivals.len() + case.rival;
        let values = match &known[place].tuning {
            Ok(tuning) => of_kind(tuning, case.gains),
            Err(why) => return refused(why.to_string()),
        };
        let (arm, entry) = (&self.arms[case.arm], self.rivals[case.rival]);
        let study = match self.study(case) {
            Ok(study) => study,
            Err(e) => return refused(e.to_string()),
        };
        let bound = promise::bound(arm, entry, values, &study);
        let bars =
            Bars { error_bound: &arm.error_bound, limits: &arm.limits, bound: bound.as_deref() };
        match run(arm, entry, values, &study) {
            Ok(trial) => {
                let (outcome, figures) = judge(&study, &trial.outcome, trial.broken, &bars);
                let sketch = (case.seed == 1).then(|| sketch(&trial.outcome.trace)).flatten();
                Scored { outcome, figures, sketch }
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
    ) -> Result<(Study, SimulationOutcome), CompareError> {
        let unknown = || CompareError::Run(name.to_owned());
        let cases = self.cases();
        let case = cases.iter().find(|case| self.name(case) == name).ok_or_else(unknown)?;
        let (arm, entry) = (&self.arms[case.arm], self.rivals[case.rival]);
        let mut rows = comparison.rows_of(&arm.name);
        let row = rows.find(|row| row.rival == entry.card.id).ok_or_else(unknown)?;
        let tuning = row.tuning.as_ref().ok_or_else(unknown)?;
        let study = self.study(case)?;
        let trial = run(arm, entry, of_kind(tuning, case.gains), &study)
            .map_err(|e| CompareError::Begin(e.into()))?;
        Ok((study, trial.outcome))
    }
}

fn of_kind(tuning: &TuningRecord, gains: GainsKind) -> &[f64] {
    match gains {
        GainsKind::Default => &tuning.default,
        GainsKind::Tuned => &tuning.tuned,
    }
}
