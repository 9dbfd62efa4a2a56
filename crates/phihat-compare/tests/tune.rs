//! The optimiser of the comparison: it finds what is known, keeps to the ranges, and spends the same on everybody.

use phihat_compare::{AtEnd, tune, tune_widening};
use phihat_rivals::{RIVALS, Scalar};

const fn scalar(default: f64, low: f64, high: f64) -> Scalar {
    Scalar { name: "x", unit: "", meaning: "", default, low, high }
}

/// A bowl whose middle, and nothing else, is known; a valley that is narrow and oblique.
#[test]
fn it_finds_a_known_optimum() {
    let scalars = [scalar(10.0, 1.0, 100.0), scalar(1.0, 0.1, 10.0), scalar(5.0, 0.5, 50.0)];
    let goal = [37.0_f64, 0.2, 20.0];
    let far = |values: &[f64]| -> Vec<f64> {
        values.iter().zip(goal).map(|(v, goal)| (v / goal).ln()).collect()
    };
    let bowl = |values: &[f64]| far(values).iter().map(|x| x * x).sum();
    let valley = |values: &[f64]| {
        let x = far(values);
        (x[0] + x[1]).powi(2) * 100.0 + (x[0] - x[1]).powi(2) + x[2] * x[2]
    };
    for (name, cost) in [("bowl", &bowl as &dyn Fn(&[f64]) -> f64), ("valley", &valley)] {
        let tuned = tune(&scalars, 600, 1, cost);
        for (value, goal) in tuned.values.iter().zip(goal) {
            assert!((value / goal - 1.0).abs() < 1e-3, "{name}: {value} for {goal}");
        }
    }
}

/// The optimum lies beyond the range: the answer is the range's end, and no trial was outside.
#[test]
fn it_never_leaves_the_ranges() {
    let scalars = [scalar(10.0, 1.0, 100.0), scalar(0.15, 0.03, 3.0)];
    let mut tried = 0;
    let tuned = tune(&scalars, 300, 7, |values| {
        tried += 1;
        for (value, scalar) in values.iter().zip(&scalars) {
            assert!((scalar.low..=scalar.high).contains(value), "{value}");
        }
        (values[0] / 1e6).ln().abs() + (values[1] / 1e-6).ln().abs()
    });
    assert_eq!(tried, 300);
    assert!(tuned.values[0] > 95.0 && tuned.values[1] < 0.032, "{:?}", tuned.values);
}

/// The optimum is two decades beyond one range, inside another, and beyond all ranges of a third: the first
/// is found once its range is widened, the second keeps its range, and the third is reported. Each round has
/// the same number of runs.
#[test]
fn an_end_that_is_hit_gives_way_and_one_that_stays_is_told() {
    let named = |name| Scalar { name, ..scalar(10.0, 1.0, 100.0) };
    let scalars = [named("far"), named("inside"), named("endless")];
    let cost =
        |v: &[f64]| (v[0] / 5e3).ln().hypot((v[1] / 20.0).ln()) + (v[2] * 1e3).ln().max(-9.0);
    let mut spent = 0;
    let found = tune_widening(&scalars, (400, 3), 1, |values| {
        spent += 1;
        cost(values) + 20.0
    });
    assert_eq!((found.rounds, spent, found.tuned.history.len()), (4, 1600, 1600));
    assert!((found.tuned.values[0] / 5e3 - 1.0).abs() < 0.02, "{:?}", found.tuned.values);
    assert!((found.tuned.values[1] / 20.0 - 1.0).abs() < 0.02, "{:?}", found.tuned.values);
    // A bound of the law's own, as a cost that is infinite beyond it: nothing is at an end of the range then.
    for (range, exact) in found.ranges.iter().zip([[1.0_f64, 1e4], [1.0, 100.0]]) {
        let apart = |k: usize| (range[k] / exact[k] - 1.0).abs();
        assert!(apart(0) < 1e-9 && apart(1) < 1e-9, "{range:?}");
    }
    assert!((found.ranges[2][0] / 1e-3 - 1.0).abs() < 1e-9, "{:?}", found.ranges);
    assert_eq!(found.at_end, [AtEnd { scalar: "endless".to_owned(), upper: false }]);
    let walled = tune_widening(&scalars[..1], (200, 3), 1, |v| {
        if v[0] > 150.0 { f64::INFINITY } else { (v[0] / 5e3).ln().abs() }
    });
    assert!((walled.tuned.values[0] / 150.0 - 1.0).abs() < 0.01, "{:?}", walled.tuned.values);
    assert!(walled.at_end.is_empty() && walled.rounds == 2, "{walled:?}");
}

/// Every rival of the list has the same number of runs, whatever its dimension and whatever it finds: a flat
/// landscape that converges at once, none, one that is no number.
#[test]
fn everybody_has_the_same_number_of_runs() {
    for entry in RIVALS.iter().filter(|entry| !entry.scalars.is_empty()) {
        for cost in [|_: &[f64]| 1.0, |_: &[f64]| f64::NAN, |v: &[f64]| (v[0] - 1.0).powi(2)] {
            let mut spent = 0;
            let tuned = tune(entry.scalars, 130, 3, |values| {
                spent += 1;
                cost(values)
            });
            assert_eq!((spent, tuned.history.len()), (130, 130), "{}", entry.card.id);
        }
    }
}

/// The default values come first, the answer is never worse than them, and a seed is an answer.
#[test]
fn it_starts_at_the_default_values() {
    let scalars = [scalar(20.0, 2.0, 200.0), scalar(1.0, 0.3, 3.0)];
    let mut first = None;
    let ridge = |values: &[f64]| ((values[0] / 20.0).ln().abs() + (values[1] - 1.0).abs()).sqrt();
    let run = |seed: u64| tune(&scalars, 50, seed, ridge);
    tune(&scalars, 5, 1, |values| {
        first.get_or_insert(values.to_vec());
        1.0
    });
    assert_eq!(first.unwrap(), [20.0, 1.0]);
    let tuned = run(1);
    assert_eq!(tuned.values, [20.0, 1.0]);
    assert_eq!(tuned, run(1));
    assert_ne!(tuned.history, run(2).history);
}
