//! The search between the points of the grid.

use phihat_certificate::extremes::Extremes as _;

use super::candidate::{Candidate, LawShape};
use super::search::DesignSearch;
use super::verdict::ClauseVerdict;

/// First steps in `ln ω`, `ln ω_o/ω`, the share of the factor on `M̄`, and `ln` of the velocity filter.
const STEPS: [f64; 4] = [0.09, 0.15, 0.25, 0.2];

/// Halvings of the steps, and candidates that are looked at.
const HALVINGS: u32 = 4;
const MOST: u32 = 160;

/// Share that one clause uses when all others are satisfied; far more when they are not.
pub(super) fn cost(verdict: &ClauseVerdict, clause: usize) -> f64 {
    let share = |i: usize| {
        let share = verdict.shares[i].0;
        if share.is_nan() { f64::INFINITY } else { share }
    };
    let others = (0..verdict.shares.len()).filter(|i| *i != clause);
    let worst = others.map(share).largest();
    if worst <= 1.0 { share(clause) } else { 1e6 * worst }
}

impl DesignSearch<'_> {
    /// From a candidate, step by step along each parameter, to the least cost of a clause; every candidate
    /// on the way is shown.
    pub(super) fn refine(
        &self,
        start: &Candidate,
        clause: usize,
        mut show: impl FnMut(&Candidate, &ClauseVerdict),
    ) {
        let designed = self.study.sensor.velocity_filter_designed;
        let mut best = start.clone();
        let mut least = cost(&self.judge(&best), clause);
        let mut looked = 0;
        let mut scale = 1.0;
        for _ in 0..HALVINGS {
            loop {
                let mut moved = false;
                for (i, step) in STEPS.iter().enumerate().take(if designed { 4 } else { 3 }) {
                    for sign in [1.0, -1.0] {
                        looked += 1;
                        let Some(next) = self.step(&best, i, sign * step * scale) else { continue };
                        let verdict = self.judge(&next);
                        show(&next, &verdict);
                        let now = cost(&verdict, clause);
                        if now < least * (1.0 - 1e-6) {
                            (best, least, moved) = (next, now, true);
                            break;
                        }
                    }
                }
                if !moved || looked > MOST {
                    break;
                }
            }
            scale *= 0.5;
        }
    }

    fn step(&self, from: &Candidate, parameter: usize, by: f64) -> Option<Candidate> {
        let LawShape { mut w, order, mut ratio, mut filter_hz } = from.shape;
        let mut share = from.share;
        match parameter {
            0 => w = (w * libm::exp(by)).max(self.slowest),
            1 => ratio *= libm::exp(by),
            2 => share = (share + by).clamp(0.0, 1.0),
            _ => {
                let half = 0.5e9 / self.study.control.period_ns as f64;
                filter_hz = filter_hz.map(|hz| (hz * libm::exp(by)).min(half));
            }
        }
        self.loops.candidates_of(LawShape { w, order, ratio, filter_hz }, &[share]).pop()
    }
}
