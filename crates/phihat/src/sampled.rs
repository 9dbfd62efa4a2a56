//! The estimator's coefficients for a sampled loop, so that its poles are the exact images of the
//! continuous ones.

use crate::ORDER_MAX;
use crate::square::{characteristic_polynomial, product};

type SampledSquare = [[f64; ORDER_MAX]; ORDER_MAX];

/// Coefficients `α_0 … α_{m−1}` of the estimator in the difference operator `δ = (z − 1)/T`.
///
/// ```text
/// A_o(s) = Π (s − s_i)      →      Π (δ − (e^{s_i T} − 1)/T) = δ^m + α_{m−1} δ^{m−1} + … + α_0     (1)
/// ```
///
/// With these in place of `a_i`, forward differences place the estimator's sampled poles exactly at
/// `e^{s_i T}`, and keep `m` integrators in the loop: a polynomial `φ` of degree `m − 1` is still
/// estimated without error. For m = 1, `α_0 = (1 − e^{−a_0 T})/T`.
///
/// # Method
///
/// The companion matrix `F` of `A_o` is scaled by `a_{m−1}`, `E = e^{FT} − 1` summed by its Taylor
/// series after halving, doubled back by `e^{2X} − 1 = E(E + 2)`, and the characteristic polynomial of
/// `E/T` read off by Faddeev and LeVerrier. No cancellation occurs near `z = 1`.
pub(crate) fn sampled_coefficients(a: &[f64], period: f64) -> [f64; ORDER_MAX] {
    let m = a.len().min(ORDER_MAX);
    let scale = a.last().copied().unwrap_or(1.0);
    let step = scale * period;
    let mut x = companion(a, scale);
    let mut halvings = 0_u32;
    let mut factor = step;
    while factor > 0.125 && halvings < 64 {
        factor *= 0.5;
        halvings += 1;
    }
    each(&mut x, |v| v * factor);
    let mut e = exponential_minus_one(&x, m);
    for _ in 0..halvings {
        let square = product(&e, &e, m);
        e = sum(&square, &e, 2.0);
    }
    each(&mut e, |v| v / step);
    let mut alpha = characteristic_polynomial(&e, m);
    let mut power = 1.0;
    for coefficient in alpha.iter_mut().take(m).rev() {
        power *= scale;
        *coefficient *= power;
    }
    alpha
}

/// `F/scale` for the state `(r, η_1, …, η_{m−1})` of (T4), in time units of `1/scale`.
fn companion(a: &[f64], scale: f64) -> SampledSquare {
    let mut f = SampledSquare::default();
    let mut power = 1.0;
    for (row, coefficient) in a.iter().rev().enumerate().take(ORDER_MAX) {
        power *= scale;
        let scaled = coefficient / power;
        if let Some(entry) = f.get_mut(row).and_then(|r| r.first_mut()) {
            *entry = if row == 0 { -scaled } else { scaled };
        }
        if row + 1 < a.len() {
            if let Some(entry) = f.get_mut(row).and_then(|r| r.get_mut(row + 1)) {
                *entry = if row == 0 { -1.0 } else { 1.0 };
            }
        }
    }
    f
}

/// `e^X − 1` by its Taylor series; `X` is small, so 20 terms reach the last bit.
fn exponential_minus_one(x: &SampledSquare, m: usize) -> SampledSquare {
    let mut term = *x;
    let mut total = *x;
    for k in 2..20_u8 {
        term = product(&term, x, m);
        each(&mut term, |v| v / f64::from(k));
        total = sum(&total, &term, 1.0);
    }
    total
}

/// `a + factor·b`.
fn sum(a: &SampledSquare, b: &SampledSquare, factor: f64) -> SampledSquare {
    let mut out = *a;
    for (row, other) in out.iter_mut().zip(b) {
        for (entry, value) in row.iter_mut().zip(other) {
            *entry += factor * value;
        }
    }
    out
}

fn each(a: &mut SampledSquare, f: impl Fn(f64) -> f64) {
    a.iter_mut().flatten().for_each(|v| *v = f(*v));
}
