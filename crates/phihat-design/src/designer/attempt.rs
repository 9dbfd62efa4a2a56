//! One search for gains: the quietest law of a grid that keeps the specification, or one between its points.

use super::candidate::Candidate;
use super::error::DesignError;
use super::refine::cost;
use super::search::{Grid, Search};
use super::verdict::{KEYS, Nearest};
use crate::Gains;

/// One search for gains.
pub(super) struct Attempt {
    pub(super) gains: Option<Gains>,
    pub(super) nearest: Nearest,
    pub(super) tried: u32,
    pub(super) stable: u32,
}

impl Attempt {
    /// Judges a grid, the quietest first, then searches between its points.
    pub(super) fn of(search: &Search<'_>, grid: &Grid) -> Result<Self, DesignError> {
        let (mut candidates, tried) = search.candidates(grid);
        candidates.sort_by(|a, b| a.noise().total_cmp(&b.noise()));
        let stable = u32::try_from(candidates.len()).unwrap_or(u32::MAX);
        let mut found = Self { gains: None, nearest: Nearest::default(), tried, stable };
        let mut verdicts = Vec::with_capacity(candidates.len());
        for candidate in &candidates {
            let verdict = search.judge(candidate);
            if verdict.within() && found.take(search, &candidates, candidate)? {
                return Ok(found);
            }
            found.nearest.note(&verdict);
            verdicts.push(verdict);
        }
        for clause in (0..KEYS.len()).filter(|clause| search.limit(*clause).is_some()) {
            for &order in &search.study.design.orders {
                let of_order =
                    (0..candidates.len()).filter(|i| candidates[*i].shape.order == order);
                let price = |i: &usize| cost(&verdicts[*i], clause);
                let Some(start) = of_order.min_by(|a, b| price(a).total_cmp(&price(b))) else {
                    continue;
                };
                if price(&start) > grid.reach {
                    continue;
                }
                let (mut quietest, mut closest): (Option<Candidate>, Option<(f64, Candidate)>) =
                    (None, None);
                search.refine(&candidates[start], clause, |candidate, verdict| {
                    found.nearest.note(verdict);
                    if !verdict.within() {
                        return;
                    }
                    let cost = cost(verdict, clause);
                    if quietest.as_ref().is_none_or(|q| candidate.noise() < q.noise()) {
                        quietest = Some(candidate.clone());
                    }
                    if closest.as_ref().is_none_or(|(least, _)| cost < *least) {
                        closest = Some((cost, candidate.clone()));
                    }
                });
                // The estimate that is furthest inside may hold where the quietest does not.
                for candidate in quietest.iter().chain(closest.iter().map(|(_, c)| c)) {
                    if found.take(search, &candidates, candidate)? {
                        return Ok(found);
                    }
                }
            }
        }
        Ok(found)
    }

    /// Takes a candidate if its certificate keeps the specification too.
    fn take(
        &mut self,
        search: &Search<'_>,
        candidates: &[Candidate],
        chosen: &Candidate,
    ) -> Result<bool, DesignError> {
        let Some(mut gains) = search.certify(chosen)? else { return Ok(false) };
        let mut all = candidates.to_vec();
        if !all.contains(chosen) {
            let at = all.partition_point(|other| other.noise() < chosen.noise());
            all.insert(at, chosen.clone());
        }
        gains.trade_off = search.trade_off(&all, chosen);
        self.gains = Some(gains);
        Ok(true)
    }
}
