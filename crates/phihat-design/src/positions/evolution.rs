//! The least of a function of many numbers that is not smooth, by an evolution strategy, the same every time.

use cmaes::{CMAESOptions, DVector};

use super::simplex::SimplexResult;

/// Largest cost, which also replaces one that is not a number.
const WORST: f64 = 1e300;

/// Any number: the same one gives the same laws.
const SEED: u64 = 1;

/// Goes from a place with a first step of a size, looking at most so often.
///
/// # References
///
/// N. Hansen, A. Ostermeier, "Completely derandomized self-adaptation in evolution strategies", Evolutionary
/// Computation 9(2), 2001.
pub(super) fn evolution(
    cost: impl Fn(&[f64]) -> f64,
    start: &[f64],
    (step, most): (f64, u32),
) -> SimplexResult {
    let mut best = SimplexResult { cost: cost(start), x: start.to_vec() };
    let mut looked = 1;
    let objective = |x: &DVector<f64>| {
        if looked >= most {
            return WORST;
        }
        looked += 1;
        let own = cost(x.as_slice());
        if own < best.cost {
            best = SimplexResult { cost: own, x: x.as_slice().to_vec() };
        }
        if own.is_nan() { WORST } else { own.min(WORST) }
    };
    if let Ok(mut search) = CMAESOptions::new(start.to_vec(), step).seed(SEED).build(objective) {
        // As many generations as looks are more than enough.
        for _ in 0..most {
            if search.next().is_some() {
                break;
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::evolution;

    #[test]
    fn finds_the_foot_of_a_valley_with_an_edge() {
        // Rosenbrock's valley with an edge along it: no derivative there.
        let cost = |x: &[f64]| {
            let off = x[1] - x[0] * x[0];
            10.0 * off.abs() + (1.0 - x[0]) * (1.0 - x[0]) + (x[2] - 3.0).abs()
        };
        let found = evolution(cost, &[-1.0, 1.5, 0.0], (0.3, 4000));
        assert!(found.cost < 1e-2, "{} at {:?}", found.cost, found.x);
        let again = evolution(cost, &[-1.0, 1.5, 0.0], (0.3, 4000));
        assert_eq!(found.x, again.x);
        // No look is worse than where it begins.
        assert!(evolution(cost, &[1.0, 1.0, 3.0], (0.3, 200)).cost <= 0.0);
    }
}
