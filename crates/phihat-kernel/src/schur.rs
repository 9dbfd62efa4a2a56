//! Roots inside the unit circle, by Schur and Cohn.

use core::cmp::Ordering;

use num_bigint::BigInt;

use crate::Polynomial;

/// Returns true if every root of `p` lies inside the unit circle; `p` is not zero.
///
/// # Method
///
/// `p` of degree `n` has all roots inside exactly if `|p_0| < |p_n|` and `(p_n p − p_0 p*)/z`, of degree `n − 1`, has;
/// `p*` has the coefficients in reverse. A positive common factor changes nothing: coefficients are integers in a
/// common unit, and what divides all of them, known from two steps before, is taken out.
pub(crate) fn inside(p: &Polynomial) -> bool {
    let unit = p.coefficients().iter().filter_map(crate::Number::exponent).min().unwrap_or(0);
    let mut c: Vec<BigInt> = p.coefficients().iter().map(|c| c.in_units(unit)).collect();
    let mut divisor = BigInt::from(1);
    while let [low, .., high] = c.as_slice() {
        if low.magnitude().cmp(high.magnitude()) != Ordering::Less {
            return false;
        }
        let last = c.len() - 1;
        let mut next: Vec<BigInt> = (1..=last).map(|k| high * &c[k] - low * &c[last - k]).collect();
        if next.iter().all(|c| c % &divisor == BigInt::ZERO) {
            for c in &mut next {
                *c /= &divisor;
            }
        }
        // Of the leading coefficients only the first is not a factor.
        divisor = if c.len() == p.coefficients().len() { BigInt::from(1) } else { high.clone() };
        c = next;
    }
    !c.is_empty()
}
