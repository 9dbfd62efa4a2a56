//! One search for gains: the quietest law of a grid that keeps the specification, or one between its points.

use phihat_certificate::extremes::Extremes as _;

use super::candidate::Candidate;
use super::error::DesignError;
use super::refine::cost;
use super::search::{DesignSearch, Grid};
use super::verdict::{ClauseVerdict, KEYS, Nearest};
use crate::{Gains, TradeOff};

/// One search for gains.
pub(super) struct Attempt {
    pub(super) gains: Option<Gains>,
    pub(super) nearest: Nearest,
    pub(super) tried: u32,
    pub(super) stable: u32,
    /// The front of the grid, the closest law on it.
    pub(super) front: Vec<TradeOff>,
    /// The law that misses the least, by its worst clause.
    closest: Option<(f64, Candidate)>,
    /// Largest bandwidth of the grid that keeps window and margin \[rad/s\].
    pub(super) fastest: Option<f64>,
}

impl Attempt {
    /// Judges a grid, the quietest first, then searches between its points.
    pub(super) fn of(search: &DesignSearch<'_>, grid: &Grid) -> Result<Self, DesignError> {
        let (mut candidates, tried) = search.candidates(grid);
        candidates.sort_by(|a, b| a.noise().total_cmp(&b.noise()));
        let stable = u32::try_from(candidates.len()).unwrap_or(u32::MAX);
        let fastest = candidates.iter().map(|candidate| candidate.shape.w);
        let fastest = fastest.reduce(|a, b| if b > a { b } else { a });
        let (nearest, front) = (Nearest::default(), Vec::new());
        let mut found = Self { gains: None, nearest, tried, stable, front, closest: None, fastest };
        let mut verdicts = Vec::with_capacity(candidates.len());
        for candidate in &candidates {
            let verdict = search.judge(candidate);
            if verdict.within() && found.take(search, &candidates, candidate)? {
                return Ok(found);
            }
            found.note(candidate, &verdict);
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
                    found.note(candidate, verdict);
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
        if let Some((_, closest)) = &found.closest {
            let mut all = candidates;
            let at = all.partition_point(|other| other.noise() < closest.noise());
            all.insert(at, closest.clone());
            found.front = search.trade_off(&all, closest);
        }
        Ok(found)
    }

    /// The law that misses the least.
    pub(super) fn closest(&self, search: &DesignSearch<'_>) -> Option<Box<Gains>> {
        self.closest.as_ref().map(|(_, candidate)| Box::new(search.gains(candidate)))
    }

    fn note(&mut self, candidate: &Candidate, verdict: &ClauseVerdict) {
        self.nearest.note(verdict);
        let worst = verdict.shares.iter().map(|(share, _)| *share).largest();
        if self.closest.as_ref().is_none_or(|(least, _)| worst < *least) {
            self.closest = Some((worst, candidate.clone()));
        }
    }

    /// Takes a candidate if its certificate keeps the specification too.
    fn take(
        &mut self,
        search: &DesignSearch<'_>,
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
