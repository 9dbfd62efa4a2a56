//! Truth of statements that carry a witness in the file, by a criterion without one.

use phihat_certificate::{Gains, JointRecord};
use serde_json::Value;

use super::rule::numbers;

/// Statement about a range of inertia through which an arm may move, law in continuous time.
const VARYING: &str = "stable while inertia varies, law in continuous time";

/// Returns true for a statement of a range through which inertia may vary where a quadratic Lyapunov function exists:
/// by the circle criterion, `Re(C_low(jω) C_high(jω)*) > 0` at every frequency, with `C_μ(s) = s^n + (k_n s^{n−1} + … +
/// k_1)/μ` stable at both ends. For two matrices that differ by one of rank one that is necessary, too.
///
/// Kalman (1963); Shorten and Narendra (2003), <https://doi.org/10.1109/TAC.2002.806665>.
pub(super) fn varies_stably(gains: &Gains, statement: &Value) -> bool {
    let text = |key: &str| statement[key].as_str().unwrap_or_default();
    let [low, high] = numbers(text("value"))[..] else { return false };
    let of = |joint: &&JointRecord| {
        statement["joint"].is_null() || statement["joint"] == joint.name.as_str()
    };
    text("what") == VARYING
        && gains.joints.iter().filter(of).all(|joint| circle(characteristic(joint), (low, high)))
}

/// `(s² + K_d s + K_p)(s^m + a_m s^{m−1} + … + a_1)`, ascending.
fn characteristic(joint: &JointRecord) -> Vec<f64> {
    let ladder: Vec<f64> = joint.a.iter().copied().chain([1.0]).collect();
    product(&ladder, &[joint.kp_per_s2, joint.kd_per_s, 1.0])
}

/// The criterion for `k_1, …, k_n, 1`.
fn circle(mut k: Vec<f64>, (low, high): (f64, f64)) -> bool {
    let n = k.len() - 1;
    // In units of its own mean rate.
    let rate = k[0].powf(1.0 / f64::from(u32::try_from(n).unwrap_or(u32::MAX)));
    let mut unit = 1.0;
    for at in (0..n).rev() {
        unit *= rate;
        k[at] /= unit;
    }
    let of = |mu: f64| -> Vec<f64> {
        k.iter().enumerate().map(|(i, k)| if i == n { 1.0 } else { k / mu }).collect()
    };
    let (low, high) = (of(low), of(high));
    let (even, odd) = (parts(&low), parts(&high));
    let real = sum(&product(&even.0, &odd.0), &shifted(&product(&even.1, &odd.1)));
    stable(&low) && stable(&high) && real[0] > 0.0 && positive_roots(&real).is_empty()
}

/// Real part of a polynomial at `jω` as one in `x = ω²`, and its imaginary part over `ω`.
fn parts(c: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let sign = |i: usize| if (i / 2).is_multiple_of(2) { 1.0 } else { -1.0 };
    let of = |first: usize| {
        c.iter().enumerate().skip(first).step_by(2).map(|(i, c)| sign(i) * c).collect()
    };
    (of(0), of(1))
}

fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; (a.len() + b.len()).saturating_sub(1)];
    for (i, a) in a.iter().enumerate() {
        for (j, b) in b.iter().enumerate() {
            out[i + j] += a * b;
        }
    }
    out
}

/// The polynomial times `x`.
fn shifted(a: &[f64]) -> Vec<f64> {
    std::iter::once(0.0).chain(a.iter().copied()).collect()
}

fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
    let at = |c: &[f64], i: usize| c.get(i).copied().unwrap_or(0.0);
    (0..a.len().max(b.len())).map(|i| at(a, i) + at(b, i)).collect()
}

fn value(c: &[f64], x: f64) -> f64 {
    c.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// Roots above 0 of odd multiplicity, and those of even multiplicity that rounding shows: between the roots of the
/// derivative a polynomial rises or falls, and one change of sign is found by halving.
fn positive_roots(c: &[f64]) -> Vec<f64> {
    let Some(degree) = c.iter().rposition(|c| *c != 0.0).filter(|degree| *degree > 0) else {
        return Vec::new();
    };
    let c = &c[..=degree];
    let slope: Vec<f64> = (1_u32..).zip(&c[1..]).map(|(i, c)| f64::from(i) * c).collect();
    // Cauchy's bound.
    let size = c.iter().map(|own| (own / c[degree]).abs()).fold(0.0, f64::max);
    let ends: Vec<f64> =
        std::iter::once(0.0).chain(positive_roots(&slope)).chain([1.0 + size]).collect();
    let crossing = |pair: &[f64]| {
        let (mut below, mut above) = (pair[0], pair[1]);
        let rises = value(c, above) > 0.0;
        if (value(c, below) > 0.0) == rises {
            return None;
        }
        for _ in 0..200 {
            let middle = 0.5 * (below + above);
            if (value(c, middle) > 0.0) == rises {
                above = middle;
            } else {
                below = middle;
            }
        }
        Some(above)
    };
    ends.windows(2).filter_map(crossing).collect()
}

/// Returns true if all roots have negative real parts, by Routh's scheme.
fn stable(c: &[f64]) -> bool {
    let (mut above, mut below): (Vec<f64>, Vec<f64>) = {
        let down: Vec<f64> = c.iter().rev().copied().collect();
        (
            down.iter().step_by(2).copied().collect(),
            down.iter().skip(1).step_by(2).copied().collect(),
        )
    };
    for _ in 1..c.len() {
        let (Some(first), Some(pivot)) = (above.first(), below.first()) else { return false };
        if !(*pivot > 0.0 && *first > 0.0) {
            return false;
        }
        let ratio = first / pivot;
        let next =
            (1..above.len()).map(|i| above[i] - ratio * below.get(i).copied().unwrap_or(0.0));
        let next = next.collect();
        above = std::mem::replace(&mut below, next);
        if below.is_empty() {
            return true;
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::{circle, positive_roots, stable};

    #[test]
    fn roots_are_those_of_the_factors() {
        // (x − 1)(x − 2)(x + 3) = x³ − 7 x + 6.
        let found = positive_roots(&[6.0, -7.0, 0.0, 1.0]);
        assert!(found.len() == 2 && (found[0] - 1.0).abs() < 1e-9 && (found[1] - 2.0).abs() < 1e-9);
        assert!(positive_roots(&[1.0, 0.0, 1.0]).is_empty());
    }

    #[test]
    fn the_circle_criterion_of_two_states_ends_where_its_closed_form_does() {
        // s² + (s + 1)/μ from μ = 1: x² − x + 1/high has no positive root for high < 4.
        let ends = |unit: f64, high: f64| circle(vec![unit * unit, unit, 1.0], (1.0, high));
        for unit in [1.0, 300.0] {
            assert!(ends(unit, 3.999) && !ends(unit, 4.001));
        }
        assert!(!ends(-1.0, 2.0) && !ends(1.0, f64::NAN));
    }

    #[test]
    fn a_polynomial_is_stable_on_one_side_of_its_edge() {
        // s³ + s² + s + k is stable for 0 < k < 1.
        assert!(stable(&[0.99, 1.0, 1.0, 1.0]) && !stable(&[1.01, 1.0, 1.0, 1.0]));
        assert!(!stable(&[-0.1, 1.0, 1.0, 1.0]));
        assert!(stable(&[2.0, 3.0, 1.0]) && !stable(&[2.0, -3.0, 1.0]));
    }
}
