//! The coefficients with which the core runs the estimator, found independently of it.

use nalgebra::DMatrix;

/// `α_0 T^m, α_1 T^{m−1}, …, α_{m−1} T`: coefficients in `w = z − 1` of `Π (w − (e^{s_i T} − 1))`, `s_i`
/// the roots of `A_o`, without the leading 1.
///
/// # Method
///
/// `E = e^{FT} − 1` of the companion matrix `F`, balanced, by its series after halving and
/// `e^{2X} − 1 = E(E + 2)`; its characteristic polynomial by Faddeev and LeVerrier.
pub(crate) fn sampled_coefficients(a: &[f64], period: f64) -> Vec<f64> {
    let m = a.len();
    let top = a.last().copied().unwrap_or(1.0);
    let mut f = DMatrix::<f64>::zeros(m, m);
    for i in 0..m {
        // Row i of the companion matrix of A_o(top·s), transposed observer form.
        f[(i, 0)] = -a[m - 1 - i] / top.powi(power(i + 1));
        if i + 1 < m {
            f[(i, i + 1)] = 1.0;
        }
    }
    let step = top * period;
    let mut halvings = 0;
    let mut size = step * (1.0 + f.amax());
    while size > 0.1 && halvings < 60 {
        size *= 0.5;
        halvings += 1;
    }
    let x = f * (step / 2.0_f64.powi(halvings));
    let mut term = x.clone();
    let mut e = x.clone();
    for k in 2..18_u8 {
        term = &term * &x / f64::from(k);
        e += &term;
    }
    for _ in 0..halvings {
        e = &e * &e + &e * 2.0;
    }
    characteristic_polynomial(&e)
}

/// `α_0 … α_{m−1}` of (T5), in SI units.
pub(crate) fn estimator_coefficients(a: &[f64], period: f64) -> Vec<f64> {
    let mut scaled = sampled_coefficients(a, period);
    let mut factor = 1.0;
    for entry in scaled.iter_mut().rev() {
        factor *= period;
        *entry /= factor;
    }
    scaled
}

/// `c_0 … c_{n−1}` of `det(w − E) = w^n + c_{n−1} w^{n−1} + … + c_0`.
fn characteristic_polynomial(e: &DMatrix<f64>) -> Vec<f64> {
    let n = e.nrows();
    let identity = DMatrix::<f64>::identity(n, n);
    let mut coefficients = vec![0.0; n];
    let mut work = DMatrix::<f64>::zeros(n, n);
    let mut last = 1.0;
    for k in 1..=n {
        work = e * (work + &identity * last);
        last = -work.trace() / k as f64;
        coefficients[n - k] = last;
    }
    coefficients
}

fn power(k: usize) -> i32 {
    i32::try_from(k).unwrap_or(i32::MAX)
}
