//! Inertia that changes while the arm moves: one quadratic form for a whole range.

use nalgebra::{DMatrix, DVector};
pub use phihat_certificate::VaryingWindow;

use super::common_form::{exists, first_proved, widest};
use super::refutation::plausible;
use crate::JointRecord;
use crate::claims::Refutation;

const CLAIM: &str = "varying inertia";

/// Finding a [`VaryingWindow`].
pub trait FindVarying: Sized {
    /// Finds `P` for a range.
    ///
    /// # Method
    ///
    /// A Riccati equation for the two ends, which differ by rank one.
    ///
    /// # Errors
    ///
    /// [`Refutation`] when there is no such `P`, or none was found.
    fn find(gains: &JointRecord, range: (f64, f64)) -> Result<Self, Refutation>;

    /// The widest range that begins at `low`, up to `highest`, found to a part in a thousand.
    ///
    /// # Errors
    ///
    /// [`Refutation`] when there is none.
    fn widest_from(gains: &JointRecord, low: f64, highest: f64) -> Result<Self, Refutation>;

    /// The widest range `[centre/√ratio, centre·√ratio]`, up to a ratio, found to a part in a thousand.
    ///
    /// # Errors
    ///
    /// [`Refutation`] when there is none.
    fn widest_around(
        gains: &JointRecord,
        centre: f64,
        highest_ratio: f64,
    ) -> Result<Self, Refutation>;
}

impl FindVarying for VaryingWindow {
    fn find(gains: &JointRecord, (low, high): (f64, f64)) -> Result<Self, Refutation> {
        plausible(CLAIM, gains)?;
        let rate_per_s = rate(gains);
        let [fast, slow] = [low, high].map(|mu| matrix(gains, rate_per_s, 1.0 / mu));
        exists(CLAIM, &fast, &slow)?;
        let k = coefficients(gains, rate_per_s);
        let n = k.len();
        let c = DVector::from_fn(n, |i, _| (1.0 / low - 1.0 / high) * k[i]);
        let b = DVector::from_fn(n, |i, _| if i + 1 == n { 1.0 } else { 0.0 });
        first_proved(CLAIM, &slow, (&b, &c), |p| {
            let found = Self { low, high, rate_per_s, p };
            found.verify(gains).map(|()| found)
        })
    }

    fn widest_from(gains: &JointRecord, low: f64, highest: f64) -> Result<Self, Refutation> {
        widest(highest / low, |ratio| Self::find(gains, (low, low * ratio)))
    }

    fn widest_around(
        gains: &JointRecord,
        centre: f64,
        highest_ratio: f64,
    ) -> Result<Self, Refutation> {
        widest(highest_ratio, |ratio| {
            Self::find(gains, (centre / ratio.sqrt(), centre * ratio.sqrt()))
        })
    }
}

/// `k_1 … k_{m+2}` of (V1), in units of `rate`.
fn coefficients(gains: &JointRecord, rate: f64) -> Vec<f64> {
    let n = gains.a.len() + 2;
    let a =
        |i: usize| if i == gains.a.len() { 1.0 } else { gains.a.get(i).copied().unwrap_or(0.0) };
    let mut power = rate;
    let mut k = vec![0.0; n];
    for i in (0..n).rev() {
        let kd_part = if i >= 1 { a(i - 1) * gains.kd_per_s } else { 0.0 };
        let last = if i >= 2 { a(i - 2) } else { 0.0 };
        k[i] = (a(i) * gains.kp_per_s2 + kd_part + last) / power;
        power *= rate;
    }
    k
}

/// `k_1^{1/n}`: the geometric mean of the poles at `μ = 1`.
fn rate(gains: &JointRecord) -> f64 {
    let first = gains.kp_per_s2 * gains.a.first().copied().unwrap_or(1.0);
    libm::pow(first, 1.0 / (gains.a.len() + 2) as f64)
}

fn matrix(gains: &JointRecord, rate: f64, lambda: f64) -> DMatrix<f64> {
    let k = coefficients(gains, rate);
    let n = k.len();
    DMatrix::from_fn(n, n, |i, j| {
        if i + 1 == n { -lambda * k[j] } else { f64::from(u8::from(j == i + 1)) }
    })
}
