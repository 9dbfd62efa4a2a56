//! Decisions lane by lane: comparisons, and what follows from them.

use wide::f64x8;

use crate::Lanes;

/// A yes or no per lane.
///
/// # Example
///
/// ```
/// use phihat_model::{Lanes, Scalar};
///
/// let x = Lanes::from([-2.5, -0.5, 0.2, 0.5, 1.0, 2.5, 9.0, 1e17]);
/// let limit = Lanes::splat(2.0);
/// let limited = x.exceeds(limit).pick(limit, x);
/// assert_eq!(<[f64; 8]>::from(limited), [-2.5, -0.5, 0.2, 0.5, 1.0, 2.0, 2.0, 2.0]);
/// assert_eq!(<[f64; 8]>::from(x.round()), [-3.0, -1.0, 0.0, 1.0, 1.0, 3.0, 9.0, 1e17]);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct FileChoice(f64x8);

impl FileChoice {
    /// `yes` in the lanes that are chosen, `no` in the others.
    #[must_use]
    #[inline(always)]
    pub fn pick(self, yes: Lanes, no: Lanes) -> Lanes {
        Lanes(self.0.bitselect(yes.0, no.0))
    }

    /// Lanes that are chosen by one or the other.
    #[must_use]
    #[inline(always)]
    pub fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// 1 in the lanes that are chosen, 0 in the others.
    #[must_use]
    #[inline(always)]
    pub fn ones(self) -> Lanes {
        Lanes(self.0 & f64x8::splat(1.0))
    }

    /// Returns true if any lane is chosen.
    #[inline(always)]
    pub fn any(self) -> bool {
        self.0.any()
    }
}

impl From<[bool; Lanes::COUNT]> for FileChoice {
    fn from(chosen: [bool; Lanes::COUNT]) -> Self {
        let number = chosen.map(|chosen| if chosen { 1.0 } else { 0.0 });
        Lanes::from(number).exceeds(Lanes::default())
    }
}

impl Lanes {
    /// Lanes in which `self` is greater than `other`; a NaN is not.
    #[must_use]
    #[inline(always)]
    pub fn exceeds(self, other: Self) -> FileChoice {
        FileChoice(self.0.simd_gt(other.0))
    }

    /// The greater of both, lane by lane, of numbers that are none of them NaN.
    #[must_use]
    #[inline(always)]
    pub fn larger(self, other: Self) -> Self {
        self.with(other, f64x8::fast_max)
    }

    /// The nearest whole number, lane by lane; halves away from zero, as `f64::round`.
    #[must_use]
    #[inline(always)]
    pub fn round(self) -> Self {
        self.each(|x| {
            let sign = x & f64x8::splat(-0.0);
            let size = x.abs();
            let whole = size.floor();
            let up = (size - whole).simd_ge(f64x8::splat(0.5)) & f64x8::splat(1.0);
            (whole + up) | sign
        })
    }
}
