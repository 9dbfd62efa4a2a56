//! From the arm's world onto paper.

use super::DrawnArm;
use super::kinematics::norm;

/// Size of a picture \[px\].
pub(super) const WIDTH: f64 = 860.0;
pub(super) const HEIGHT: f64 = 520.0;

/// Elevation of the camera, and its angle to the side of the arm's work \[rad\].
const ELEVATION: f64 = 0.32;
const ASIDE: f64 = 1.05;

/// A camera that looks at an arm.
#[derive(Debug)]
pub(super) struct Camera {
    from: [f64; 3],
    right: [f64; 3],
    up: [f64; 3],
    back: [f64; 3],
    /// Pixels of a unit at a unit's distance.
    focal: f64,
}

impl Camera {
    /// One that looks from the side at what the tip does, and sees all that the arm ever fills.
    pub(super) fn of(arm: &DrawnArm, path: &[[f64; 3]], all: &[[f64; 3]]) -> Self {
        let count = path.len().max(1) as f64;
        let middle: [f64; 3] =
            core::array::from_fn(|i| path.iter().map(|p| p[i]).sum::<f64>() / count);
        let end = |i: usize, pick: fn(f64, f64) -> f64| {
            all.iter().map(|p| p[i]).reduce(pick).unwrap_or(0.0)
        };
        let least: [f64; 3] = core::array::from_fn(|i| end(i, f64::min));
        let largest: [f64; 3] = core::array::from_fn(|i| end(i, f64::max));
        let half: [f64; 3] = core::array::from_fn(|i| 0.5 * (largest[i] - least[i]));
        let radius = norm(half) + 0.06 * arm.reach();
        let mut target: [f64; 3] = core::array::from_fn(|i| least[i] + half[i]);
        target[2] -= 0.1 * radius;
        let azimuth = libm::atan2(middle[1], middle[0]) - ASIDE;
        let (sa, ca) = libm::sincos(azimuth);
        let (se, ce) = libm::sincos(ELEVATION);
        let back = [ce * ca, ce * sa, se];
        let from = core::array::from_fn(|i| target[i] + 3.9 * radius * back[i]);
        Self {
            from,
            right: [-sa, ca, 0.0],
            up: [-se * ca, -se * sa, ce],
            back,
            focal: 1.9 * HEIGHT,
        }
    }

    /// Position of a point on paper \[px\], and its depth \[m\].
    pub(super) fn see(&self, p: [f64; 3]) -> ([f64; 2], f64) {
        let d: [f64; 3] = core::array::from_fn(|i| p[i] - self.from[i]);
        let along = |axis: [f64; 3]| axis.iter().zip(d).map(|(a, d)| a * d).sum::<f64>();
        let far = (-along(self.back)).max(1e-3 * norm(d)).max(1e-9);
        let (x, y) = (self.focal * along(self.right) / far, self.focal * along(self.up) / far);
        ([0.5 * WIDTH + x, 0.5 * HEIGHT - y], far)
    }

    /// Size of a length at a depth \[px\].
    pub(super) fn size(&self, length: f64, far: f64) -> f64 {
        self.focal * length / far
    }
}
