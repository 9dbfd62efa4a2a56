//! Recorded signals, and the effective inertia of the one joint that moves in a record.

use nalgebra::{DMatrix, DVector};
use phihat_certificate::extremes::Extremes as _;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::undetermined::Undetermined;

/// Samples of a window that are used, evenly spread: neighbours tell the same.
const ROWS: usize = 200;

/// Standard errors on either side of an estimate.
pub(crate) const SIGMAS: f64 = 3.0;

/// A window counts when its standard error is below this share of its estimate.
const SHARP: f64 = 0.1;

/// Windows that must count, per joint.
const LEAST: usize = 3;

/// Recorded signals of one joint, one entry per sample, all of the same length.
#[derive(Debug, Clone, Copy)]
pub struct JointSignals<'a> {
    /// Joint name.
    pub name: &'a str,
    /// Position \[rad\].
    pub q: &'a [f64],
    /// Velocity \[rad/s\].
    pub dq: &'a [f64],
    /// Acceleration \[rad/s²\].
    pub ddq: &'a [f64],
    /// Torque that acted \[N·m\].
    pub tau: &'a [f64],
}

/// Interval of one joint's effective inertia `M_ii` from records: an estimate, not a proof. Postures that no record
/// visits are not in it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InertiaEstimate {
    /// Lower end \[kg·m²\].
    pub low_kg_m2: f64,
    /// Upper end \[kg·m²\].
    pub high_kg_m2: f64,
    /// Records that give an interval each; this one contains all of them.
    pub records: usize,
}

/// Why a trace tells no inertia.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum EstimateError {
    /// Signals of different length, or none.
    #[error("joint {joint}: {found} samples where {expected} are expected")]
    Length {
        /// Joint name.
        joint: String,
        /// Samples found.
        found: usize,
        /// Samples of the first joint's position.
        expected: usize,
    },
    /// The joint does not move enough.
    #[error(
        "joint {joint}: only {windows} parts of the record determine its inertia to {sharp} %, {least} are needed: \
         record a motion with more acceleration, at more than one frequency, different on each joint",
        sharp = SHARP * 100.0, least = LEAST
    )]
    Excitation {
        /// Joint name.
        joint: String,
        /// Windows that count.
        windows: usize,
    },
    /// A record does not determine a joint's inertia.
    #[error("joint {joint}: this record cannot tell its inertia: {why}")]
    Undetermined {
        /// Joint name.
        joint: String,
        /// The reason, and the motion that would.
        why: Undetermined,
    },
}

/// Windows over a record in which one joint moves: each is half of it, and they overlap.
const MOVING_WINDOWS: usize = 5;

/// Share of the largest speed below which a sample tells of stiction and of the filter, not of inertia.
const SLOW: f64 = 0.15;

/// Estimates the effective inertia of one joint from a record in which it goes to and fro in one posture, and
/// the others stand still: (R1) over halves of it, without the samples in which it hardly moves, and without `G_j` of
/// the others. The interval is that of two fits together, with `q̈_j` of the others, which give way a little, and
/// without: three standard errors on either side, as if the residual were white.
///
/// # Errors
///
/// [`EstimateError`]; [`EstimateError::Length`] where there is no such joint.
pub fn estimate_inertia_of(
    joints: &[JointSignals<'_>],
    of: usize,
) -> Result<InertiaEstimate, EstimateError> {
    same_length(joints)?;
    let Some(moved) = joints.get(of) else {
        let joint = format!("number {of}");
        return Err(EstimateError::Length { joint, found: 0, expected: joints.len() });
    };
    let fastest = moved.dq.iter().map(|dq| dq.abs()).largest();
    let (samples, mut found) = (moved.dq.len(), Windows::NONE);
    let length = samples / 2;
    for window in 0..MOVING_WINDOWS {
        let start = window * (samples - length) / (MOVING_WINDOWS - 1);
        let fast = |k: &usize| moved.dq[*k].abs() >= SLOW * fastest;
        let rows: Vec<usize> = (start..start + length).filter(fast).collect();
        let step = (rows.len() / (2 * ROWS)).max(1);
        let rows: Vec<usize> = rows.into_iter().step_by(step).collect();
        for others in [Others::Accelerate, Others::Stand] {
            found.take(fit(joints, of, &rows, others));
        }
    }
    if found.count < LEAST {
        let (joint, windows) = (moved.name.to_owned(), found.count);
        return Err(EstimateError::Excitation { joint, windows });
    }
    Ok(InertiaEstimate { low_kg_m2: found.low, high_kg_m2: found.high, records: 1 })
}

fn same_length(joints: &[JointSignals<'_>]) -> Result<(), EstimateError> {
    let expected = joints.first().map_or(0, |joint| joint.q.len());
    for joint in joints {
        for signal in [joint.q, joint.dq, joint.ddq, joint.tau] {
            if signal.len() != expected || expected == 0 {
                let (joint, found) = (joint.name.to_owned(), signal.len());
                return Err(EstimateError::Length { joint, found, expected });
            }
        }
    }
    Ok(())
}

/// Interval of the windows of a record so far.
struct Windows {
    low: f64,
    high: f64,
    count: usize,
}

impl Windows {
    /// Of none.
    const NONE: Self = Self { low: f64::INFINITY, high: 0.0, count: 0 };

    /// Takes the fit of one window, if it is sharp.
    fn take(&mut self, fitted: Option<(f64, f64)>) {
        let Some((inertia, error)) = fitted else { return };
        if !(inertia > 0.0 && error <= SHARP * inertia) {
            return;
        }
        self.low = self.low.min(inertia - SIGMAS * error);
        self.high = self.high.max(inertia + SIGMAS * error);
        self.count += 1;
    }
}

/// Motion of the other joints in a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Others {
    /// They stay where they are, and give way a little.
    Accelerate,
    /// None.
    Stand,
}

/// `M_ii` and its standard error over one window; `None` where the regressors do not tell it.
fn fit(
    joints: &[JointSignals<'_>],
    of: usize,
    rows: &[usize],
    others: Others,
) -> Option<(f64, f64)> {
    let n = joints.len();
    let start = *rows.first()?;
    let mut x = DMatrix::<f64>::zeros(rows.len(), 2 * n + 3);
    for (row, &k) in rows.iter().enumerate() {
        for (j, joint) in joints.iter().enumerate() {
            x[(row, j)] = joint.ddq[k];
            x[(row, n + j)] = joint.q[k] - joint.q[start];
        }
        x[(row, 2 * n)] = joints[of].dq[k];
        x[(row, 2 * n + 1)] = joints[of].dq[k].signum();
        x[(row, 2 * n + 2)] = 1.0;
    }
    // Columns of one size; those of joints at rest, and a sign that does not change, go.
    let all: Vec<usize> = (0..x.ncols()).collect();
    let constant = |c: usize| {
        let column = x.column(c);
        c != 2 * n + 2 && (column.max() - column.min()).abs() <= 1e-9 * (1.0 + column.amax())
    };
    let counts = |c: usize| match others {
        Others::Accelerate => c < n || c >= 2 * n || c == n + of,
        Others::Stand => c >= 2 * n || c == n + of,
    };
    let told = |&c: &usize| c == of || (counts(c) && !constant(c));
    let kept: Vec<usize> = all.into_iter().filter(told).collect();
    let at = kept.iter().position(|&c| c == of)?;
    let tau = rows.iter().map(|&k| joints[of].tau[k]);
    coefficient(x.select_columns(&kept), tau, at)
}

/// One coefficient of a least-squares fit and its standard error, from the residual as if it were white;
/// `None` where the columns do not determine it.
pub(crate) fn coefficient(
    mut x: DMatrix<f64>,
    y: impl Iterator<Item = f64>,
    at: usize,
) -> Option<(f64, f64)> {
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
