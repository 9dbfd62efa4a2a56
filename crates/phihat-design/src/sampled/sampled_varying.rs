//! Inertia that changes from sample to sample: one quadratic form for the sampled loop.

use nalgebra::{DMatrix, DVector};
pub use phihat_certificate::SampledVarying;

use super::common_form::{definite, exists, first_proved, widest};
use super::model::LoopModel;
use super::refutation::{plausible, plausible_loop, refuse};
use super::state_matrix::StateMatrix;
use crate::JointRecord;
use crate::claims::Refutation;
use crate::claims::matrix::{Matrix, is_symmetric, product, sum, transpose};

const CLAIM: &str = "varying inertia, sampled";

/// Finding a [`SampledVarying`].
pub trait FindSampledVarying: Sized {
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
    fn find(gains: &JointRecord, model: &LoopModel, range: (f64, f64)) -> Result<Self, Refutation>;

    /// The widest part of a range that has a form, from the geometric mean of its ends outwards.
    ///
    /// # Errors
    ///
    /// [`Refutation`] when there is none.
    fn widest_within(
        gains: &JointRecord,
        model: &LoopModel,
        range: (f64, f64),
    ) -> Result<Self, Refutation>;

    /// Checks the three definiteness conditions.
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming the inequality and its least pivot.
    fn verify(&self, gains: &JointRecord, model: &LoopModel) -> Result<(), Refutation>;
}

impl FindSampledVarying for SampledVarying {
    fn find(
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

    fn widest_within(
        gains: &JointRecord,
        model: &LoopModel,
        (low, high): (f64, f64),
    ) -> Result<Self, Refutation> {
        let centre = (low * high).sqrt();
        widest(high / low, |ratio| {
            Self::find(gains, model, (centre / ratio.sqrt(), centre * ratio.sqrt()))
        })
    }

    fn verify(&self, gains: &JointRecord, model: &LoopModel) -> Result<(), Refutation> {
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
