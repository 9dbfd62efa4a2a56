//! Dry friction, from what the torque jumps by where a joint reverses.

use nalgebra::{DMatrix, DVector};
use phihat_certificate::extremes::{Extremes as _, larger, smaller};
use serde::{Deserialize, Serialize};

use crate::trace::JointSignals;

/// From a reversal to either end of its window \[s\].
const WINDOW: f64 = 0.3;

/// Samples of a window that are used, evenly spread: neighbours tell the same.
const ROWS: usize = 200;

/// Samples that a window needs on either side.
const LEAST: usize = 20;

/// Share of the largest speed below which a joint may stick.
const SLOW: f64 = 0.03;

/// No window is believed to know its level better \[N·m\].
const EXACT: f64 = 1e-9;

/// Standard errors on either side of an estimate.
const SIGMAS: f64 = 3.0;

/// Powers of time beside the jump: what goes on smoothly through a reversal, gravity and smooth friction.
const POWERS: u8 = 4;

/// Estimate of one joint's dry friction from a record.
///
/// # Method
///
/// Least squares over a window around each reversal of the joint,
///
/// ```text
/// τ_i = Σ_j M_ij q̈_j + Σ_{p<4} c_p (t − t_r)^p + f sign(q̇_i)                                             (R2)
/// ```
///
/// without the samples in which the filter mixes both directions, and without those in which the joint hardly
/// moves. The level is the mean of all windows, each weighted by the inverse of its variance; the interval is
/// three standard errors of that mean either way, by the windows' own or by the spread between them,
/// whichever is larger.
///
/// # Not claimed
///
/// An estimate, not a proof: friction that changes fast with velocity counts as dry, and what a joint does in
/// other postures, warm or under load is not in it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DryFriction {
    /// Mean level \[N·m\].
    pub level_nm: f64,
    /// Lower end, 0 at least \[N·m\].
    pub low_nm: f64,
    /// Upper end \[N·m\].
    pub high_nm: f64,
    /// Reversals that say something.
    pub reversals: usize,
}

impl DryFriction {
    /// Estimate for joint `of` from signals that went through a filter which mixes so many samples; `None`
    /// where it never reverses between two ways that are long enough.
    #[must_use]
    pub fn of(
        joints: &[JointSignals<'_>],
        of: usize,
        period_ns: u64,
        mixed: usize,
    ) -> Option<Self> {
        let dq = joints.get(of)?.dq;
        let fastest = dq.iter().map(|dq| dq.abs()).largest();
        let pairs = dq.windows(2).enumerate();
        let reversals: Vec<usize> =
            pairs.filter(|(_, dq)| dq[0] * dq[1] < 0.0).map(|(k, _)| k).collect();
        let near = |k: &usize| {
            let next = reversals.partition_point(|r| r + mixed < *k);
            reversals.get(next).is_some_and(|r| *r <= k + mixed)
        };
        let told = |k: &usize| dq[*k].abs() >= SLOW * fastest && !near(k);
        // A velocity of noise changes its sign often: what is near the last one is that one.
        let apart = |(number, at): (usize, &usize)| {
            (number == 0 || at - reversals[number - 1] > mixed).then_some(*at)
        };
        let windows = reversals.iter().enumerate().filter_map(apart);
        let found: Vec<(f64, f64)> =
            windows.filter_map(|at| jump((joints, of), at, period_ns, &told)).collect();
        pooled(&found)
    }

    /// The estimate with an interval that contains another one too, as that of a bounded fit \[N·m\].
    #[must_use]
    pub fn widened(&self, (low, high): (f64, f64)) -> Self {
        Self { low_nm: smaller(self.low_nm, low), high_nm: larger(self.high_nm, high), ..*self }
    }

    /// Both estimates together: the mean of the levels, and the interval that contains both.
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        let (a, b) = (self.reversals as f64, other.reversals as f64);
        Self {
            level_nm: (a * self.level_nm + b * other.level_nm) / (a + b),
            low_nm: smaller(self.low_nm, other.low_nm),
            high_nm: larger(self.high_nm, other.high_nm),
            reversals: self.reversals + other.reversals,
        }
    }
}

/// One level out of those of all windows, `(f, its standard error)`.
fn pooled(found: &[(f64, f64)]) -> Option<DryFriction> {
    let weight = |error: f64| 1.0 / (error * error).max(EXACT * EXACT);
    let all: f64 = found.iter().map(|(_, error)| weight(*error)).sum();
    if found.is_empty() || !all.is_finite() {
        return None;
    }
    let level = found.iter().map(|(f, error)| weight(*error) * f).sum::<f64>() / all;
    let apart: f64 = found.iter().map(|(f, error)| weight(*error) * (f - level).powi(2)).sum();
    let spare = (found.len() - 1).max(1) as f64;
    let error = SIGMAS * (larger(1.0, apart / spare) / all).sqrt();
    let positive = |x: f64| larger(x, 0.0);
    Some(DryFriction {
        level_nm: positive(level),
        low_nm: positive(level - error),
        high_nm: positive(level + error),
        reversals: found.len(),
    })
}

/// `f` around one reversal, and its standard error; `None` where the window does not tell it.
fn jump(
    (joints, of): (&[JointSignals<'_>], usize),
    at: usize,
    period_ns: u64,
    told: &impl Fn(&usize) -> bool,
) -> Option<(f64, f64)> {
    let joint = &joints[of];
    let period = period_ns as f64 * 1e-9;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
    let half = (WINDOW / period).round().clamp(1.0, 1e6) as usize;
    let from = at.checked_sub(half)?;
    let to = (at + half).min(joint.dq.len());
    if to < at + half {
        return None;
    }
    let rows: Vec<usize> = (from..to).filter(told).collect();
    let rows: Vec<usize> = rows.iter().copied().step_by((rows.len() / ROWS).max(1)).collect();
    let forward = rows.iter().filter(|k| joint.dq[**k] > 0.0).count();
    if forward < LEAST || rows.len() - forward < LEAST {
        return None;
    }
    let time = |k: usize| (k as f64 - at as f64) / half as f64;
    let mut columns: Vec<Vec<f64>> = vec![rows.iter().map(|k| joint.dq[*k].signum()).collect()];
    let moves = |other: &&JointSignals<'_>| rows.iter().any(|k| other.ddq[*k] != 0.0);
    for other in joints.iter().filter(moves) {
        columns.push(rows.iter().map(|k| other.ddq[*k]).collect());
    }
    for power in 0..POWERS {
        columns.push(rows.iter().map(|k| time(*k).powi(i32::from(power))).collect());
    }
    let x = DMatrix::from_fn(rows.len(), columns.len(), |row, column| columns[column][row]);
    coefficient(x, rows.iter().map(|&k| joint.tau[k]), 0)
}

/// One coefficient of a least-squares fit and its standard error, from the residual as if it were white;
/// `None` where the columns do not determine it.
fn coefficient(mut x: DMatrix<f64>, y: impl Iterator<Item = f64>, at: usize) -> Option<(f64, f64)> {
    let sizes: Vec<f64> = x.column_iter().map(|c| c.norm().max(f64::MIN_POSITIVE)).collect();
    for (mut column, size) in x.column_iter_mut().zip(&sizes) {
        column /= *size;
    }
    let y = DVector::from_iterator(x.nrows(), y);
    let normal = (x.transpose() * &x).cholesky()?;
    let solution = normal.solve(&(x.transpose() * &y));
    let spare = x.nrows().checked_sub(x.ncols()).filter(|spare| *spare > 0)?;
    let residual = (&y - &x * &solution).norm_squared() / spare as f64;
    let mut unit = DVector::zeros(x.ncols());
    unit[at] = 1.0;
    let variance = residual * normal.solve(&unit)[at];
    Some((solution[at] / sizes[at], variance.max(0.0).sqrt() / sizes[at]))
}

#[cfg(test)]
mod tests {
    use super::{DryFriction, pooled};
    use crate::trace::JointSignals;

    /// Two sines, a mass, gravity and dry friction; every 1 ms, without a filter.
    fn record(level: f64, turns: bool) -> [Vec<f64>; 4] {
        let rows = (0..6000_u32).map(|k| {
            let t = f64::from(k) * 1e-3;
            let (sin, cos) = (2.0 * t).sin_cos();
            let dq = if turns { 2.0 * cos } else { 3.0 + cos };
            let q = if turns { sin } else { 3.0 * t + 0.5 * sin };
            let ddq = if turns { -4.0 * sin } else { -2.0 * sin };
            let tau = 0.7 * ddq + 5.0 * q.sin() + 0.2 * dq + level * dq.signum();
            [q, dq, ddq, tau]
        });
        let rows: Vec<[f64; 4]> = rows.collect();
        core::array::from_fn(|i| rows.iter().map(|row| row[i]).collect())
    }

    fn found(level: f64, turns: bool) -> Option<DryFriction> {
        let [q, dq, ddq, tau] = &record(level, turns);
        let joint = JointSignals { name: "axis", q, dq, ddq, tau };
        DryFriction::of(&[joint], 0, 1_000_000, 40)
    }

    #[test]
    fn the_level_is_what_the_torque_jumps_by() {
        for level in [0.0, 0.05, 1.5] {
            let found = found(level, true).unwrap();
            // What gravity and smooth friction do is no polynomial: some hundredths of what they change by in a window.
            assert!((found.level_nm - level).abs() < 0.02, "{level}: {found:?}");
            assert!(found.low_nm <= found.level_nm && found.level_nm <= found.high_nm);
            assert_eq!(found.reversals, 4, "{found:?}");
        }
        assert!(found(1.0, false).is_none(), "it never turns round");
    }

    #[test]
    fn windows_that_know_less_count_less() {
        let both = pooled(&[(1.0, 0.01), (2.0, 1.0)]).unwrap();
        assert!((both.level_nm - 1.0).abs() < 1e-3 && both.reversals == 2, "{both:?}");
        // Apart by more than their own errors: the interval is of what they are apart by.
        let apart = pooled(&[(1.0, 1e-3), (1.2, 1e-3)]).unwrap();
        assert!(apart.low_nm < 1.0 && apart.high_nm > 1.2, "{apart:?}");
        assert!(pooled(&[]).is_none());
        assert!(pooled(&[(1.0, 0.0), (1.0, 0.0)]).unwrap().high_nm < 1.0 + 1e-6);
    }
}
