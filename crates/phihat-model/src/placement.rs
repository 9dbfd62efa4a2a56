//! Constant rotations and placements, as a description states them.

use crate::trig;

/// Row-major rotation or inertia.
pub(crate) type Matrix3 = [[f64; 3]; 3];

pub(crate) const IDENTITY: Matrix3 = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Residues of a rotation below this are rounding of an exact 0 or 1, not a stated angle.
pub(crate) const SNAP: f64 = 1e-14;

/// Pose of a child frame in its parent: `x_parent = r x_child + p`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Placement {
    pub(crate) r: Matrix3,
    pub(crate) p: [f64; 3],
}

impl Placement {
    pub(crate) const IDENTITY: Self = Self { r: IDENTITY, p: [0.0; 3] };

    /// First `self`, then `inner` within it.
    pub(crate) fn then(&self, inner: &Self) -> Self {
        Self { r: mul(&self.r, &inner.r), p: add(self.p, apply(&self.r, inner.p)) }
    }

    pub(crate) fn inverse(&self) -> Self {
        let r = transpose(&self.r);
        Self { r, p: apply(&r, self.p).map(|x| -x) }
    }

    /// Rotation by `angle` about z and shift by `shift` along z.
    pub(crate) fn screw_z(angle: f64, shift: f64) -> Self {
        Self { r: about([0.0, 0.0, 1.0], angle), p: [0.0, 0.0, shift] }
    }
}

pub(crate) fn mul(a: &Matrix3, b: &Matrix3) -> Matrix3 {
    core::array::from_fn(|i| core::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

pub(crate) fn transpose(a: &Matrix3) -> Matrix3 {
    core::array::from_fn(|i| core::array::from_fn(|j| a[j][i]))
}

pub(crate) fn apply(a: &Matrix3, v: [f64; 3]) -> [f64; 3] {
    core::array::from_fn(|i| dot(a[i], v))
}

pub(crate) fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    core::array::from_fn(|i| a[i] + b[i])
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Rotation by `angle` \[rad\] about the unit vector `axis` (Rodrigues).
pub(crate) fn about(axis: [f64; 3], angle: f64) -> Matrix3 {
    let (s, c) = trig::sin_cos(angle);
    let [x, y, z] = axis;
    let k = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    core::array::from_fn(|i| {
        core::array::from_fn(|j| {
            let along = axis[i] * axis[j];
            along + c * (IDENTITY[i][j] - along) + s * k[i][j]
        })
    })
}

/// URDF's roll, pitch, yaw \[rad\]: `Rz(yaw) Ry(pitch) Rx(roll)`.
pub(crate) fn from_rpy([roll, pitch, yaw]: [f64; 3]) -> Matrix3 {
    let z = about([0.0, 0.0, 1.0], yaw);
    let y = about([0.0, 1.0, 0.0], pitch);
    let x = about([1.0, 0.0, 0.0], roll);
    mul(&mul(&z, &y), &x)
}

/// The rotation whose z axis is the unit vector `axis`; a permutation if `axis` is a coordinate axis.
pub(crate) fn with_z_along(axis: [f64; 3]) -> Matrix3 {
    let smallest = (0..3).min_by(|&i, &j| axis[i].abs().total_cmp(&axis[j].abs())).unwrap_or(0);
    let y = normalised(cross(axis, IDENTITY[smallest])).unwrap_or([0.0, 1.0, 0.0]);
    transpose(&[cross(y, axis), y, axis])
}

/// `v / |v|`, or `None` where that has no meaning.
pub(crate) fn normalised(v: [f64; 3]) -> Option<[f64; 3]> {
    let [x, y, z] = v.map(f64::abs);
    let largest = x.max(y).max(z);
    if !(v.iter().all(|x| x.is_finite()) && largest > 0.0) {
        return None;
    }
    let v = v.map(|x| x / largest);
    let norm = dot(v, v).sqrt();
    Some(v.map(|x| x / norm))
}
