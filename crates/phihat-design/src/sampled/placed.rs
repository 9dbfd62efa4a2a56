//! An observer of position from its poles.

use super::polynomial::SampledPolynomial;

/// Poles of an observer in continuous time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Poles {
    /// `s = −w` \[rad/s\].
    Real { w: f64 },
    /// `s² + 2zws + w²`.
    Pair { w: f64, z: f64 },
}

impl Poles {
    /// `c_0, c_1` of the factor in `w = z − 1` that has the sampled poles, `w² + c_1 w + c_0` for a pair.
    pub(crate) fn rates(self, period: f64) -> [f64; 2] {
        let factor = self.sampled(period);
        let at = |i: usize| factor.coefficients().get(i).copied().unwrap_or(0.0);
        [at(0), at(1)]
    }

    /// The factor in `w = z − 1` with the sampled poles `e^{sT} − 1`.
    fn sampled(self, period: f64) -> SampledPolynomial {
        match self {
            Self::Real { w } => SampledPolynomial::new(vec![-libm::expm1(-w * period), 1.0]),
            Self::Pair { w, z } => {
                let rate = w * period;
                let (turn, split) = (rate * libm::sqrt((1.0 - z * z).abs()), z > 1.0);
                if split {
                    let [a, b] = [-z * rate + turn, -z * rate - turn].map(|x| -libm::expm1(x));
                    return SampledPolynomial::new(vec![a * b, a + b, 1.0]);
                }
                // 1 − e^{−zwT} cos, without cancellation: 1 − e^x + 2 e^x sin²(turn/2).
                let left = libm::exp(-z * rate);
                let half = libm::sin(0.5 * turn);
                let real = -libm::expm1(-z * rate) + 2.0 * left * half * half;
                let imaginary = left * libm::sin(turn);
                SampledPolynomial::new(vec![real * real + imaginary * imaginary, 2.0 * real, 1.0])
            }
        }
    }
}

/// `ℓ` of an observer of `ê`, `ė̂`, `φ̂/M̄` and its derivatives with these `m + 2` poles.
///
/// # Method
///
/// In `w = z − 1`, with `ℓ'_i = ℓ_i T^i`:
///
/// ```text
/// A_o = w^{m+2} + ℓ'_0 w^{m+1} + ℓ'_1 (w + 1)w^m − (1 + w)(1 + w/2) Σ_j ℓ'_{2+j} w^{m−1−j}
/// ```
///
/// solved from the lowest power upwards.
pub(crate) fn correction(poles: &[Poles], period: f64) -> Vec<f64> {
    let wanted =
        poles.iter().fold(SampledPolynomial::one(), |p, pole| p.times(&pole.sampled(period)));
    let n = wanted.degree();
    let mut scaled = vec![0.0; n];
    let at = |list: &[f64], i: usize| list.get(i).copied().unwrap_or(0.0);
    for (k, c) in wanted.coefficients().iter().enumerate().take(n) {
        // Power k belongs to ℓ'_{n−1−k}; what those found before add to it.
        let own = n - 1 - k;
        let phi = |i: usize| if i >= 2 { at(&scaled, i) } else { 0.0 };
        let below = 1.5 * phi(own + 1) + 0.5 * phi(own + 2);
        scaled[own] = match own {
            0 => c + below - at(&scaled, 1),
            1 => c + below,
            _ => -(c + below),
        };
    }
    let mut power = 1.0;
    for entry in &mut scaled {
        *entry /= power;
        power *= period;
    }
    scaled
}
