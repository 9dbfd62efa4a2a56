//! Continuous joints: a reading that wraps becomes an angle that does not.

use core::f64::consts::{PI, TAU};

use crate::Real;

/// Undoes the wrap of one continuous joint's reading.
///
/// # Law
///
/// ```text
/// y_k = x_k + 2π n_k,    n_k = n_{k−1} ∓ 1 when x_k − x_{k−1} ≷ ±π
/// ```
///
/// The *reading* is unwrapped, at the boundary, never the error. The joint must turn less than half a turn
/// between samples. For revolute joints that do not turn endlessly a jump of 2π is a fault: do not unwrap.
///
/// ```
/// use phihat::Unwrap;
/// let mut angle = Unwrap::<f64>::new();
/// assert_eq!(angle.take(3.1), 3.1);
/// assert!((angle.take(-3.1) - 3.183_185_307).abs() < 1e-9); // forward through π
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Unwrap<R> {
    last: Option<R>,
    turns: i32,
}

impl<R: Real> Unwrap<R> {
    /// An angle before its first reading, which is taken as it is.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes a reading, gives the angle. A reading that is not finite, or beyond two turns and so not one that
    /// wraps, comes back as it is and is forgotten.
    pub fn take(&mut self, reading: R) -> R {
        let within = reading.abs() <= R::from_f64(2.0 * TAU);
        if !within {
            return reading;
        }
        let half = R::from_f64(PI);
        if let Some(last) = self.last {
            let change = reading - last;
            if change > half {
                self.turns = self.turns.saturating_sub(1);
            } else if change < -half {
                self.turns = self.turns.saturating_add(1);
            }
        }
        self.last = Some(reading);
        reading + R::from_f64(TAU * f64::from(self.turns))
    }
}
