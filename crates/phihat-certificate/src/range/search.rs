//! Search for an end of a range of inertia: the cell with the worst bound is halved next.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::bound::{EndOfArm, OutsideRange, ProvedEnd, RangeCell, WIDEST};
use crate::extremes::{larger, smaller};
use crate::parallel::shared;

/// Factors of an end within which it is proved, one after the other: the second is inside of the usual margin of a
/// window.
const FACTORS: [f64; 6] = [1.5, 1.19, 1.09, 1.04, 1.02, 1.005];

/// Distance by which a posture has to pass an end that is stated, relative.
const PASSED: f64 = 1e-3;

/// Cells that are bounded together, of an arm with seven joints or fewer.
const TOGETHER: usize = 64;

/// Ends of a joint's travel \[rad, m\].
pub(super) type Travel = (f64, f64);

/// Cells that are left, worst first.
#[derive(Debug)]
pub(super) struct EndSearch {
    arm: EndOfArm,
    left: BinaryHeap<Ranked>,
    /// Cells that are bounded within the present factor.
    within: Vec<RangeCell>,
    /// Number of factors within which the end is proved.
    pub(super) stage: usize,
    stated: f64,
    /// Furthest eigenvalue of a posture, or the stated one.
    known: f64,
    /// Bound on the effect of rounding on an eigenvalue.
    slack: f64,
    pub(super) cells: u64,
    pub(super) outside: Option<OutsideRange>,
}

/// A cell by how far out its bound is.
#[derive(Debug)]
struct Ranked(f64, RangeCell);

impl EndSearch {
    pub(super) fn new(arm: EndOfArm, travel: &[Travel], stated: f64) -> Self {
        let bound = match arm.end {
            ProvedEnd::Low => arm.least_rotor(),
            ProvedEnd::High => f64::INFINITY,
        };
        let whole = |(k, ends): (usize, &Travel)| {
            if arm.energy.is_root(k) { (ends.0, ends.0) } else { *ends }
        };
        let ends = travel.iter().enumerate().map(whole).collect();
        let slack = slack(&arm, travel);
        let mut search = Self {
            arm,
            left: BinaryHeap::new(),
            within: Vec::new(),
            stage: 0,
            stated,
            known: stated,
            slack,
            cells: 0,
            outside: None,
        };
        search
            .left
            .push(Ranked(0.0, RangeCell { ends, share: 1.0, bound, joint: None, beyond: None }));
        search
    }

    /// Bound that need not be tighter yet.
    fn floor(&self) -> f64 {
        let factor = FACTORS[self.stage.min(FACTORS.len() - 1)];
        match self.arm.end {
            ProvedEnd::Low => self.known / factor,
            ProvedEnd::High => self.known * factor,
        }
    }

    /// Factor within which it is being proved, and the share of all postures over which it is; `None`: it is done.
    pub(super) fn under_way(&self) -> Option<(f64, f64)> {
        let factor = FACTORS.get(self.stage)?;
        Some((*factor, self.within.iter().map(|cell| cell.share).sum::<f64>() + 0.0))
    }

    /// The end that is proved, rounding included.
    pub(super) fn proved(&self) -> f64 {
        let within = self.floor();
        let worst = self.left.iter().map(|Ranked(_, cell)| cell.bound);
        let worst = match self.arm.end {
            ProvedEnd::Low => worst.fold(within, smaller),
            ProvedEnd::High => worst.fold(within, larger),
        };
        match self.arm.end {
            ProvedEnd::Low => {
                let below = smaller(worst, within) - self.slack;
                // The rotors' part is a quotient of two numbers.
                larger(below, self.arm.least_rotor() * (1.0 - 4.0 * f64::EPSILON))
            }
            ProvedEnd::High => larger(worst, within) + self.slack,
        }
    }

    /// Halves the worst cells, or bounds those again that were bounded within the factor before.
    pub(super) fn step(&mut self) {
        // The corners of a cell are three times as many with each joint.
        let more = self.arm.nominal.len().saturating_sub(7);
        let together = (0..more).fold(TOGETHER, |cells, _| cells / 2).max(4);
        let mut parts = Vec::new();
        while let Some(Ranked(_, cell)) = self.left.pop() {
            match cell.joint {
                Some(joint) => parts.extend(halved(cell, joint)),
                None => parts.push(cell),
            }
            if parts.len() >= together {
                break;
            }
        }
        let (floor, known) = (self.floor(), self.known);
        let arm = &self.arm;
        let bounded = shared(parts.len(), |i| arm.bounded(parts[i].clone(), floor, known));
        for cell in bounded {
            self.take(cell);
        }
        if self.left.is_empty() {
            self.stage += 1;
            if self.stage < FACTORS.len() {
                let again = |cell| Ranked(0.0, RangeCell { joint: None, ..cell });
                self.left = self.within.drain(..).map(again).collect();
            }
        }
    }

    fn take(&mut self, cell: RangeCell) {
        self.cells += 1;
        if let Some((q, eigenvalue)) = &cell.beyond
            && self.arm.is_beyond(*eigenvalue, self.known)
        {
            self.known = *eigenvalue;
            let stated = self.stated;
            let passed = (self.known / stated - 1.0).abs() > PASSED;
            let outside = || OutsideRange {
                end: self.arm.end,
                q: q.clone(),
                eigenvalue: *eigenvalue,
                stated,
            };
            self.outside = passed.then(outside);
        }
        let sign = if self.arm.end == ProvedEnd::High { 1.0 } else { -1.0 };
        // What is not a number is bounded by nothing, and comes first.
        if sign * cell.bound <= sign * self.floor() {
            self.within.push(cell);
        } else {
            self.left.push(Ranked(sign * cell.bound, cell));
        }
    }
}

/// Error of an eigenvalue by the rounding of forms and of their factors, and by the shift of moments.
fn slack(arm: &EndOfArm, travel: &[Travel]) -> f64 {
    let n = arm.nominal.len();
    let unit = 0.5 * f64::EPSILON;
    let reach: Vec<f64> =
        travel
            .iter()
            .zip(&arm.slides)
            .map(|((low, high), slides)| {
                if *slides { larger(low.abs(), high.abs()) } else { 1.01 / libm::cos(0.5 * WIDEST) }
            })
            .collect();
    let sizes = arm.energy.sizes(&reach);
    let mut sum = 0.0;
    for i in 0..n {
        for j in i..n {
            let twice = if i == j { 1.0 } else { 2.0 };
            sum += twice * sizes[i * n + j] / (arm.nominal[i] * arm.nominal[j]).sqrt();
        }
        sum += arm.energy.rotor[i] / arm.nominal[i];
    }
    let joints = n as f64;
    // At most n² + 27 n + 30 roundings lie on the way from a term to an entry: fewer, up to 32 joints.
    let gamma = 64.0 * (joints + 1.0) * unit * 1.01;
    // The factor adds n (n + 2) roundings of the whole form.
    let whole = gamma + arm.energy.shift + joints * (joints + 2.0) * unit;
    // From below a form has a difference of two for each joint, which is as large as four.
    (4.0 * joints + 1.0) * whole * sum
}

fn halved(cell: RangeCell, joint: usize) -> [RangeCell; 2] {
    let (low, high) = cell.ends[joint];
    let middle = 0.5 * (low + high);
    let mut upper = RangeCell { beyond: None, joint: None, share: 0.5 * cell.share, ..cell };
    let mut lower = upper.clone();
    lower.ends[joint].1 = middle;
    upper.ends[joint].0 = middle;
    [upper, lower]
}

impl PartialEq for Ranked {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Ranked {}

impl PartialOrd for Ranked {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Ranked {
    fn cmp(&self, other: &Self) -> Ordering {
        // Of two as bad, the smaller one: fewer are left at a time.
        self.0.total_cmp(&other.0).then(other.1.share.total_cmp(&self.1.share))
    }
}
