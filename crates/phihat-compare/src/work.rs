//! Amount of work in the parts of a plan, for reports of progress.

use crate::plan::ComparisonPlan;
use crate::world::TRAINING;

impl ComparisonPlan {
    /// The share of the whole work that the first `done` of its jobs are, 0 to 1: a tuning is many runs, a run
    /// that counts is one.
    pub fn share_done(&self, done: usize) -> f64 {
        let extent = &self.extent;
        let seconds = |arm: usize| self.span(arm).0;
        let arms = self.arms.len();
        let scored = (0..arms).map(seconds).sum::<f64>() / arms.max(1) as f64;
        let evaluations = extent.tuning_runs as f64 * extent.training_motions as f64;
        // Tunings and draws take turns; a draw has one motion.
        let training = TRAINING.len() as f64 * extent.training_s;
        let prepared = 0.5 * (evaluations + extent.draws as f64) * training;
        let first = 2 * self.pairs().len();
        let later = first * self.worlds.len() * usize::try_from(extent.seeds).unwrap_or(1);
        let work = |jobs: usize| {
            prepared * jobs.min(first) as f64 + scored * jobs.saturating_sub(first) as f64
        };
        let whole = work(first + later);
        if whole > 0.0 { (work(done) / whole).min(1.0) } else { 1.0 }
    }
}
