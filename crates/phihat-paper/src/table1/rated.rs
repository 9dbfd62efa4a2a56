//! The columns of Table 1 that need runs: the laws of its rows on one arm, tuned alike and measured.

use phihat_compare::{ArmCase, CompareError, ComparisonExtent, ComparisonPlan, Mark, MarkColumns};
use phihat_design::claims::Optimality;
use phihat_design::prelude::*;
use phihat_rivals::{Entry, Grade, Tuning};

use super::row::Table1Row;
use crate::gains::{K_TILDE, K_TILDE_H3, first, second_h3};
use crate::part::PartError;

/// The study of the comparison.
const STUDY: (&str, &str) =
    (include_str!("../../../../studies/table1.toml"), "studies/table1.toml");

/// A law of a row, and what was measured of it; `None`: it does not apply to this arm.
pub(super) struct Rated {
    pub(super) entry: &'static Entry,
    pub(super) columns: Option<MarkColumns>,
    /// Instructions per update, counted on this arm.
    pub(super) instructions: Option<u64>,
}

/// Every law of every row, in their order.
pub(super) fn rate(
    rows: &[Table1Row],
    progress: &dyn Fn(f64),
) -> Result<Vec<Vec<Rated>>, PartError> {
    let laws: Vec<&'static Entry> = rows.iter().flat_map(|row| row.laws.clone()).collect();
    let worlds = ["exact", "encoder", "payload", "friction"].map(str::to_owned).into();
    let extent =
        ComparisonExtent { worlds, tuning_runs: 30, widenings: 0, ..ComparisonExtent::quick() };
    let unfit = |why: CompareError| PartError::Comparison(Box::new(why));
    let mut plan = ComparisonPlan::of(&[], laws.clone(), extent).map_err(unfit)?;
    plan.arms = vec![ArmCase::from_text(STUDY.0, STUDY.1).map_err(unfit)?];
    let found = plan.run_in_memory(progress).rows;
    let of = |entry: &'static Entry| {
        let row = found.iter().find(|row| row.rival == entry.card.id);
        let instructions = row.and_then(|row| row.cost.as_ref()?.instructions);
        Rated { entry, columns: row.and_then(|row| row.columns.clone()), instructions }
    };
    Ok(rows.iter().map(|row| row.laws.iter().map(|entry| of(entry)).collect()).collect())
}

impl Rated {
    /// Returns true if the published law itself is known.
    pub(super) fn known(&self) -> bool {
        self.entry.card.grade != Grade::C
    }

    fn mark(&self, of: fn(&MarkColumns) -> Mark) -> Option<Mark> {
        self.columns.as_ref().map(of)
    }

    /// Returns true if a bound on the error is stated before a run.
    pub(super) fn bounded(&self) -> Option<bool> {
        self.mark(|columns| columns.quantitative.mark).map(|mark| mark != Mark::No)
    }

    /// Returns true if that bound was satisfied in every run and was at most ten times the measured error.
    pub(super) fn tightly(&self) -> Option<bool> {
        self.mark(|columns| columns.quantitative.mark).map(|mark| mark == Mark::Yes)
    }

    /// Returns true if a certificate, or the condition of the authors' proof, holds at the tuned gains.
    pub(super) fn optimal(&self) -> Option<bool> {
        self.mark(|columns| columns.optimal.mark).map(|mark| mark == Mark::Yes)
    }

    /// The same at the tuned gains or at the authors' own.
    pub(super) fn optimal_somewhere(&self) -> Option<bool> {
        Some(self.optimal()? || self.optimal_at_home())
    }

    fn optimal_at_home(&self) -> bool {
        if self.entry.card.reference == "proposed" {
            let laws = [(first(), K_TILDE), (second_h3(), K_TILDE_H3)];
            return laws.iter().all(|(law, k_tilde)| {
                Optimality::at(law, *k_tilde).is_ok_and(|claim| claim.certified().is_some())
            });
        }
        let default: Vec<f64> = self.entry.scalars.iter().map(|scalar| scalar.default).collect();
        let tuning = Tuning::new(&default, &[1.0; 3], 1e-3).ok();
        let condition = tuning.and_then(|tuning| self.entry.optimality(&tuning));
        condition.is_some_and(|condition| condition.holds)
    }

    /// Share of draws of gains that keep the specification.
    pub(super) fn share(&self) -> Option<f64> {
        self.columns.as_ref().map(|columns| columns.share_of_draws)
    }

    /// Number of gains to choose.
    pub(super) fn scalars(&self) -> f64 {
        self.entry.scalars.len() as f64
    }
}
