//! Dyadic rationals: every finite double is one, and sums and products of them are.

use core::cmp::Ordering;
use core::ops::{Add, Mul, Neg, Sub};

use num_bigint::{BigInt, Sign};

/// Exact number `mantissa · 2^exponent`.
///
/// The mantissa is odd, or the number is zero with exponent 0: equal numbers are equal in both parts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Number {
    mantissa: BigInt,
    exponent: i64,
}

impl Number {
    /// The number zero.
    pub fn zero() -> Self {
        Self { mantissa: BigInt::ZERO, exponent: 0 }
    }

    /// `mantissa · 2^exponent`.
    pub fn new(mantissa: BigInt, exponent: i64) -> Self {
        match mantissa.trailing_zeros() {
            None => Self::zero(),
            Some(0) => Self { mantissa, exponent },
            Some(even) => Self {
                mantissa: mantissa >> even,
                exponent: exponent + i64::try_from(even).unwrap_or(i64::MAX),
            },
        }
    }

    /// The rational that a double is; `None`: infinite or no number.
    pub fn of(value: f64) -> Option<Self> {
        if !value.is_finite() {
            return None;
        }
        let bits = value.to_bits();
        let field = bits >> 52 & 0x7ff;
        let fraction = bits & ((1 << 52) - 1);
        // Below the normal range the leading bit is not implied.
        let whole = if field == 0 { fraction } else { fraction | 1 << 52 };
        let sign = if value.is_sign_negative() { Sign::Minus } else { Sign::Plus };
        let exponent = i64::try_from(field.max(1)).unwrap_or(0) - 1075;
        Some(Self::new(BigInt::from_biguint(sign, whole.into()), exponent))
    }

    /// The nearest double, within two units in the last place: to print, never to prove.
    pub fn near(&self) -> f64 {
        let bits = i64::try_from(self.mantissa.bits()).unwrap_or(i64::MAX);
        let drop = (bits - 62).max(0);
        let short = &self.mantissa >> drop;
        let value = i64::try_from(short).map_or(f64::NAN, |short| short as f64);
        // In two steps: neither a power of two overflows alone, nor is a small result lost early.
        let power = (self.exponent + drop).clamp(-2200, 2200);
        let half = i32::try_from(power / 2).unwrap_or(0);
        let rest = i32::try_from(power - power / 2).unwrap_or(0);
        value * 2.0_f64.powi(half) * 2.0_f64.powi(rest)
    }

    /// `self · 2^power`.
    #[must_use]
    pub fn shifted(&self, power: i64) -> Self {
        Self::new(self.mantissa.clone(), self.exponent + power)
    }

    /// Returns true for a number above zero.
    pub fn is_positive(&self) -> bool {
        self.mantissa.sign() == Sign::Plus
    }

    /// Returns true for zero.
    pub fn is_zero(&self) -> bool {
        self.mantissa.sign() == Sign::NoSign
    }

    /// `|self|`.
    #[must_use]
    pub fn size(&self) -> Self {
        if self.mantissa.sign() == Sign::Minus { -self } else { self.clone() }
    }

    /// The largest integer that is not above it.
    pub(crate) fn floor(&self) -> BigInt {
        if self.exponent >= 0 { self.in_units(0) } else { &self.mantissa >> -self.exponent }
    }

    /// The exponent of two in it; `None`: zero.
    pub(crate) fn exponent(&self) -> Option<i64> {
        (!self.is_zero()).then_some(self.exponent)
    }

    /// `self · 2^{−exponent}`, an integer where `exponent` is not above its own.
    pub(crate) fn in_units(&self, exponent: i64) -> BigInt {
        if self.is_zero() { BigInt::ZERO } else { &self.mantissa << (self.exponent - exponent) }
    }
}

impl From<i64> for Number {
    fn from(value: i64) -> Self {
        Self::new(value.into(), 0)
    }
}

impl Add for &Number {
    type Output = Number;

    fn add(self, other: Self) -> Number {
        if self.is_zero() {
            return other.clone();
        }
        if other.is_zero() {
            return self.clone();
        }
        let unit = self.exponent.min(other.exponent);
        Number::new(self.in_units(unit) + other.in_units(unit), unit)
    }
}

impl Sub for &Number {
    type Output = Number;

    fn sub(self, other: Self) -> Number {
        self + &-other
    }
}

impl Mul for &Number {
    type Output = Number;

    fn mul(self, other: Self) -> Number {
        Number::new(&self.mantissa * &other.mantissa, self.exponent + other.exponent)
    }
}

impl Neg for &Number {
    type Output = Number;

    fn neg(self) -> Number {
        Number { mantissa: -&self.mantissa, exponent: self.exponent }
    }
}

impl PartialOrd for Number {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Number {
    fn cmp(&self, other: &Self) -> Ordering {
        (self - other).mantissa.sign().cmp(&Sign::NoSign)
    }
}
