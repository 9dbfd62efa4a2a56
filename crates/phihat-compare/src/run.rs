//! A plan, run: preparation, then the runs that count, then the table.

use phihat_campaign::{Journal, Progress, RunEnded, run_all};
use phihat_session::short_hash;

use crate::error::CompareError;
use crate::plan::{ComparisonPlan, EDITION, with_edition};
use crate::prepare::{Preparation, PreparedArm, Untuned, drawn, tuned};
use crate::record::Comparison;
use crate::rows;

impl ComparisonPlan {
    /// Does everything that the journal does not hold, on `threads` threads. The answer does not depend on
    /// their number, nor on interruptions.
    ///
    /// `progress` is called for both parts, preparation and runs that count, in one figure.
    ///
    /// # Errors
    ///
    /// [`CompareError::Journal`] when the journal cannot be written.
    pub fn run(
        &self,
        journal: &mut Journal,
        threads: usize,
        mut progress: impl FnMut(Progress),
    ) -> Result<Comparison, CompareError> {
        let pairs = self.pairs();
        let cases = self.cases();
        let later = cases.len();
        // Tunings and draws in turn.
        let jobs: Vec<_> =
            pairs.iter().flat_map(|(g, r)| [(*g, *r, false), (*g, *r, true)]).collect();
        let ids: Vec<_> = jobs.iter().map(|job| self.preparation_id(*job)).collect();
        let prepare = |place: usize| {
            let (arm, rival, draws) = jobs[place];
            let (arm, entry) = (&self.arms[arm], self.rivals[rival]);
            let how = if draws { drawn } else { tuned };
            how(arm, entry, &self.extent)
        };
        let whole = |p: Progress| Progress { all: p.all + later, ..p };
        let prepared = run_all(&ids, journal, threads, &prepare, |p| progress(whole(p)))?;
        let known: Vec<Preparation> = prepared.chunks(2).map(preparation).collect();
        let before = jobs.len();
        let ids: Vec<_> = cases.iter().map(|case| self.case_id(case, &known)).collect();
        let score = |place: usize| self.score(&cases[place], &known);
        let whole = |p: Progress| Progress {
            resumed: p.resumed + before,
            done: p.done + before,
            all: p.all + before,
        };
        let scored = run_all(&ids, journal, threads, &score, |p| progress(whole(p)))?;
        Ok(rows::comparison(self, &known, &cases, scored))
    }

    /// Does everything on this thread, and leaves nothing on the disk; `progress` is told the share that is done.
    pub fn run_in_memory(&self, progress: &dyn Fn(f64)) -> Comparison {
        let (pairs, cases) = (self.pairs(), self.cases());
        // A preparation takes about as long as four runs that count.
        let all = (4 * pairs.len() + cases.len()).max(1) as f64;
        let mut known = Vec::with_capacity(pairs.len());
        for (arm, rival) in &pairs {
            let (arm, entry) = (&self.arms[*arm], self.rivals[*rival]);
            let both = [tuned(arm, entry, &self.extent), drawn(arm, entry, &self.extent)];
            known.push(preparation(&both.map(RunEnded::With)));
            progress(4.0 * known.len() as f64 / all);
        }
        let mut scored = Vec::with_capacity(cases.len());
        for case in &cases {
            scored.push(RunEnded::With(self.score(case, &known)));
            progress((4 * known.len() + scored.len()) as f64 / all);
        }
        rows::comparison(self, &known, &cases, scored)
    }

    /// Equal ids, equal outcomes: an edition, the arm's text, the rival's scalars, the extent of the preparation.
    fn preparation_id(&self, (arm, rival, draws): (usize, usize, bool)) -> String {
        let (arm, entry, extent) = (&self.arms[arm], self.rivals[rival], &self.extent);
        let training = (extent.training_motions, extent.training_s, extent.training_settle_s);
        let count = if draws { [extent.draws, 0] } else { [extent.tuning_runs, extent.widenings] };
        let (scalars, extent) =
            (format!("{:?}", entry.scalars), format!("{draws} {count:?} {training:?}"));
        let (sum, name) = (&arm.study.sha256, &arm.name);
        let parts =
            [EDITION, env!("CARGO_PKG_VERSION"), sum, name, entry.card.id, &scalars, &extent];
        short_hash(&with_edition(&parts, entry.edition))
    }
}

/// A tuning and the draws after it, put together.
fn preparation(pair: &[RunEnded<PreparedArm>]) -> Preparation {
    let mut known = Preparation { tuning: Err(Untuned::NotDone), share: 0.0 };
    for ended in pair {
        match ended {
            RunEnded::With(PreparedArm::Tuned(record)) => known.tuning = Ok(record.clone()),
            RunEnded::With(PreparedArm::Drawn(share)) => known.share = *share,
            RunEnded::With(PreparedArm::Refused(why)) => {
                known.tuning = Err(Untuned::Refused(why.clone()));
            }
            RunEnded::Panicked(why) => known.tuning = Err(Untuned::Panicked(why.clone())),
        }
    }
    known
}
