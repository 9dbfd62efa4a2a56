//! The one optimiser that tunes every rival.

use cmaes::{CMAESOptions, DVector};
use phihat_rivals::Scalar;
use serde::{Deserialize, Serialize};

/// First step of the search, over the width of a scalar's range in logarithms: a range of two decades is
/// searched within some half decade around its start.
const STEP: f64 = 0.25;

/// Cost in place of one that is not a number: no cost is worse.
const WORST: f64 = 1e300;

/// Distance from an end of its range within which a value counts as at that end: a share of the range in
/// logarithms.
const AT_END: f64 = 0.01;

/// Factor by which a range is widened at an end that is hit.
const WIDER: f64 = 10.0;

/// The result of a search.
#[derive(Debug, Clone, PartialEq)]
pub struct Tuned {
    /// The best values that were tried, in the order of the scalars.
    pub values: Vec<f64>,
    /// Their cost.
    pub cost: f64,
    /// The cost of every evaluation in turn; the first is the default values'.
    pub history: Vec<f64>,
}

/// Looks for the values of a law's free scalars with the least cost.
///
/// # Method
///
/// CMA-ES in `x_i = ln(v_i/low_i)/ln(high_i/low_i)`, from the default values, first step 0.25. What leaves
/// `[0, 1]` is mirrored into it. The default values are evaluated first; where the search has converged it
/// starts anew from the best so far. There are exactly `runs` evaluations, at least one, whatever they
/// find; a law without a free scalar has one. Same seed, same costs: same answer.
///
/// # Not claimed
///
/// That the least cost was found: it is the least of `runs`.
///
/// # References
///
/// N. Hansen, A. Ostermeier, "Completely derandomized self-adaptation in evolution strategies", Evolutionary
/// Computation 9(2), 2001.
pub fn tune(
    scalars: &[Scalar],
    runs: usize,
    seed: u64,
    mut cost: impl FnMut(&[f64]) -> f64,
) -> Tuned {
    let start: Vec<f64> = scalars.iter().map(|scalar| scalar.default).collect();
    let mut tuned = at(&start, &mut cost);
    spend(scalars, runs, seed, &mut tuned, &mut cost);
    tuned
}

/// An end of a scalar's range at which a search ended.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct AtEnd {
    /// The scalar's name.
    pub scalar: String,
    /// True if it is the range's upper end.
    pub upper: bool,
}

/// The result of a search whose ranges gave way.
#[derive(Debug, Clone, PartialEq)]
pub struct Widened {
    /// The best of all rounds; its history is theirs in turn.
    pub tuned: Tuned,
    /// Searches, from 1: one more than ranges were widened.
    pub rounds: usize,
    /// The ranges of the last round, in the order of the scalars: `[low, high]`.
    pub ranges: Vec<[f64; 2]>,
    /// The ends that the best values were still at when no further round was allowed.
    pub at_end: Vec<AtEnd>,
}

/// [`tune`], and where the best values lie at ends of their ranges (within 1 % of the range, in logarithms),
/// these ends give way by a factor of ten and the search goes on from there with as many runs again,
/// `widenings` times at most.
///
/// Every round has exactly `runs` evaluations, so that a law has `rounds × runs` of them: more for one whose
/// ranges were too narrow, and the record says so. Where a law itself refuses values beyond an end, nothing
/// is found there.
pub fn tune_widening(
    scalars: &[Scalar],
    (runs, widenings): (usize, usize),
    seed: u64,
    mut cost: impl FnMut(&[f64]) -> f64,
) -> Widened {
    let start: Vec<f64> = scalars.iter().map(|scalar| scalar.default).collect();
    tune_widening_from((scalars, scalars.len()), &start, (runs, widenings), seed, &mut cost)
}

/// [`tune_widening`] from a given start inside the ranges, in place of the default values; only the ranges of
/// the first `wide` scalars may be widened or are reported.
pub(crate) fn tune_widening_from(
    (scalars, wide): (&[Scalar], usize),
    start: &[f64],
    (runs, widenings): (usize, usize),
    seed: u64,
    mut cost: impl FnMut(&[f64]) -> f64,
) -> Widened {
    let mut scalars = scalars.to_vec();
    let mut tuned = at(start, &mut cost);
    let mut rounds = 1;
    loop {
        // Seeds of a round's restarts are those of no other round.
        let seed = seed.wrapping_add(1000 * (rounds as u64 - 1));
        spend(&scalars, rounds * runs, seed, &mut tuned, &mut cost);
        let at_end = ends(&scalars[..wide], &tuned.values);
        if at_end.is_empty() || rounds > widenings {
            let ranges = scalars.iter().map(|scalar| [scalar.low, scalar.high]).collect();
            return Widened { tuned, rounds, ranges, at_end };
        }
        for end in &at_end {
            let hit = scalars.iter_mut().find(|scalar| scalar.name == end.scalar);
            match hit {
                Some(scalar) if end.upper => scalar.high *= WIDER,
                Some(scalar) => scalar.low /= WIDER,
                None => {}
            }
        }
        rounds += 1;
    }
}

/// Values that lie at an end of their range.
pub(crate) fn ends(scalars: &[Scalar], values: &[f64]) -> Vec<AtEnd> {
    let at = |(scalar, value): (&Scalar, &f64)| {
        let place = place(scalar, *value);
        let upper = place >= 1.0 - AT_END;
        (upper || place <= AT_END).then(|| AtEnd { scalar: scalar.name.to_owned(), upper })
    };
    scalars.iter().zip(values).filter_map(at).collect()
}

/// The first evaluation: where the search begins.
fn at(start: &[f64], cost: &mut impl FnMut(&[f64]) -> f64) -> Tuned {
    let first = comparable(cost(start));
    Tuned { values: start.to_vec(), cost: first, history: vec![first] }
}

/// Searches from the best so far, again and again, until there are `runs` evaluations.
fn spend(
    scalars: &[Scalar],
    runs: usize,
    seed: u64,
    tuned: &mut Tuned,
    cost: &mut impl FnMut(&[f64]) -> f64,
) {
    let mut round = 0;
    while tuned.history.len() < runs && !scalars.is_empty() {
        let spent = tuned.history.len();
        search(scalars, runs, seed.wrapping_add(round), tuned, cost);
        round += 1;
        if tuned.history.len() == spent {
            break;
        }
    }
}

/// One search from the best so far, to its end or the end of the runs.
fn search(
    scalars: &[Scalar],
    runs: usize,
    seed: u64,
    tuned: &mut Tuned,
    cost: &mut impl FnMut(&[f64]) -> f64,
) {
    let mean: Vec<f64> = scalars.iter().zip(&tuned.values).map(|(s, v)| place(s, *v)).collect();
    let objective = |x: &DVector<f64>| {
        if tuned.history.len() >= runs {
            return WORST;
        }
        let values: Vec<f64> = scalars.iter().zip(x.iter()).map(|(s, x)| value(s, *x)).collect();
        let cost = comparable(cost(&values));
        tuned.history.push(cost);
        if cost < tuned.cost {
            (tuned.values, tuned.cost) = (values, cost);
        }
        cost
    };
    // As many generations as there are evaluations are more than enough.
    if let Ok(mut search) = CMAESOptions::new(mean, STEP).seed(seed).build(objective) {
        for _ in 0..runs {
            if search.next().is_some() {
                break;
            }
        }
    }
}

/// Position of a value in its range, from 0 to 1, in logarithms.
fn place(scalar: &Scalar, value: f64) -> f64 {
    (value / scalar.low).ln() / (scalar.high / scalar.low).ln()
}

/// The value at a place, mirrored into the range.
fn value(scalar: &Scalar, place: f64) -> f64 {
    let folded = place.rem_euclid(2.0);
    let inside = if folded > 1.0 { 2.0 - folded } else { folded };
    let value = scalar.low * (scalar.high / scalar.low).powf(inside);
    value.clamp(scalar.low, scalar.high)
}

fn comparable(cost: f64) -> f64 {
    if cost.is_nan() { WORST } else { cost.clamp(-WORST, WORST) }
}
