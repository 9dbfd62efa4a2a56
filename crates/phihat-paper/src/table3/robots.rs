//! PD and the proposed law on robots that compensate more or less by themselves.

use super::bench::{Bench, Score};
use super::left::SharesLeft;
use crate::part::PartError;

/// Shares left by the robots: nothing compensated; gravity compensated, and more and more of the friction.
pub(super) const LEFT: [SharesLeft; 5] = [
    SharesLeft { gravity: 1.0, friction: 1.0 },
    SharesLeft { gravity: 0.0, friction: 1.0 },
    SharesLeft { gravity: 0.0, friction: 0.2 },
    SharesLeft { gravity: 0.0, friction: 0.05 },
    SharesLeft { gravity: 0.0, friction: 0.0 },
];

/// Steps of the bisection for where PD is as good.
const STEPS: u32 = 10;

/// Results on one robot.
pub(super) struct Table3Robot {
    pub(super) left: SharesLeft,
    /// `−K_p e − K_d ė`.
    pub(super) plain: Score,
    /// The outer loop (3).
    pub(super) outer: Score,
    /// The proposed law, m = 1 and 2.
    pub(super) proposed: [Score; 2],
    pub(super) comparator: Score,
}

impl Table3Robot {
    fn of(bench: &Bench, left: SharesLeft) -> Result<Self, PartError> {
        Ok(Self {
            left,
            plain: bench.on(left, "pd")?,
            outer: bench.outer_on(left)?,
            proposed: [bench.on(left, "proposed-1")?, bench.on(left, "proposed-2")?],
            comparator: bench.on(left, "h-infinity-pid")?,
        })
    }

    pub(super) fn all(bench: &Bench) -> Result<Vec<Self>, PartError> {
        LEFT.into_iter().map(|left| Self::of(bench, left)).collect()
    }

    /// Rms of PD over that of the proposed law, per joint, in one reading of PD.
    pub(super) fn times(&self, pd: fn(&Self) -> &Score) -> Vec<f64> {
        let pairs = pd(self).rms().into_iter().zip(self.proposed[0].rms());
        pairs.map(|(pd, proposed)| pd / proposed).collect()
    }
}

/// The largest share of friction left, gravity compensated, at which (3) is as good as the proposed law on some
/// joint, and that joint, counted from 1; `None`: it is worse on all, even with none left.
pub(super) fn as_good(bench: &Bench) -> Result<Option<(f64, usize)>, PartError> {
    let worst = |friction: f64| -> Result<(f64, usize), PartError> {
        let left = SharesLeft { gravity: 0.0, friction };
        let pairs = bench.outer_on(left)?.square.into_iter();
        let pairs = pairs.zip(bench.on(left, "proposed-1")?.square);
        let ratios = pairs.zip(1..).map(|((pd, ours), joint)| (pd / ours, joint));
        Ok(ratios
            .fold((f64::INFINITY, 0), |least, ratio| if ratio.0 < least.0 { ratio } else { least }))
    };
    let (ratio, mut joint) = worst(0.0)?;
    if ratio > 1.0 {
        return Ok(None);
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..STEPS {
        let middle = 0.5 * (low + high);
        let (ratio, at) = worst(middle)?;
        if ratio > 1.0 {
            high = middle;
        } else {
            (low, joint) = (middle, at);
        }
    }
    Ok(Some((high, joint)))
}
