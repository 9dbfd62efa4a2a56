//! Polynomials with ascending coefficients: products, `|p(jω)|²`, and a proof of positivity.

/// `p q`.
pub fn product(p: &[f64], q: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; (p.len() + q.len()).saturating_sub(1)];
    for (i, x) in p.iter().enumerate() {
        for (j, y) in q.iter().enumerate() {
            out[i + j] += x * y;
        }
    }
    out
}

/// `p(w)`.
pub fn value(p: &[f64], w: f64) -> f64 {
    p.iter().rev().fold(0.0, |sum, c| sum * w + c)
}

/// `Re(p(jω) q(−jω))` as a polynomial in `w = ω²`, for real `p`, `q`.
///
/// `s^i (−s)^k` is real for `i + k` even, and then `(−1)^k s^{i+k} = (−1)^{k + (i+k)/2} w^{(i+k)/2}`.
pub fn real_part(p: &[f64], q: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; (p.len() + q.len()).saturating_sub(2) / 2 + 1];
    for (i, x) in p.iter().enumerate() {
        for (k, y) in q.iter().enumerate() {
            let half = usize::midpoint(i, k);
            if (i + k) % 2 == 0 {
                out[half] += if (k + half) % 2 == 0 { x * y } else { -x * y };
            }
        }
    }
    out
}

/// `|p(jω)|²` as a polynomial in `w = ω²`.
pub fn magnitude_squared(p: &[f64]) -> Vec<f64> {
    real_part(p, p)
}

/// Sign of a polynomial on `w ≥ 0`, as far as it is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sign {
    /// `p(w) ≥ 0` for all `w ≥ 0`.
    NonNegative,
    /// `p(w) < 0` at this `w` (infinite: the leading coefficient is negative).
    NegativeAt(f64),
    /// Closer to zero than rounding allows to decide, near this `w`.
    Undecided(f64),
}

/// Decides the sign of `p` on `w ≥ 0`.
///
/// # Method
///
/// Descartes first: no negative coefficient, or a negative first or last one, decides exactly. Otherwise
/// `w = w_0 t` for `t ≤ 1` and `w = w_0/t` beyond; on `[0, 1]` a polynomial lies between its smallest and
/// largest Bernstein coefficient, and halving the interval (de Casteljau) tightens both. Each
/// coefficient is kept with the same combination of absolute values, which bounds its rounding.
pub fn sign(p: &[f64]) -> Sign {
    let Some(degree) = p.iter().rposition(|c| c.is_nan() || c.abs() > 0.0) else {
        return Sign::NonNegative;
    };
    let p = &p[..=degree];
    if p.iter().any(|c| !c.is_finite()) {
        return Sign::Undecided(f64::NAN);
    }
    if p.first().is_some_and(|c| *c < 0.0) {
        return Sign::NegativeAt(0.0);
    }
    if p.last().is_some_and(|c| *c < 0.0) {
        return Sign::NegativeAt(f64::INFINITY);
    }
    if p.iter().all(|c| *c >= 0.0) {
        return Sign::NonNegative;
    }
    // Both ends of the scaled polynomial weigh the same: p_0 = p_d w_0^d (p_0 may be 0).
    let low = p.iter().position(|c| *c > 0.0).unwrap_or(0);
    let w0 = libm::pow(p[low] / p[degree], 1.0 / (degree - low).max(1) as f64);
    let scaled: Vec<f64> = (0_i32..).zip(p).map(|(k, c)| c * w0.powi(k)).collect();
    let reversed: Vec<f64> = scaled.iter().rev().copied().collect();
    for (half, beyond) in [(scaled, false), (reversed, true)] {
        match sign_on_unit(&bernstein(&half), 0.0, 1.0, 0) {
            Sign::NonNegative => {}
            Sign::NegativeAt(t) => return Sign::NegativeAt(if beyond { w0 / t } else { w0 * t }),
            Sign::Undecided(t) => return Sign::Undecided(if beyond { w0 / t } else { w0 * t }),
        }
    }
    Sign::NonNegative
}

/// Returns true if `p(w) ≥ 0` for all `w ≥ 0` is proven.
pub fn is_non_negative(p: &[f64]) -> bool {
    sign(p) == Sign::NonNegative
}

/// Bernstein coefficients on `[0, 1]`, each with the bound of its rounding.
fn bernstein(p: &[f64]) -> Vec<(f64, f64)> {
    let d = p.len() - 1;
    let mut out = Vec::with_capacity(p.len());
    for i in 0..=d {
        // C(i, k)/C(d, k), built up from k = 0.
        let (mut weight, mut sum, mut size) = (1.0, 0.0, 0.0);
        for k in 0..=i {
            sum += weight * p[k];
            size += weight * p[k].abs();
            weight *= (i - k) as f64 / (d - k).max(1) as f64;
        }
        out.push((sum, size));
    }
    out
}

/// Rounding of a Bernstein coefficient, relative to its sum of absolute values: the powers of `w_0`, the sum
/// of at most seven terms, and 40 halvings of 6 averages each.
const ROUNDING: f64 = 300.0 * f64::EPSILON;

fn sign_on_unit(b: &[(f64, f64)], t0: f64, t1: f64, depth: u32) -> Sign {
    if b.iter().all(|(c, size)| *c >= ROUNDING * size) {
        return Sign::NonNegative;
    }
    for ((c, size), t) in [b.first().map(|x| (x, t0)), b.last().map(|x| (x, t1))].iter().flatten() {
        if *c < -ROUNDING * size {
            return Sign::NegativeAt(*t);
        }
    }
    let middle = 0.5 * (t0 + t1);
    if depth == 40 || b.iter().all(|(c, size)| c.abs() < ROUNDING * size) {
        return Sign::Undecided(middle);
    }
    let (mut left, mut right, mut row) = (Vec::new(), Vec::new(), b.to_vec());
    while let (Some(first), Some(last)) = (row.first(), row.last()) {
        left.push(*first);
        right.push(*last);
        row = row.windows(2).map(|w| (0.5 * (w[0].0 + w[1].0), 0.5 * (w[0].1 + w[1].1))).collect();
    }
    right.reverse();
    match sign_on_unit(&left, t0, middle, depth + 1) {
        Sign::NonNegative => sign_on_unit(&right, middle, t1, depth + 1),
        negative => negative,
    }
}

/// Returns true if all roots of `p` have negative real parts: Routh's array has a positive first column.
pub fn is_hurwitz(p: &[f64]) -> bool {
    let mut upper: Vec<f64> = p.iter().rev().step_by(2).copied().collect();
    let mut lower: Vec<f64> = p.iter().rev().skip(1).step_by(2).copied().collect();
    while !lower.is_empty() {
        let positive = upper[0] > 0.0 && lower[0] > 0.0;
        if !positive {
            return false;
        }
        let ratio = upper[0] / lower[0];
        let entry = |i: usize| upper[i] - ratio * lower.get(i).copied().unwrap_or(0.0);
        let next: Vec<f64> = (1..upper.len()).map(entry).collect();
        upper = lower;
        lower = next;
    }
    upper.first().is_some_and(|c| *c > 0.0)
}
