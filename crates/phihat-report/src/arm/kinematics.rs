//! Poses of the links.

use super::DrawnArm;

type Rotation = [[f64; 3]; 3];

/// Pose of a link in base axes: `x_base = r x_link + p`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LinkPose {
    pub p: [f64; 3],
    pub r: Rotation,
}

impl DrawnArm {
    /// The origin of every link \[m\], base axes, at a position \[rad, m\].
    #[must_use]
    pub fn origins(&self, q: &[f64]) -> Vec<[f64; 3]> {
        self.places(q).iter().map(|place| place.p).collect()
    }

    /// The pose of every link; a joint without a finite position is at 0.
    pub(crate) fn places(&self, q: &[f64]) -> Vec<LinkPose> {
        let mut places: Vec<LinkPose> = Vec::with_capacity(self.links.len());
        for link in &self.links {
            let at = link.joint.and_then(|joint| q.get(joint)).copied();
            let at = at.filter(|q| q.is_finite()).unwrap_or(0.0);
            let (mut p, mut r) = (link.p, link.r);
            if link.slides {
                p = add(p, apply(&r, link.axis.map(|x| at * x)));
            } else if link.joint.is_some() {
                r = mul(&r, &about(link.axis, at));
            }
            if let Some(parent) = link.parent.and_then(|parent| places.get(parent)) {
                p = add(parent.p, apply(&parent.r, p));
                r = mul(&parent.r, &r);
            }
            places.push(LinkPose { p, r });
        }
        places
    }

    /// Reach of the arm from its base \[m\]: the largest sum of link offsets, 1 where that is zero.
    pub(crate) fn reach(&self) -> f64 {
        let mut reach: Vec<f64> = Vec::with_capacity(self.links.len());
        for link in &self.links {
            let before = link.parent.and_then(|parent| reach.get(parent)).copied().unwrap_or(0.0);
            reach.push(before + norm(link.p));
        }
        let most = reach.iter().copied().filter(|far| far.is_finite()).fold(0.0, f64::max);
        if most > 0.0 { most } else { 1.0 }
    }

    /// Radius of every link \[m\]: from its mass at the density of a robot's links, within 0.02 to 0.045 of
    /// the reach.
    pub(crate) fn thickness(&self) -> Vec<f64> {
        let reach = self.reach();
        let length = |i| -> f64 {
            let own = self.links.iter().filter(|link| link.parent == Some(i));
            own.map(|link| norm(link.p)).sum()
        };
        let radius = |(i, link): (usize, &super::ArmLink)| {
            let volume = link.mass.max(0.05) / DENSITY;
            let radius = (volume / (core::f64::consts::PI * length(i).max(0.12 * reach))).sqrt();
            radius.clamp(0.02 * reach, 0.045 * reach)
        };
        self.links.iter().enumerate().map(radius).collect()
    }
}

/// Of a robot's link \[kg/m³\].
const DENSITY: f64 = 2000.0;

pub(crate) fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

pub(crate) fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    core::array::from_fn(|i| a[i] + b[i])
}

pub(crate) fn apply(a: &Rotation, v: [f64; 3]) -> [f64; 3] {
    core::array::from_fn(|i| (0..3).map(|k| a[i][k] * v[k]).sum())
}

fn mul(a: &Rotation, b: &Rotation) -> Rotation {
    core::array::from_fn(|i| core::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

/// Rotation by `angle` about a unit vector.
fn about([x, y, z]: [f64; 3], angle: f64) -> Rotation {
    let (s, c) = libm::sincos(angle);
    let (axis, k) = ([x, y, z], [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]);
    core::array::from_fn(|i| {
        core::array::from_fn(|j| {
            let one = if i == j { 1.0 } else { 0.0 };
            c * one + (1.0 - c) * axis[i] * axis[j] + s * k[i][j]
        })
    })
}
