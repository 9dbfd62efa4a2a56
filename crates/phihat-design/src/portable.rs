//! Functions of complex numbers and products of matrices with the same bits on every machine.
//!
//! Those of `num-complex` take sine, exponential and root of squares from the machine's library; a product of
//! `nalgebra` is fused where the processor at hand can do that.

use nalgebra::{Complex, DMatrix};

/// `|z|`.
pub(crate) fn size(z: Complex<f64>) -> f64 {
    libm::hypot(z.re, z.im)
}

/// Argument of `z` \[rad\], in (−π, π].
pub(crate) fn phase(z: Complex<f64>) -> f64 {
    libm::atan2(z.im, z.re)
}

/// `r e^{jθ}`.
pub(crate) fn polar(r: f64, theta: f64) -> Complex<f64> {
    let (sine, cosine) = libm::sincos(theta);
    Complex::new(r * cosine, r * sine)
}

/// `e^z`.
pub(crate) fn exp(z: Complex<f64>) -> Complex<f64> {
    polar(libm::exp(z.re), z.im)
}

/// `ln z`, its principal value.
pub(crate) fn ln(z: Complex<f64>) -> Complex<f64> {
    Complex::new(libm::log(size(z)), phase(z))
}

/// `zˣ`, its principal value.
pub(crate) fn power(z: Complex<f64>, x: f64) -> Complex<f64> {
    polar(libm::pow(size(z), x), x * phase(z))
}

/// `a b`, column by column.
pub(crate) fn product(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let mut product = DMatrix::zeros(a.nrows(), b.ncols());
    for (mut to, from) in product.column_iter_mut().zip(b.column_iter()) {
        to.gemv(1.0, a, &from, 0.0);
    }
    product
}

#[cfg(test)]
mod tests {
    use nalgebra::{Complex, DMatrix};

    use super::{exp, ln, phase, polar, power, product, size};

    #[test]
    fn functions_are_those_of_the_package_but_for_rounding() {
        for (re, im) in [(0.3, 0.4), (-1.5, 0.2), (-0.01, -2.0), (2.0, 0.0), (0.0, 1.0)] {
            let z = Complex::new(re, im);
            let near =
                |a: Complex<f64>, b: Complex<f64>| (a - b).norm() <= 4e-16 * b.norm().max(1.0);
            assert!(near(exp(z), z.exp()) && near(ln(z), z.ln()), "{z}");
            assert!(near(power(z, 0.37), z.powf(0.37)), "{z}");
            assert!(near(polar(size(z), phase(z)), z), "{z}");
        }
    }

    #[test]
    fn a_product_is_that_of_the_package_but_for_rounding() {
        let entry = |i: usize, j: usize| 1.0 / (1.0 + i as f64 + 2.0 * j as f64);
        let (a, b) = (DMatrix::from_fn(9, 7, entry), DMatrix::from_fn(7, 8, entry));
        assert!((product(&a, &b) - &a * &b).abs().max() < 1e-14);
    }
}
