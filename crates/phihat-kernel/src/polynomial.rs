//! Polynomials with exact coefficients.

use crate::Number;

/// Polynomial with exact coefficients, ascending; the last is not zero.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Polynomial(Vec<Number>);

impl Polynomial {
    /// `Σ c_k x^k`.
    pub fn new(mut coefficients: Vec<Number>) -> Self {
        while coefficients.last().is_some_and(Number::is_zero) {
            coefficients.pop();
        }
        Self(coefficients)
    }

    /// A number.
    pub fn constant(value: &Number) -> Self {
        Self::new(vec![value.clone()])
    }

    /// Coefficients, ascending; empty: the polynomial is zero.
    pub fn coefficients(&self) -> &[Number] {
        &self.0
    }

    /// Degree; 0 of the zero polynomial too.
    pub fn degree(&self) -> usize {
        self.0.len().saturating_sub(1)
    }

    /// `p + q`.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        let zero = Number::zero();
        let at = |p: &Self, k: usize| p.0.get(k).unwrap_or(&zero).clone();
        let length = self.0.len().max(other.0.len());
        Self::new((0..length).map(|k| &at(self, k) + &at(other, k)).collect())
    }

    /// `p − q`.
    #[must_use]
    pub fn minus(&self, other: &Self) -> Self {
        self.plus(&other.times(&Number::from(-1)))
    }

    /// `c p`.
    #[must_use]
    pub fn times(&self, factor: &Number) -> Self {
        Self::new(self.0.iter().map(|c| c * factor).collect())
    }

    /// `p q`.
    #[must_use]
    pub fn product(&self, other: &Self) -> Self {
        let mut out = vec![Number::zero(); (self.0.len() + other.0.len()).saturating_sub(1)];
        for (i, p) in self.0.iter().enumerate() {
            for (j, q) in other.0.iter().enumerate() {
                out[i + j] = &out[i + j] + &(p * q);
            }
        }
        Self::new(out)
    }

    /// `p(factor · x)`.
    #[must_use]
    pub fn scaled(&self, factor: &Number) -> Self {
        let mut power = Number::from(1);
        let term = |c: &Number| {
            let own = c * &power;
            power = &power * factor;
            own
        };
        Self::new(self.0.iter().map(term).collect())
    }

    /// `p(1 + x)`: the polynomial in `w = z − 1`.
    #[must_use]
    pub fn about_one(&self) -> Self {
        let mut own = self.0.clone();
        for i in 0..own.len() {
            for k in (i..own.len() - 1).rev() {
                own[k] = &own[k] + &own[k + 1];
            }
        }
        Self::new(own)
    }

    /// Number of roots at zero.
    pub(crate) fn roots_at_zero(&self) -> usize {
        self.0.iter().take_while(|c| c.is_zero()).count()
    }

    /// `p/x^count`, where there are so many roots at zero.
    pub(crate) fn without_roots_at_zero(&self, count: usize) -> Self {
        Self::new(self.0.iter().skip(count).cloned().collect())
    }
}
