//! Many laws on many worlds by their ranks: which of them cannot be told apart.

use core::f64::consts::{PI, SQRT_2};

use serde::{Deserialize, Serialize};

/// Mean ranks of laws over worlds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Ranks {
    /// From 1, the best, in the order of the laws; laws that are equal in a world share its ranks.
    pub mean: Vec<f64>,
    /// Friedman's statistic `χ²_F` with one degree of freedom less than laws.
    pub friedman: f64,
}

/// Mean ranks: `errors` has a row per law and a column per world, smaller is better; `None` where there is no
/// law, no world, a row of another length, or a figure that is no number.
///
/// ```text
/// χ²_F = 12 N/(k (k + 1)) [Σ R_j² − k (k + 1)²/4]                                          (1)
/// ```
///
/// # References
///
/// J. Demšar, "Statistical comparisons of classifiers over multiple data sets", J. Machine Learning Research 7, 2006.
pub fn ranks(errors: &[Vec<f64>]) -> Option<Ranks> {
    let worlds = errors.first()?.len();
    let whole = |row: &Vec<f64>| row.len() == worlds && row.iter().all(|e| !e.is_nan());
    if worlds == 0 || !errors.iter().all(whole) {
        return None;
    }
    let (k, n) = (errors.len() as f64, worlds as f64);
    let rank = |law: usize, world: usize| {
        let mine = errors[law][world];
        let better = errors.iter().filter(|row| row[world] < mine).count() as f64;
        let equal = errors.iter().filter(|row| row[world] <= mine).count() as f64 - better;
        better + 0.5 * (equal + 1.0)
    };
    let mean: Vec<f64> = (0..errors.len())
        .map(|law| (0..worlds).map(|world| rank(law, world)).sum::<f64>() / n)
        .collect();
    let squares: f64 = mean.iter().map(|r| r * r).sum();
    let friedman = 12.0 * n / (k * (k + 1.0)) * (squares - 0.25 * k * (k + 1.0) * (k + 1.0));
    Some(Ranks { mean, friedman })
}

/// Least distance at which two mean ranks of `laws` laws over `worlds` worlds differ at a level (Nemenyi):
///
/// ```text
/// CD = q_α/√2 √(k (k + 1)/(6 N))                                                      (2)
/// ```
///
/// `None` for fewer than two laws, no world, or a level outside 0 to 1.
pub fn critical_difference(laws: usize, worlds: usize, level: f64) -> Option<f64> {
    if laws < 2 || worlds == 0 || !(level > 0.0 && level < 1.0) {
        return None;
    }
    let k = laws as f64;
    let q = studentized_range(laws, 1.0 - level);
    Some(q / SQRT_2 * (k * (k + 1.0) / (6.0 * worlds as f64)).sqrt())
}

/// The value that the range of `count` standard normal numbers (from 2 on) stays below with a probability:
/// the studentized range with infinitely many degrees of freedom.
///
/// By bisection on
///
/// ```text
/// P(range < q) = k ∫ φ(z) [Φ(z) − Φ(z − q)]^{k−1} dz                                   (3)
/// ```
///
/// with Simpson's rule from −8 to 8 + q.
pub fn studentized_range(count: usize, probability: f64) -> f64 {
    let (mut low, mut high) = (0.0, 20.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if below(count, middle) < probability { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// (3)
fn below(count: usize, q: f64) -> f64 {
    const STEPS: u32 = 800;
    let power = i32::try_from(count).unwrap_or(i32::MAX) - 1;
    let (from, to) = (-8.0, 8.0 + q);
    let h = (to - from) / f64::from(STEPS);
    let at = |z: f64| {
        let density = (-0.5 * z * z).exp() / (2.0 * PI).sqrt();
        density * (normal_below(z) - normal_below(z - q)).powi(power)
    };
    let weight = |k: u32| match k {
        0 | STEPS => 1.0,
        k if k % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let sum: f64 = (0..=STEPS).map(|k| weight(k) * at(from + f64::from(k) * h)).sum();
    count as f64 * sum * h / 3.0
}

/// `Φ(z)`
fn normal_below(z: f64) -> f64 {
    0.5 * libm::erfc(-z / SQRT_2)
}

#[cfg(test)]
mod tests {
    use super::{critical_difference, ranks, studentized_range};

    /// The printed table of the range over √2 at 0.05 (Demšar 2006, Table 5), and that at 0.10.
    #[test]
    fn the_range_is_the_one_of_the_tables() {
        let printed = [
            (2, 1.960),
            (3, 2.343),
            (4, 2.569),
            (5, 2.728),
            (6, 2.850),
            (7, 2.949),
            (8, 3.031),
            (9, 3.102),
            (10, 3.164),
        ];
        for (k, q) in printed {
            let found = studentized_range(k, 0.95) / 2.0_f64.sqrt();
            assert!((found - q).abs() < 1e-3, "{k}: {found} for {q}");
        }
        let found = studentized_range(4, 0.9) / 2.0_f64.sqrt();
        assert!((found - 2.291).abs() < 1e-3, "{found}");
        // Its worked example: four laws on 14 sets.
        let cd = critical_difference(4, 14, 0.05).unwrap();
        assert!((cd - 1.25).abs() < 5e-3, "{cd}");
        assert!(critical_difference(1, 14, 0.05).is_none());
    }

    /// By hand: two worlds agree, one has the first two equal.
    #[test]
    fn equal_laws_share_their_ranks() {
        let found =
            ranks(&[vec![1.0, 1.0, 5.0], vec![2.0, 2.0, 5.0], vec![3.0, 3.0, 9.0]]).unwrap();
        let exact = [3.5 / 3.0, 5.5 / 3.0, 3.0];
        for (found, exact) in found.mean.iter().zip(exact) {
            assert!((found - exact).abs() < 1e-12);
        }
        let squares: f64 = exact.iter().map(|r| r * r).sum();
        assert!((found.friedman - 3.0 * (squares - 12.0)).abs() < 1e-12);
        assert!(ranks(&[vec![1.0], vec![1.0, 2.0]]).is_none() && ranks(&[]).is_none());
    }
}
