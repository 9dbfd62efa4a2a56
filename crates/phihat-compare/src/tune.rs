//! The one optimiser that tunes every rival.

use cmaes::{CMAESOptions, DVector};
use phihat_rivals::Scalar;

/// First step of the search, over the width of a scalar's range in logarithms: a range of two decades is
/// searched within some half decade around its start.
const STEP: f64 = 0.25;

/// What stands for a cost that is no number: worse than any that is.
const WORST: f64 = 1e300;

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
    let first = comparable(cost(&start));
    let mut tuned = Tuned { values: start, cost: first, history: vec![first] };
    let mut round = 0;
    while tuned.history.len() < runs && !scalars.is_empty() {
        let spent = tuned.history.len();
        search(scalars, runs, seed.wrapping_add(round), &mut tuned, &mut cost);
        round += 1;
        if tuned.history.len() == spent {
            break;
        }
    }
    tuned
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

/// Where a value lies in its range, in logarithms.
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
