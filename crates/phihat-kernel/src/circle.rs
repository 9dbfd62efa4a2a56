//! The circle `|z| = 1` as an interval: products of polynomials in `z` become polynomials in `t`.
//!
//! `z = e^{jθ}`, `t = sin²(θ/2)`, so `cos θ = 1 − 2t`, `sin²θ = 4t(1 − t)`, and `t` runs from 0 (`z = 1`) to 1
//! (`z = −1`). Coefficients are real, so the upper half of the circle stands for both.

use crate::{Number, Polynomial};

/// `Re(P Q*)` in `t`: `Σ a_k T_k(cos θ)`, `a_k` the sum of `p_i q_j` with `|i − j| = k`, `T_k` Chebyshev's polynomial
/// of the first kind.
pub(crate) fn real(p: &Polynomial, q: &Polynomial) -> Polynomial {
    let (above, below) = by_difference(p, q);
    let both = |k: usize| &above[k] + &below[k];
    let first: Vec<Number> =
        (0..above.len()).map(|k| if k == 0 { above[0].clone() } else { both(k) }).collect();
    sum(&first, &Polynomial::constant(&Number::from(1)), &cosine())
}

/// `Im(P Q*)/sin θ` in `t`: `Σ b_k U_{k−1}(cos θ)`, `b_k` the sum of `p_i q_j` with `i − j = k` less that with `i − j =
/// −k`,
/// `U_k` Chebyshev's polynomial of the second kind.
pub(crate) fn turned(p: &Polynomial, q: &Polynomial) -> Polynomial {
    let (above, below) = by_difference(p, q);
    let odd: Vec<Number> = (1..above.len()).map(|k| &above[k] - &below[k]).collect();
    let one = Polynomial::constant(&Number::from(1));
    sum(&odd, &one, &cosine().times(&Number::from(2)))
}

/// `sin²θ = 4t(1 − t)`.
pub(crate) fn sine_squared() -> Polynomial {
    Polynomial::new([0, 4, -4].map(Number::from).to_vec())
}

/// `cos θ = 1 − 2t`.
fn cosine() -> Polynomial {
    Polynomial::new([1, -2].map(Number::from).to_vec())
}

/// `Σ c_k F_k`, `F_{k+1} = 2 cos θ F_k − F_{k−1}`, from `F_0` and `F_1`.
fn sum(c: &[Number], first: &Polynomial, second: &Polynomial) -> Polynomial {
    let twice = cosine().times(&Number::from(2));
    let (mut own, mut next) = (first.clone(), second.clone());
    let mut total = Polynomial::new(Vec::new());
    for c in c {
        total = total.plus(&own.times(c));
        let after = twice.product(&next).minus(&own);
        own = core::mem::replace(&mut next, after);
    }
    total
}

/// Sums of `p_i q_j` by `i − j = k` and by `j − i = k`, `k` from 0 on; those of `k = 0` in both.
fn by_difference(p: &Polynomial, q: &Polynomial) -> (Vec<Number>, Vec<Number>) {
    let (p, q) = (p.coefficients(), q.coefficients());
    let length = p.len().max(q.len()).max(1);
    let (mut above, mut below) = (vec![Number::zero(); length], vec![Number::zero(); length]);
    for (i, x) in p.iter().enumerate() {
        for (j, y) in q.iter().enumerate() {
            let term = x * y;
            if i >= j {
                above[i - j] = &above[i - j] + &term;
            }
            if j >= i {
                below[j - i] = &below[j - i] + &term;
            }
        }
    }
    (above, below)
}
