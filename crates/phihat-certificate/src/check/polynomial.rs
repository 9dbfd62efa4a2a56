//! Polynomials of the frequency: squares of magnitudes, and proofs that they stay positive.

/// `p q`, coefficients ascending.
pub(crate) fn product(p: &[f64], q: &[f64]) -> Vec<f64> {
    let degree = (p.len() + q.len()).saturating_sub(1);
    let entry = |k: usize| (0..=k).map(|i| at(p, i) * at(q, k - i)).sum();
    (0..degree).map(entry).collect()
}

fn at(p: &[f64], k: usize) -> f64 {
    p.get(k).copied().unwrap_or(0.0)
}

/// `p(x)`.
pub(crate) fn value(p: &[f64], x: f64) -> f64 {
    p.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// `|p(jω)|²` in `w = ω²`: `p(jω) = E(−w) + jω O(−w)` of its even and odd part, so `E² + wO²`.
pub(crate) fn squared(p: &[f64]) -> Vec<f64> {
    let part = |first: usize| -> Vec<f64> {
        let signed = |(k, c): (usize, &f64)| if k % 2 == 0 { *c } else { -c };
        p.iter().skip(first).step_by(2).enumerate().map(signed).collect()
    };
    let (even, odd) = (part(0), part(1));
    let (real, imaginary) = (product(&even, &even), product(&odd, &odd));
    (0..p.len())
        .map(|k| at(&real, k) + k.checked_sub(1).map_or(0.0, |k| at(&imaginary, k)))
        .collect()
}

/// Roundings of a value relative to the sum of its terms' sizes.
const ROUNDING: f64 = 400.0 * f64::EPSILON;

/// Returns true if `p(w) ≥ 0` is shown for all `w ≥ 0`.
///
/// # Method
///
/// `w = w_0 t` up to 1 and `w = w_0/t` beyond. On `|t − c| ≤ h`, with `t_k` the coefficients around `c`,
/// `p ≥ min (t_0 + t_1 x + t_2 x²) − Σ_{k≥3} |t_k| h^k`; else the interval is halved.
pub(crate) fn not_negative(p: &[f64]) -> bool {
    if p.iter().any(|c| !c.is_finite()) {
        return false;
    }
    let Some(last) = p.iter().rposition(|c| c.abs() > 0.0) else { return true };
    let p = &p[..=last];
    if p.iter().all(|c| *c >= 0.0) {
        return true;
    }
    if p[0] < 0.0 || p[last] < 0.0 {
        return false;
    }
    let first = p.iter().position(|c| c.abs() > 0.0).unwrap_or(0);
    let centre = libm::pow(p[first].abs() / p[last], 1.0 / (last - first).max(1) as f64);
    let mut power = 1.0;
    let mut scaled: Vec<f64> = p
        .iter()
        .map(|c| {
            let term = c * power;
            power *= centre;
            term
        })
        .collect();
    let inner = not_negative_on_unit(&scaled);
    scaled.reverse();
    inner && not_negative_on_unit(&scaled)
}

fn not_negative_on_unit(p: &[f64]) -> bool {
    let mut cells = vec![(0.0, 1.0)];
    let mut seen = 0_u32;
    while let Some((from, to)) = cells.pop() {
        seen += 1;
        let half: f64 = 0.5 * (to - from);
        if above_zero(p, 0.5 * (from + to), half) {
            continue;
        }
        if half < 1e-13 || seen > 1_000_000 {
            return false;
        }
        let middle = 0.5 * (from + to);
        cells.extend([(middle, to), (from, middle)]);
    }
    true
}

/// Returns true if `p > 0`, beyond rounding, within `half` of `centre`; at 0 itself `p ≥ 0` is required of
/// its lowest terms.
fn above_zero(p: &[f64], centre: f64, half: f64) -> bool {
    // A cell that begins at 0, where the first coefficients vanish: what multiplies the lowest power counts.
    if centre <= half {
        let low = p.iter().position(|c| c.abs() > 0.0).unwrap_or(0);
        if low > 0 {
            return above_zero(&p[low..], centre, half);
        }
    }
    let size = p.iter().rev().fold(0.0, |sum, c| sum * (centre + half) + c.abs());
    let mut shifted = p.to_vec();
    for i in 0..shifted.len() {
        for k in (i..shifted.len() - 1).rev() {
            let next = shifted[k + 1];
            shifted[k] += centre * next;
        }
    }
    let (t0, t1, t2) = (at(&shifted, 0), at(&shifted, 1), at(&shifted, 2));
    let bottom = if t2 > 0.0 && t1.abs() < 2.0 * t2 * half {
        t0 - t1 * t1 / (4.0 * t2)
    } else {
        t0 - t1.abs() * half + t2 * half * half
    };
    let mut power = half * half;
    let mut rest = 0.0;
    for c in shifted.iter().skip(3) {
        power *= half;
        rest += c.abs() * power;
    }
    bottom - rest > ROUNDING * size
}
