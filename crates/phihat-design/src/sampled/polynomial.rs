//! Small polynomials in `w = z − 1`, where a sampled loop's roots do not cancel.

use nalgebra::Complex;

/// Coefficients of `w⁰, w¹, …`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SampledPolynomial(Vec<f64>);

impl SampledPolynomial {
    pub(crate) fn new(coefficients: Vec<f64>) -> Self {
        Self(coefficients)
    }

    pub(crate) fn one() -> Self {
        Self(vec![1.0])
    }

    /// `z^k = (1 + w)^k`.
    pub(crate) fn z_power(k: usize) -> Self {
        let z = Self(vec![1.0, 1.0]);
        (0..k).fold(Self::one(), |product, _| product.times(&z))
    }

    /// Of `w⁰, w¹, …`.
    pub(crate) fn coefficients(&self) -> &[f64] {
        &self.0
    }

    pub(crate) fn degree(&self) -> usize {
        self.0.len().saturating_sub(1)
    }

    pub(crate) fn times(&self, other: &Self) -> Self {
        let mut out = vec![0.0; self.0.len() + other.0.len() - 1];
        for (i, x) in self.0.iter().enumerate() {
            for (j, y) in other.0.iter().enumerate() {
                out[i + j] += x * y;
            }
        }
        Self(out)
    }

    pub(crate) fn plus(&self, other: &Self) -> Self {
        let length = self.0.len().max(other.0.len());
        let at = |p: &Self, i: usize| p.0.get(i).copied().unwrap_or(0.0);
        Self((0..length).map(|i| at(self, i) + at(other, i)).collect())
    }

    pub(crate) fn scaled(&self, factor: f64) -> Self {
        Self(self.0.iter().map(|c| c * factor).collect())
    }

    /// `w^k` times this.
    pub(crate) fn raised(&self, k: usize) -> Self {
        let mut out = vec![0.0; k];
        out.extend(&self.0);
        Self(out)
    }

    /// Without its lowest coefficients, which are nothing but rounding.
    pub(crate) fn without_lowest(mut self, count: usize) -> Self {
        self.0.iter_mut().take(count).for_each(|lowest| *lowest = 0.0);
        self
    }

    pub(crate) fn at(&self, w: Complex<f64>) -> Complex<f64> {
        self.0.iter().rev().fold(Complex::new(0.0, 0.0), |sum, c| sum * w + c)
    }

    /// `Σ |c_k| r^k`: bounds the value, and its rounding, where `|w| ≤ r`.
    pub(crate) fn size(&self, r: f64) -> f64 {
        self.0.iter().rev().fold(0.0, |sum, c| sum * r + c.abs())
    }

    /// `Σ k |c_k| r^{k−1}`: bounds the derivative where `|w| ≤ r`.
    pub(crate) fn slope(&self, r: f64) -> f64 {
        let terms = self.0.iter().enumerate().skip(1).rev();
        terms.fold(0.0, |sum, (k, c)| sum * r + k as f64 * c.abs())
    }
}

/// `w = ρ e^{jθ} − 1`, without cancellation near `θ = 0`, `ρ = 1`.
pub(crate) fn on_circle(theta: f64, radius: f64) -> Complex<f64> {
    let (half, full) = (libm::sin(theta / 2.0), libm::sin(theta));
    Complex::new((radius - 1.0) - 2.0 * radius * half * half, radius * full)
}
