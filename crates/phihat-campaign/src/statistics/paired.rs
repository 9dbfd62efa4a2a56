//! Two laws on the same test worlds: the ratio of their errors, with an interval.

use phihat_session::Dice;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::quantile::sorted_quantile;

/// Errors of one law: a row per restart of its tuning, a column per test world, all above 0, in one unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ErrorTable {
    rows: Vec<Vec<f64>>,
}

/// Why errors cannot be compared.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum PairError {
    /// No restart, or no world.
    #[error("a table of errors needs one restart and one world at least")]
    Empty,
    /// Rows that are not of one length.
    #[error("restart {restart} has {found} worlds, the first one {first}: all have the same")]
    Ragged {
        /// Number of the restart, from 0.
        restart: usize,
        /// Its worlds.
        found: usize,
        /// Those of the first.
        first: usize,
    },
    /// An error that has no logarithm.
    #[error("restart {restart}, world {world}: {value} is no error: above 0 and finite is valid")]
    Value {
        /// Number of the restart, from 0.
        restart: usize,
        /// Number of the world, from 0.
        world: usize,
        /// The figure.
        value: f64,
    },
    /// Two tables of different worlds.
    #[error("{ours} worlds against {theirs}: pairs need the same worlds")]
    Unpaired {
        /// Worlds of one.
        ours: usize,
        /// Worlds of the other.
        theirs: usize,
    },
    /// Nothing to draw, or no level.
    #[error(
        "{draws} draws at level {level}: 100 draws at least and a level between 0 and 1 are valid"
    )]
    Bootstrap {
        /// Number of draws.
        draws: usize,
        /// The level.
        level: f64,
    },
}

impl ErrorTable {
    /// A row per restart, a column per world.
    ///
    /// # Errors
    ///
    /// [`PairError`]: none, rows of different lengths, or a figure that is not above 0 and finite. A run that
    /// failed has no error: the caller decides how it counts (as a separate failure rate, or as the largest
    /// error that there is).
    pub fn new(rows: Vec<Vec<f64>>) -> Result<Self, PairError> {
        let first = rows.first().map_or(0, Vec::len);
        if first == 0 {
            return Err(PairError::Empty);
        }
        for (restart, row) in rows.iter().enumerate() {
            if row.len() != first {
                return Err(PairError::Ragged { restart, found: row.len(), first });
            }
            let bad = row.iter().position(|value| !(value.is_finite() && *value > 0.0));
            if let Some(world) = bad {
                return Err(PairError::Value { restart, world, value: row[world] });
            }
        }
        Ok(Self { rows })
    }

    /// Restarts.
    pub fn restarts(&self) -> usize {
        self.rows.len()
    }

    /// Worlds.
    pub fn worlds(&self) -> usize {
        self.rows[0].len()
    }

    fn logs(&self) -> Vec<Vec<f64>> {
        self.rows.iter().map(|row| row.iter().map(|value| value.ln()).collect()).collect()
    }
}

/// Options of the bootstrap.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Bootstrap {
    /// Draws: 100 at least.
    pub draws: usize,
    /// Share of draws inside the interval: 0.95.
    pub level: f64,
    /// Seed: same seed, same interval.
    pub seed: u64,
}

impl Default for Bootstrap {
    fn default() -> Self {
        Self { draws: 10_000, level: 0.95, seed: 1 }
    }
}

/// The ratio of two laws' errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Ratio {
    /// `exp` of the mean log-ratio: below 1 the first law has the smaller errors.
    pub ratio: f64,
    /// Its interval by the bootstrap, `[low, high]`.
    pub interval: [f64; 2],
    /// Two-sided: how seldom the draws are on the other side of 1; 1/(draws + 1) at least.
    pub p: f64,
}

/// The ratio of the errors of `ours` to `theirs` over the same worlds, with an interval that counts both the
/// luck of the tuning and the choice of worlds.
///
/// # Method
///
/// With `ē_w` the mean of `ln e` over a law's restarts in world `w`
///
/// ```text
/// ln ratio = mean over w of (ē_w,ours − ē_w,theirs)                                       (1)
/// ```
///
/// A draw of the bootstrap draws restarts of each law with replacement, worlds with replacement, and takes
/// (1) of what was drawn. Restarts are drawn once for all worlds, since a restart's gains are the same in all
/// of them: whole rows and whole columns are drawn, never single runs, or the interval would be too narrow by
/// the root of their number. The interval has the quantiles of the draws at `(1 ± level)/2`.
///
/// # Errors
///
/// [`PairError`]: other worlds, or too few draws.
///
/// # Not claimed
///
/// Coverage for a handful of restarts: the percentile bootstrap is then too narrow, by a factor of
/// `√((n − 1)/n)` for a mean of `n`.
///
/// # References
///
/// A. C. Davison, D. V. Hinkley, "Bootstrap Methods and their Application", 1997, section 3.8 (hierarchical
/// data); A. B. Owen, "The pigeonhole bootstrap", Annals of Applied Statistics 1(2), 2007 (rows and columns).
pub fn ratio(ours: &ErrorTable, theirs: &ErrorTable, how: Bootstrap) -> Result<Ratio, PairError> {
    if ours.worlds() != theirs.worlds() {
        return Err(PairError::Unpaired { ours: ours.worlds(), theirs: theirs.worlds() });
    }
    if how.draws < 100 || !(how.level > 0.0 && how.level < 1.0) {
        return Err(PairError::Bootstrap { draws: how.draws, level: how.level });
    }
    let (a, b) = (ours.logs(), theirs.logs());
    let worlds: Vec<usize> = (0..ours.worlds()).collect();
    let every = |rows: &[Vec<f64>]| (0..rows.len()).collect::<Vec<_>>();
    let exact = mean(&a, &every(&a), &worlds) - mean(&b, &every(&b), &worlds);
    let mut dice = Dice::new(how.seed, 0);
    let mut drawn: Vec<f64> = (0..how.draws)
        .map(|_| {
            let columns = redrawn(&mut dice, worlds.len());
            let (ours, theirs) = (redrawn(&mut dice, a.len()), redrawn(&mut dice, b.len()));
            mean(&a, &ours, &columns) - mean(&b, &theirs, &columns)
        })
        .collect();
    drawn.sort_by(f64::total_cmp);
    let tail = 0.5 * (1.0 - how.level);
    let ends = [tail, 1.0 - tail].map(|share| sorted_quantile(&drawn, share).exp());
    let beyond = |side: &dyn Fn(f64) -> bool| {
        (1 + drawn.iter().filter(|x| side(**x)).count()) as f64 / (1 + how.draws) as f64
    };
    let p = 2.0 * beyond(&|x| x >= 0.0).min(beyond(&|x| x <= 0.0));
    Ok(Ratio { ratio: exact.exp(), interval: ends, p: p.min(1.0) })
}

/// The mean of the chosen rows and columns, with repetition.
fn mean(rows: &[Vec<f64>], chosen: &[usize], columns: &[usize]) -> f64 {
    let sum: f64 = chosen.iter().map(|&r| columns.iter().map(|&w| rows[r][w]).sum::<f64>()).sum();
    sum / (chosen.len() * columns.len()) as f64
}

fn redrawn(dice: &mut Dice, count: usize) -> Vec<usize> {
    (0..count).map(|_| dice.below(count)).collect()
}

#[cfg(test)]
mod tests {
    use super::{Bootstrap, ErrorTable, PairError, ratio};
    use phihat_session::Dice;

    const HOW: Bootstrap = Bootstrap { draws: 4000, level: 0.95, seed: 7 };

    /// A standard normal number, from twelve even ones.
    fn normal(dice: &mut Dice) -> f64 {
        (0..12).map(|_| dice.share()).sum::<f64>() - 6.0
    }

    /// `exp` of restart plus world, as a table.
    fn table(restarts: &[f64], worlds: &[f64]) -> ErrorTable {
        let row = |r: &f64| worlds.iter().map(|w| (r + w).exp()).collect();
        ErrorTable::new(restarts.iter().map(row).collect()).unwrap()
    }

    #[test]
    fn one_law_that_is_half_as_bad_everywhere_is_so_without_doubt() {
        let worlds = [0.3, -1.0, 4.0, 2.0];
        let found =
            ratio(&table(&[-(2.0_f64.ln())], &worlds), &table(&[0.0], &worlds), HOW).unwrap();
        assert!((found.ratio - 0.5).abs() < 1e-12);
        assert!(found.interval.iter().all(|end| (end - 0.5).abs() < 1e-12), "{found:?}");
        assert!((found.p - 2.0 / 4001.0).abs() < 1e-12, "{found:?}");
    }

    /// Additive tables: the variance of the drawn mean is that of the restarts over their number, plus that
    /// of what the worlds do to one law and not to the other over theirs. What worlds do to both cancels in
    /// the pair.
    #[test]
    fn the_interval_has_the_width_of_restarts_and_unshared_worlds() {
        let mut dice = Dice::new(3, 0);
        let mut draw = |count: usize, size: f64| -> Vec<f64> {
            (0..count).map(|_| size * normal(&mut dice)).collect()
        };
        let (r, own, shared) = (draw(20, 0.3), draw(40, 0.2), draw(40, 3.0));
        let both: Vec<f64> = own.iter().zip(&shared).map(|(a, b)| a + b).collect();
        let found = ratio(&table(&r, &both), &table(&[0.0], &shared), HOW).unwrap();
        let variance = |x: &[f64]| {
            let mean = x.iter().sum::<f64>() / x.len() as f64;
            x.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / x.len() as f64
        };
        let sigma = (variance(&r) / 20.0 + variance(&own) / 40.0).sqrt();
        let width = (found.interval[1] / found.interval[0]).ln();
        assert!((width / (2.0 * 1.96 * sigma) - 1.0).abs() < 0.05, "{width} {sigma}");
        let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
        assert!((found.ratio.ln() - mean(&r) - mean(&own)).abs() < 1e-12);
        // Had single runs been drawn, the width would be that of 800 independent figures.
        let naive = ((variance(&r) + variance(&own)) / 800.0).sqrt();
        assert!(width > 3.0 * (2.0 * 1.96 * naive));
    }

    /// Two laws that are one: 95 in 100 intervals hold 1, and few call one of them better.
    #[test]
    fn intervals_hold_the_truth_as_often_as_they_say() {
        let how = Bootstrap { draws: 300, ..HOW };
        let (mut held, mut called) = (0, 0);
        for trial in 0..200 {
            let mut dice = Dice::new(11, trial);
            let mut law = || -> Vec<f64> { (0..12).map(|_| 0.4 * normal(&mut dice)).collect() };
            let (a, b) = (law(), law());
            let worlds: Vec<f64> = (0..15).map(|w| f64::from(w).sin()).collect();
            let found = ratio(&table(&a, &worlds), &table(&b, &worlds), how).unwrap();
            held += i32::from(found.interval[0] <= 1.0 && found.interval[1] >= 1.0);
            called += i32::from(found.p < 0.05);
        }
        assert!((176..=197).contains(&held) && called <= 24, "{held} {called}");
    }

    #[test]
    fn what_has_no_logarithm_or_no_partner_is_told_with_its_place() {
        let bad = ErrorTable::new(vec![vec![1.0, 2.0], vec![1.0, -2.0]]).unwrap_err();
        assert_eq!(bad, PairError::Value { restart: 1, world: 1, value: -2.0 });
        assert_eq!(ErrorTable::new(vec![]).unwrap_err(), PairError::Empty);
        let ragged = ErrorTable::new(vec![vec![1.0], vec![1.0, 1.0]]).unwrap_err();
        assert_eq!(ragged, PairError::Ragged { restart: 1, found: 2, first: 1 });
        let (one, two) = (table(&[0.0], &[0.0]), table(&[0.0], &[0.0, 1.0]));
        assert!(matches!(ratio(&one, &two, HOW), Err(PairError::Unpaired { ours: 1, theirs: 2 })));
        let few = Bootstrap { draws: 3, ..HOW };
        assert!(matches!(ratio(&one, &one, few), Err(PairError::Bootstrap { draws: 3, .. })));
    }
}
