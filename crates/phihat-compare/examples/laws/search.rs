//! Search for the least error that designs reach, by requesting less and less of it.

/// Result of one design.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Tried {
    /// Requested error.
    pub(crate) asked: f64,
    /// Error of the design's tube; `None`: no tube, or torque changes beyond the allowed ones.
    pub(crate) reached: Option<f64>,
}

/// Two errors within this factor are as good as one.
const NEAR: f64 = 1.04;

/// The least error reached so far.
pub(crate) fn least(tried: &[Tried]) -> Option<f64> {
    tried.iter().filter_map(|one| one.reached).reduce(f64::min)
}

/// Error to request next; `None`: the least error is known well enough. `first` at first; then less than was
/// reached; then a value between the requests that failed and those that succeeded, which may have reached
/// far less than requested; more, if nothing was reached.
pub(crate) fn next(tried: &[Tried], first: f64) -> Option<f64> {
    let (good, vain): (Vec<Tried>, Vec<Tried>) =
        tried.iter().partition(|one| one.reached.is_some_and(|reached| reached <= one.asked));
    let above = good.iter().map(|one| one.asked).reduce(f64::min);
    let below = vain.iter().map(|one| one.asked);
    match (above, least(tried)) {
        (None, None) => Some(below.reduce(f64::max).map_or(first, |most| 2.0 * most)),
        // Reached, by what was meant for less: nothing below is kept. Nothing is asked for twice.
        (None, Some(least)) => {
            let above = tried.iter().map(|one| NEAR * one.asked).filter(|asked| *asked > least);
            Some(above.fold(1.02 * least, f64::max))
        }
        (Some(above), reached) => {
            let below = below.filter(|asked| *asked < above).reduce(f64::max);
            let Some(below) = below else { return Some(0.75 * reached.unwrap_or(above)) };
            (above > NEAR * below).then(|| (above * below).sqrt())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Designs that come to a share of what was asked for, but to no less than a floor, and are in vain below a bar.
    fn search(first: f64, share: f64, floor: f64, bar: f64) -> Vec<Tried> {
        let mut tried = Vec::new();
        while let Some(asked) = next(&tried, first).filter(|_| tried.len() < 20) {
            let reached = (asked >= bar).then(|| (share * asked).max(floor));
            tried.push(Tried { asked, reached });
        }
        tried
    }

    #[test]
    fn the_least_error_is_closed_in_on_from_above_and_from_below() {
        for (first, share) in [(0.1, 1.0), (0.1, 0.6), (4.0, 1.0), (30.0, 0.9), (1.0, 0.5)] {
            // What is asked for is reached, down to 1; then, a share of it, down to where nothing is.
            for floor in [1.0, 0.0] {
                let tried = search(first, share, floor, 1.0);
                let found = least(&tried).unwrap_or(f64::INFINITY);
                let best = share.max(floor);
                assert!((best..1.04 * best).contains(&found), "{first} {share}: {tried:?}");
                assert!(tried.len() <= 16, "{first} {share}: {tried:?}");
            }
        }
    }

    #[test]
    fn what_misses_the_wish_but_keeps_its_steps_counts() {
        let tried = [Tried { asked: 0.5, reached: Some(0.8) }];
        assert_eq!(least(&tried), Some(0.8));
        assert!(next(&tried, 1.0).is_some_and(|asked| (0.8..0.9).contains(&asked)));
        let again = [tried[0], Tried { asked: 0.816, reached: Some(0.9) }];
        assert!(next(&again, 1.0).is_some_and(|asked| (0.84..0.9).contains(&asked)));
    }
}
