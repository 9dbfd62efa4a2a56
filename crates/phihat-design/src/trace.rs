//! The effective inertia of each joint, estimated from recorded signals.

use nalgebra::{DMatrix, DVector};
use phihat_certificate::extremes::Extremes as _;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Length of a window \[ns\], and from one to the next.
const WINDOW_NS: (u64, u64) = (1_000_000_000, 250_000_000);

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

/// Estimate of one joint's effective inertia `M_ii` from a trace.
///
/// # Method
///
/// Least squares over windows of one second,
///
/// ```text
/// τ_i = Σ_j M_ij q̈_j + Σ_j G_j (q_j − q̄_j) + d q̇_i + c sign(q̇_i) + τ_0                              (R1)
/// ```
///
/// with `M_ij`, `G_j`, `d`, `c`, `τ_0` constant within each. Kept are windows whose standard error, from the residual
/// and the regressors as if the residual were white, is below a tenth of the estimate; the interval is from the
/// least estimate less three standard errors to the largest plus three.
///
/// # Not claimed
///
/// An estimate, not a proof: residuals are not white, and postures that the trace does not visit are not in it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InertiaEstimate {
    /// Lower end \[kg·m²\].
    pub low_kg_m2: f64,
    /// Upper end \[kg·m²\].
    pub high_kg_m2: f64,
    /// Largest standard error of a window that counts \[kg·m²\].
    pub standard_error_kg_m2: f64,
    /// Windows that count.
    pub windows: usize,
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
    /// The joint does not move enough, or not differently enough from the others.
    #[error(
        "joint {joint}: only {windows} windows of 1 s tell its inertia to {sharp} %, {least} are needed: \
         record a motion with more acceleration, at more than one frequency, different on each joint",
        sharp = SHARP * 100.0, least = LEAST
    )]
    Excitation {
        /// Joint name.
        joint: String,
        /// Windows that count.
        windows: usize,
    },
}

/// Estimates every joint's effective inertia.
///
/// # Errors
///
/// [`EstimateError`].
pub fn estimate_inertia(
    joints: &[JointSignals<'_>],
    period_ns: u64,
) -> Result<Vec<InertiaEstimate>, EstimateError> {
    same_length(joints)?;
    (0..joints.len()).map(|of| estimate(joints, of, period_ns)).collect()
}

/// Windows over a record in which one joint moves: each is half of it, and they overlap.
const MOVING_WINDOWS: usize = 5;

/// Share of the largest speed below which a sample tells of stiction and of the filter, not of inertia.
const SLOW: f64 = 0.15;

/// Estimates the effective inertia of one joint from a record in which it goes to and fro in one posture, and
/// the others stand still: (R1) over longer windows than those of [`estimate_inertia`], without the samples
/// in which it hardly moves, and without `G_j` of the others. The interval is that of two fits together: with
/// `q̈_j` of the others, which give way a little, and without.
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
    let (samples, mut found) = (moved.dq.len(), InertiaEstimate::NONE);
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
    found.told(moved.name)
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

fn estimate(
    joints: &[JointSignals<'_>],
    of: usize,
    period_ns: u64,
) -> Result<InertiaEstimate, EstimateError> {
    let samples = joints[of].q.len();
    let count = |ns: u64| usize::try_from(ns / period_ns.max(1)).unwrap_or(usize::MAX).max(1);
    let (length, stride) = (count(WINDOW_NS.0), count(WINDOW_NS.1));
    let (mut found, mut start) = (InertiaEstimate::NONE, 0);
    while samples.saturating_sub(start) >= length {
        let step = (length / ROWS).max(1);
        let rows: Vec<usize> = (start..start + length).step_by(step).collect();
        found.take(fit(joints, of, &rows, Others::Move));
        start += stride;
    }
    found.told(joints[of].name)
}

impl InertiaEstimate {
    /// Of no window.
    const NONE: Self =
        Self { low_kg_m2: f64::INFINITY, high_kg_m2: 0.0, standard_error_kg_m2: 0.0, windows: 0 };

    /// Takes what one window says, if it is sharp.
    fn take(&mut self, fitted: Option<(f64, f64)>) {
        let Some((inertia, error)) = fitted else { return };
        if !(inertia > 0.0 && error <= SHARP * inertia) {
            return;
        }
        self.low_kg_m2 = self.low_kg_m2.min(inertia - SIGMAS * error);
        self.high_kg_m2 = self.high_kg_m2.max(inertia + SIGMAS * error);
        self.standard_error_kg_m2 = self.standard_error_kg_m2.max(error);
        self.windows += 1;
    }

    /// Itself, if enough windows said something.
    fn told(self, joint: &str) -> Result<Self, EstimateError> {
        if self.windows < LEAST {
            let (joint, windows) = (joint.to_owned(), self.windows);
            return Err(EstimateError::Excitation { joint, windows });
        }
        Ok(self)
    }
}

/// Motion of the other joints in a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Others {
    /// Free.
    Move,
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
        Others::Move => true,
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
