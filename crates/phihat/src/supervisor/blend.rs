//! From one reference to another, and from one torque to another, without a jolt.

use crate::{Real, Reference};

/// A difference of references that fades to zero.
///
/// # Law
///
/// The quintic `x(s)`, `s = t/t_b`, that starts with a given position, velocity and acceleration and ends
/// at zero with all three zero: the sum with any smooth reference is twice continuously differentiable.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Blend<R> {
    /// `x = Σ c_i s^i`.
    coefficients: [R; 6],
}

impl<R: Real> Blend<R> {
    /// From `now` to `target` over `length` \[s\].
    pub(crate) fn new(now: &Reference<R>, target: &Reference<R>, length: R) -> Self {
        let n = |x: f64| R::from_f64(x);
        let c0 = now.q - target.q;
        let c1 = (now.dq - target.dq) * length;
        let c2 = (now.ddq - target.ddq) * length * length * n(0.5);
        let c3 = -(n(10.0) * c0 + n(6.0) * c1 + n(3.0) * c2);
        let c4 = n(15.0) * c0 + n(8.0) * c1 + n(3.0) * c2;
        let c5 = -(n(6.0) * c0 + n(3.0) * c1 + c2);
        Self { coefficients: [c0, c1, c2, c3, c4, c5] }
    }

    /// `target` plus what is left at `s` in \[0, 1\].
    pub(crate) fn at(&self, s: R, length: R, target: &Reference<R>) -> Reference<R> {
        let [c0, c1, c2, c3, c4, c5] = self.coefficients;
        let n = |x: f64| R::from_f64(x);
        let x = c0 + s * (c1 + s * (c2 + s * (c3 + s * (c4 + s * c5))));
        let dx = c1 + s * (n(2.0) * c2 + s * (n(3.0) * c3 + s * (n(4.0) * c4 + s * n(5.0) * c5)));
        let ddx = n(2.0) * c2 + s * (n(6.0) * c3 + s * (n(12.0) * c4 + s * n(20.0) * c5));
        Reference {
            q: target.q + x,
            dq: target.dq + dx / length,
            ddq: target.ddq + ddx / (length * length),
        }
    }
}

/// Share left at `s` in \[0, 1\] of a torque that fades: 1 at 0, 0 at 1, flat at both ends.
pub(crate) fn fade<R: Real>(s: R) -> R {
    let left = R::from_f64(1.0) - s;
    left * left * (R::from_f64(1.0) + R::from_f64(2.0) * s)
}
