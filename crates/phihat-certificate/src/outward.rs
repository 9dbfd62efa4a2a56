//! Numbers of a document, rounded so that a bound stays one.

/// Significant digits of a tube's numbers.
const DIGITS: i32 = 4;

/// Allowance for the difference between one implementation's rounding and another's.
const ROUNDING: f64 = 1.0 + 1e-6;

/// The next number of four significant digits that is not smaller, with a part in a million of room.
pub fn outward(x: f64) -> f64 {
    if x == 0.0 || !x.is_finite() {
        return x;
    }
    let wider = if x > 0.0 { x * ROUNDING } else { x / ROUNDING };
    #[allow(clippy::cast_possible_truncation, reason = "an exponent of ten")]
    let exponent = libm::log10(wider.abs()).floor() as i32 - (DIGITS - 1);
    // A power of ten that is a whole number is exact, and its quotient is the nearest number to the decimal.
    let (unit, inverse) = (10.0_f64.powi(exponent.abs()), exponent < 0);
    let scaled = if inverse { wider * unit } else { wider / unit };
    let up = scaled.ceil();
    if inverse { up / unit } else { up * unit }
}

#[cfg(test)]
mod tests {
    use super::outward;

    #[test]
    fn rounded_outward_to_four_digits() {
        for (x, wanted) in
            [(1.23401e-4, 1.235e-4), (-1.23499e-4, -1.234e-4), (0.0, 0.0), (12_345.6, 12_350.0)]
        {
            assert!((outward(x) - wanted).abs() <= 1e-12 * wanted.abs(), "{x}: {}", outward(x));
            assert!(outward(x) >= x);
        }
    }
}
