//! The multiplier `y = 2 Σ h_j sin jθ`, over cells: a line in `t` and how far it is off at most.

use num_bigint::BigInt;

use crate::Number;

/// Bits after the point in the recursion of [`Multiplier::at`].
const BITS: i64 = 192;

/// `U(t) = y/sin θ = 2 Σ h_j U_{j−1}(1 − 2t)`, `U_k` Chebyshev's polynomial of the second kind.
pub(crate) struct Multiplier<'a> {
    taps: &'a [Number],
}

/// `U` over a cell: within `off` of the line from `ends[0]` to `ends[1]`.
pub(crate) struct Line {
    pub(crate) ends: [Number; 2],
    pub(crate) off: Number,
}

impl<'a> Multiplier<'a> {
    pub(crate) fn new(taps: &'a [Number]) -> Self {
        Self { taps }
    }

    /// `U` over `[from, to]`.
    ///
    /// # Method
    ///
    /// A function is within `max|U''| (to − from)²/8` of its chord, and in `t` `U_{j−1}''` is 4 times that in `x = cos
    /// θ`.
    /// `|U_{j−1}| ≤ u = min(j, 1/s)`, `|U_{j−1}'| ≤ u' = min(j³/2, (j + u)/s²)` by `(1 − x²)U' = xU − j cos jθ`, and
    /// `|U_{j−1}''| ≤ min(j⁵/8, (3u' + j²u)/s²)` by `(1 − x²)U'' = 3xU' − (j² − 1)U`, where `s ≤ sin θ` on the cell.
    pub(crate) fn over(&self, from: &Number, to: &Number) -> Line {
        let width = to - from;
        let sine = least_sine(from, to);
        let mut bend = Number::zero();
        for (j, h) in (1..).zip(self.taps) {
            bend = &bend + &(&h.size() * &steepest(&Number::from(j), sine));
        }
        let off = &(&bend * &(&width * &width)) + &self.rounding();
        Line { ends: [self.at(from), self.at(to)], off }
    }

    /// `U(t)`, within [`Self::rounding`].
    fn at(&self, t: &Number) -> Number {
        // U_{k+1} = 2x U_k − U_{k−1} in units of 2^−BITS, rounded down.
        let twice = (&Number::from(1) - &t.shifted(1)).shifted(1);
        let (mut before, mut own) = (BigInt::ZERO, BigInt::from(1) << BITS);
        let mut sum = Number::zero();
        for h in self.taps {
            sum = &sum + &(h * &Number::new(own.clone(), 1 - BITS));
            let next = (&twice * &Number::new(own.clone(), 0)).floor() - &before;
            before = core::mem::replace(&mut own, next);
        }
        sum
    }

    /// Largest error of [`Self::at`]: a unit lost at step `k` comes back in `U_{j−1}` at most `j − k` times.
    fn rounding(&self) -> Number {
        let mut sum = Number::zero();
        for (j, h) in (1..).zip(self.taps) {
            sum = &sum + &(&h.size() * &Number::from(j * j).shifted(1 - BITS));
        }
        sum
    }
}

/// The largest `2^{−e}`, `e ≥ 0`, with `2^{−2e} ≤ sin²θ` on a cell, as `e`; `None`: the cell reaches `θ = 0` or `π`.
fn least_sine(from: &Number, to: &Number) -> Option<i64> {
    let square = |t: &Number| (t * &(&Number::from(1) - t)).shifted(2);
    let least = square(from).min(square(to));
    least.is_positive().then_some(())?;
    (0..200).find(|e| Number::from(1).shifted(-2 * e) <= least)
}

/// Bound of `|U_{j−1}''|` in `x`, where `sin θ ≥ 2^{−e}`.
fn steepest(j: &Number, sine: Option<i64>) -> Number {
    let square = j * j;
    let cube = &square * j;
    let anywhere = (&cube * &square).shifted(-3);
    let Some(e) = sine else { return anywhere };
    let size = j.clone().min(Number::from(1).shifted(e));
    let slope = cube.shifted(-1).min((j + &size).shifted(2 * e));
    anywhere.min((&(&slope * &Number::from(3)) + &(&square * &size)).shifted(2 * e))
}

#[cfg(test)]
mod tests {
    use super::Multiplier;
    use crate::Number;

    #[test]
    fn a_cell_s_line_is_as_far_off_as_it_says_at_most() {
        let taps = [0.7, 0.0, -0.3, 1.1, 0.0, 0.0, 0.2].map(Number::of).map(Option::unwrap);
        let u = |t: f64| {
            let theta = 2.0 * t.sqrt().asin();
            let y: f64 = (1_u8..)
                .zip(&taps)
                .map(|(j, h)| 2.0 * h.near() * (f64::from(j) * theta).sin())
                .sum();
            y / theta.sin()
        };
        for depth in [1, 3, 6, 9] {
            let width = 0.5_f64.powi(depth);
            for k in 0..1_u16 << depth {
                let from = f64::from(k) * width;
                let number = |t: f64| Number::of(t).unwrap();
                let line = Multiplier::new(&taps).over(&number(from), &number(from + width));
                let [a, b] = line.ends.map(|end| end.near());
                let (mut worst, off) = (0.0_f64, line.off.near());
                for i in 1..16_u8 {
                    let share = f64::from(i) / 16.0;
                    worst = worst.max((u(from + share * width) - a - share * (b - a)).abs());
                }
                assert!(worst <= off + 1e-12, "{worst} {off} {from} {width}");
                // And no absurd bound where the cell is narrow.
                assert!(depth < 9 || off < 0.02, "{off} {from}");
            }
        }
    }
}
