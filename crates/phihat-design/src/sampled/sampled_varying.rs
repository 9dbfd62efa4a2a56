//! Inertia that changes from sample to sample: one quadratic form for the sampled loop.

use nalgebra::{DMatrix, DVector};
pub use phihat_certificate::SampledVarying;

use super::common_form::{exists, first_proved, widest};
use super::model::LoopModel;
use super::refutation::{plausible, plausible_loop, refuse};
use super::state_matrix::StateMatrix;
use crate::JointRecord;
use crate::claims::Refutation;

const CLAIM: &str = "varying inertia, sampled";

/// Finding a [`SampledVarying`].
pub trait FindSampledVarying: Sized {
    /// Finds a common quadratic form `P` for a range of inertia ratios.
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
}

/// `D = b cᵀ` from its largest row and that row's largest entry, `c` of unit length.
fn rank_one(d: &DMatrix<f64>) -> (DVector<f64>, DVector<f64>) {
    let row = d.row_iter().max_by(|a, b| a.norm().total_cmp(&b.norm()));
    let c = row.map_or_else(|| DVector::zeros(0), |row| row.transpose());
    let c = &c / c.norm().max(f64::MIN_POSITIVE);
    (d * &c, c)
}
