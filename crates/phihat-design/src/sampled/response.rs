//! Sums over the loop's whole future, with a bound on what is left out.

use nalgebra::{DMatrix, DVector, RowDVector};
use phihat_certificate::extremes::{Extremes as _, larger};

use super::state_matrix::{Reaction, StateMatrix};

/// Powers are taken until this is left of the largest state.
const LEFT: f64 = 1e-12;

/// Longest horizon is `2^DOUBLINGS` samples.
const DOUBLINGS: u32 = 21;

/// After how many samples the loop has forgotten, and what is left then: `‖A^samples‖_∞ = left < 1`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Horizon {
    pub(crate) samples: usize,
    left: f64,
}

impl Horizon {
    /// `None` when the loop does not forget.
    pub(crate) fn of(a: &DMatrix<f64>) -> Option<Self> {
        let mut power = a.clone();
        for doublings in 0..=DOUBLINGS {
            let left = norm_inf(&power);
            if !left.is_finite() {
                return None;
            }
            if left < LEFT {
                return Some(Self { samples: 1 << doublings, left });
            }
            power = &power * &power;
        }
        None
    }

    /// Given `Σ_{j<N} ‖c A^j‖₁`, bounds `Σ_{j≥N} |c A^j b|` for `‖b‖_∞ ≤ size`.
    pub(crate) fn tail(&self, rows: f64, size: f64) -> f64 {
        rows * size * self.left / (1.0 - self.left)
    }
}

/// Shows `c A^j` for `j = 0 … N−1` as a column; gives `Σ ‖c A^j‖₁`.
pub(crate) fn sweep(
    a: &DMatrix<f64>,
    row: DVector<f64>,
    horizon: Horizon,
    mut visit: impl FnMut(&DVector<f64>),
) -> f64 {
    let mut now = row;
    let mut next = now.clone();
    let mut total = 0.0;
    for _ in 0..horizon.samples {
        visit(&now);
        total += now.iter().map(|v| v.abs()).sum::<f64>();
        next.gemv_tr(1.0, a, &now, 0.0);
        core::mem::swap(&mut now, &mut next);
    }
    total
}

/// Torque (in units of `M̄`) after a unit impulse of an input: `h_0, h_1, …`, and a bound on the rest.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Response {
    pub(crate) samples: Vec<f64>,
    /// Bounds `Σ |h_k|` beyond the samples.
    pub(crate) tail: f64,
}

impl Response {
    /// `None` when the loop is unstable.
    pub(crate) fn of(matrix: &StateMatrix, reaction: &Reaction) -> Option<Self> {
        let horizon = Horizon::of(matrix.matrix())?;
        let mut samples = vec![reaction.direct];
        let row = column(&reaction.state);
        let rows = sweep(matrix.matrix(), row, horizon, |row| {
            samples.push(row.dot(&reaction.drives));
        });
        Some(Self { samples, tail: horizon.tail(rows, reaction.drives.amax()) })
    }

    /// `h_k − h_{k−1}`: what the torque changes by.
    pub(crate) fn changes(&self) -> Self {
        let mut last = 0.0;
        let change = |h: &f64| h - core::mem::replace(&mut last, *h);
        Self { samples: self.samples.iter().map(change).collect(), tail: 2.0 * self.tail }
    }

    /// At most `Σ |h_k|`: the largest output for inputs of size 1.
    pub(crate) fn sum(&self) -> f64 {
        self.samples.iter().map(|h| h.abs()).sum::<f64>() + self.tail
    }

    /// At most `√(Σ h_k²)`: the rms of the output for white input of rms 1.
    pub(crate) fn root_of_squares(&self) -> f64 {
        self.samples.iter().map(|h| h * h).sum::<f64>().sqrt() + self.tail
    }

    /// At most the largest `|h_k|`.
    pub(crate) fn peak(&self) -> f64 {
        larger(self.tail, self.samples.iter().map(|h| h.abs()).largest())
    }

    /// At most the largest `|h_0 + … + h_k|`: the peak after a unit step.
    pub(crate) fn step_peak(&self) -> f64 {
        let mut sum = 0.0_f64;
        let worst = self.samples.iter().fold(0.0_f64, |worst, h| {
            sum += h;
            larger(worst, sum.abs())
        });
        worst + self.tail
    }
}

pub(crate) fn column(row: &RowDVector<f64>) -> DVector<f64> {
    row.transpose()
}

fn norm_inf(a: &DMatrix<f64>) -> f64 {
    a.row_iter().map(|row| row.iter().map(|v| v.abs()).sum()).largest()
}

/// `count` ratios from `low` to `high`, logarithmically even.
pub(crate) fn ratios(low: f64, high: f64, count: u32) -> impl Iterator<Item = f64> {
    let last = f64::from(count.max(2) - 1);
    (0..count.max(2)).map(move |k| low * (high / low).powf(f64::from(k) / last))
}
