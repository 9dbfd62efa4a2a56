//! A joint's loop in frequency, in doubles: the kernel's polynomials at points of the circle, for figures.

use phihat_kernel::{JointLoop, Polynomial};

use super::complex::Complex;

/// `N`, `Δ` and `R` of a [`JointLoop`] in `w = z − 1`, rounded coefficient by coefficient: nothing is lost near
/// `w = 0`.
pub(crate) struct CheckedResponse {
    back: Vec<f64>,
    open: Vec<f64>,
    reading: Vec<f64>,
}

impl CheckedResponse {
    pub(crate) fn of(joint: &JointLoop) -> Self {
        let rounded = |p: &Polynomial| {
            p.about_one().coefficients().iter().map(phihat_kernel::Number::near).collect()
        };
        let [back, open, reading] = [&joint.back, &joint.open, &joint.reading].map(rounded);
        Self { back, open, reading }
    }

    /// `−L`.
    pub(crate) fn crossing(&self, w: Complex) -> Complex {
        (-horner(&self.back, w)).over(horner(&self.open, w))
    }

    /// Torque commanded per misreading, at an inertia ratio: its size \[N·m/rad\].
    pub(crate) fn reading_to_torque(&self, w: Complex, mu: f64) -> f64 {
        let closed = horner(&self.open, w) + horner(&self.back, w).times(1.0 / mu);
        horner(&self.reading, w).over(closed).size()
    }
}

/// `e^{jθ} − 1`, without cancellation near `θ = 0`.
pub(crate) fn on_circle(theta: f64) -> Complex {
    let half = libm::sin(0.5 * theta);
    Complex::new(-2.0 * half * half, libm::sin(theta))
}

fn horner(p: &[f64], x: Complex) -> Complex {
    p.iter().rev().fold(Complex::new(0.0, 0.0), |sum, c| sum * x + Complex::new(*c, 0.0))
}
