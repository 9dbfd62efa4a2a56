//! Inertia that changes from sample to sample: one quadratic form for the sampled loop.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::common_form::{definite, exists, first_proved, widest};
use super::model::LoopModel;
use super::refutation::{plausible, plausible_loop, refuse};
use super::state_matrix::StateMatrix;
use crate::JointRecord;
use crate::claims::Refutation;
use crate::claims::matrix::{Matrix, is_symmetric, product, sum, transpose};

const CLAIM: &str = "varying inertia, sampled";

/// A range of inertia ratios through which the arm may move from sample to sample, by any steps.
///
/// # Claim
///
/// For the loop as it is sampled, with its delay, velocity source, filter and drive; for one or more joints with
/// these same gains in this same loop; and `W_k = M̄^{1/2} M(q)⁻¹ M̄^{1/2}` constant over each sample interval, with
/// eigenvalues in `[1/high, 1/low]`, different in any way from one interval to the next: `V = xᵀ(P ⊗ I)x`
/// decreases at every sample along
///
/// ```text
/// x_{k+1} = A(W_k) x_k,   A(1/μ) the state matrix of the loop                                       (V2)
/// ```
///
/// # Evidence
///
/// `P`. `A` is affine in `W`, so `V(x_{k+1})` is convex in it, and the ends suffice: `P ≻ 0` and
/// `P − AᵀPA ≻ 0` at `low` and at `high`, each checked by Cholesky.
///
/// # Not claimed
///
/// Inertia that changes within an interval, and Coriolis torque: both enter as a disturbance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SampledVarying {
    /// Smallest `μ`.
    pub low: f64,
    /// Largest `μ`.
    pub high: f64,
    /// `P`, row by row, for the state of [`StateMatrix`].
    pub p: Vec<Vec<f64>>,
}

impl SampledVarying {
    /// Finds `P` for a range.
    ///
    /// # Method
    ///
    /// Cayley's `C = (A − I)(A + I)⁻¹` keeps `P` and turns the sampled inequality into the continuous one; the
    /// two ends still differ by rank one.
    ///
    /// # Errors
    ///
    /// [`Refutation`] when there is no such `P`, or none was found.
    pub fn find(
        gains: &JointRecord,
        model: &LoopModel,
        (low, high): (f64, f64),
    ) -> Result<Self, Refutation> {
        plausible(CLAIM, gains)?;
        plausible_loop(CLAIM, model)?;
        let ends = [low, high].map(|mu| StateMatrix::new(gains, model, mu).matrix().clone());
        let cayley = |a: &DMatrix<f64>| {
            let n = a.nrows();
            let unit = DMatrix::<f64>::identity(n, n);
            let inverse = (a + &unit).try_inverse();
            inverse.map(|inverse| unit - inverse * 2.0)
        };
        let (Some(fast), Some(slow)) = (cayley(&ends[0]), cayley(&ends[1])) else {
            return Err(refuse(CLAIM, "A + I is invertible", 0.0, 1.0));
        };
        exists(CLAIM, &fast, &slow)?;
        let (b, c) = rank_one(&(&slow - &fast));
        first_proved(CLAIM, &slow, (&b, &c), |p| {
            let found = Self { low, high, p };
            found.verify(gains, model).map(|()| found)
        })
    }

    /// The widest part of a range that has a form, from the geometric mean of its ends outwards.
    ///
    /// # Errors
    ///
    /// [`Refutation`] when there is none.
    pub fn widest_within(
        gains: &JointRecord,
        model: &LoopModel,
        (low, high): (f64, f64),
    ) -> Result<Self, Refutation> {
        let centre = (low * high).sqrt();
        widest(high / low, |ratio| {
            Self::find(gains, model, (centre / ratio.sqrt(), centre * ratio.sqrt()))
        })
    }

    /// Checks the three definiteness conditions.
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming the inequality and its least pivot.
    pub fn verify(&self, gains: &JointRecord, model: &LoopModel) -> Result<(), Refutation> {
        plausible(CLAIM, gains)?;
        plausible_loop(CLAIM, model)?;
        if !(0.0 < self.low && self.low <= self.high && self.high.is_finite()) {
            return Err(refuse(CLAIM, "0 < low ≤ high", self.low, self.high));
        }
        let [fast, slow] = [self.low, self.high].map(|mu| rows(gains, model, mu));
        if !is_symmetric(&self.p, fast.len()) {
            return Err(refuse(CLAIM, "P = Pᵀ, of the loop's size", 0.0, 1.0));
        }
        definite(CLAIM, "P ≻ 0", &self.p)?;
        let falls = |a: &Matrix| sum(&self.p, -1.0, &product(&transpose(a), &product(&self.p, a)));
        definite(CLAIM, "P − AᵀPA ≻ 0 at low", &falls(&fast))?;
        definite(CLAIM, "P − AᵀPA ≻ 0 at high", &falls(&slow))
    }
}

fn rows(gains: &JointRecord, model: &LoopModel, mu: f64) -> Matrix {
    let matrix = StateMatrix::new(gains, model, mu);
    matrix.matrix().row_iter().map(|row| row.iter().copied().collect()).collect()
}

/// `D = b cᵀ` from its largest row and that row's largest entry, `c` of unit length.
fn rank_one(d: &DMatrix<f64>) -> (DVector<f64>, DVector<f64>) {
    let row = d.row_iter().max_by(|a, b| a.norm().total_cmp(&b.norm()));
    let c = row.map_or_else(|| DVector::zeros(0), |row| row.transpose());
    let c = &c / c.norm().max(f64::MIN_POSITIVE);
    (d * &c, c)
}
