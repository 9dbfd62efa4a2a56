//! Gains of a tighter cap under a looser one.

use super::record::{AtCap, Restart};
use crate::protocol::better;

/// Hands the gains of every search of one law on, from the tightest cap to the loosest.
///
/// What keeps a cap keeps every looser one, so a law's result under a looser cap is at least its result under a
/// tighter one. Where a search's gains under the looser cap are worse in the validation worlds than its gains under
/// the tighter, it ended too early there, and the tighter ones stand for it. Their violation in the validation worlds
/// was counted under the tighter cap: it can only be less under the looser. No figure of the test worlds has a say.
pub(super) fn hand_on(points: &mut [AtCap]) {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|a, b| points[*a].cap.total_cmp(&points[*b].cap));
    for pair in order.windows(2) {
        let &[tight, loose] = pair else { continue };
        let (cap, tighter) = (points[tight].cap, points[tight].restarts.clone());
        for looser in &mut points[loose].restarts {
            let same = tighter.iter().find(|other| other.restart == looser.restart);
            if let Some(other) = same.filter(|other| is_better(other, looser)) {
                *looser = Restart {
                    from_cap: other.from_cap.or(Some(cap)),
                    evaluations: looser.evaluations,
                    history: std::mem::take(&mut looser.history),
                    widened: looser.widened,
                    ..other.clone()
                };
            }
        }
    }
}

/// Returns true if gains keep every constraint in training and are better than others in the validation worlds.
fn is_better(one: &Restart, other: &Restart) -> bool {
    let validated = match (&one.validation, &other.validation) {
        (Some(one), Some(other)) => better(one, other),
        (one, _) => one.is_some(),
    };
    one.feasible() && (validated || !other.feasible())
}

#[cfg(test)]
mod tests {
    use super::{AtCap, Restart, hand_on};
    use crate::protocol::{Assessed, AssessedRun};

    /// Gains `value` of search 0 with errors in training, validation and test; a negative error is a violation.
    fn gains(value: f64, [train, validation, test]: [f64; 3]) -> Restart {
        let assessed = |error: f64| Assessed { error: error.abs(), violation: (-error).max(0.0) };
        Restart {
            restart: 0,
            failed: None,
            values: vec![value],
            train: Some(assessed(train)),
            validation: Some(assessed(validation)),
            evaluations: if value > 1.0 { 2000 } else { 1000 },
            history: vec![(1, value)],
            widened: 0,
            at_end: Vec::new(),
            test: vec![Some(AssessedRun { error_rms_rad: test, noise: 1e-3 })],
            from_cap: None,
        }
    }

    fn law(of: &[(f64, Restart)]) -> Vec<AtCap> {
        let point = |(cap, restart): &(f64, Restart)| AtCap {
            law: "indi".to_owned(),
            cap: *cap,
            restarts: vec![restart.clone()],
            chosen: None,
        };
        of.iter().map(point).collect()
    }

    /// Value of the gains and the cap that they are from, per cap.
    fn handed(mut points: Vec<AtCap>) -> Vec<(f64, Option<f64>)> {
        hand_on(&mut points);
        points.iter().map(|p| (p.restarts[0].values[0], p.restarts[0].from_cap)).collect()
    }

    /// Caps in any order: the best in validation goes up to every looser cap, with the cap that it is from, and better
    /// gains of a looser cap stay.
    #[test]
    fn a_looser_cap_is_at_least_its_tighter_one() {
        let points = law(&[
            (0.01, gains(4.0, [2e-4, 4.5e-4, 4.5e-4])),
            (0.001, gains(1.0, [9e-4, 9e-4, 9e-4])),
            (0.005, gains(3.0, [2e-4, 3.6e-4, 3.6e-4])),
            (0.002, gains(2.0, [3e-4, 3.4e-4, 3.4e-4])),
        ]);
        let found = handed(points);
        assert_eq!(found, [(2.0, Some(0.002)), (1.0, None), (2.0, Some(0.002)), (2.0, None)]);
    }

    /// The test worlds do not count, in either direction; nor do gains that break a constraint in training.
    #[test]
    fn the_validation_worlds_decide_alone() {
        let tight = |train: f64, validation: f64, test: f64| {
            law(&[
                (0.005, gains(1.0, [train, validation, test])),
                (0.01, gains(2.0, [0.2, 0.2, 0.2])),
            ])
        };
        assert_eq!(handed(tight(0.3, 0.1, 0.9))[1], (1.0, Some(0.005)));
        assert_eq!(handed(tight(0.1, 0.3, 0.01))[1], (2.0, None));
        assert_eq!(handed(tight(-0.1, 0.1, 0.01))[1], (2.0, None));
    }

    /// Effort and history stay those of the search under the looser cap.
    #[test]
    fn the_effort_is_that_of_the_looser_search() {
        let mut points = law(&[(0.005, gains(1.0, [0.1; 3])), (0.01, gains(2.0, [0.2; 3]))]);
        hand_on(&mut points);
        let loose = &points[1].restarts[0];
        assert_eq!((loose.evaluations, loose.history.as_slice()), (2000, &[(1, 2.0)][..]));
    }
}
