//! The payload as numbers that inverse dynamics is linear in.

use phihat_certificate::extremes::{larger, smaller};
use phihat_model::Model;

use super::refusal::TubeRefusal;
use super::scene::{Scene, half};
use phihat_study::PayloadSet;

/// Offset of a centre of mass by which first moments are told apart \[m\].
const OFFSET: f64 = 0.1;

/// One parameter of the payload: what it adds is `(plus − minus) · scale` per unit.
pub(super) struct Direction {
    pub(super) plus: Model,
    pub(super) minus: Model,
    pub(super) scale: f64,
}

/// A slice of the payload's masses, measured from its middle.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Slice {
    /// Smallest and largest mass \[kg\].
    pub(super) mass: (f64, f64),
    /// Half widths of the centre of mass's box \[m\].
    pub(super) half: [f64; 3],
    /// Half ranges of the inertia about the box's middle, `xx, xy, xz, yy, yz, zz` \[kg·m²\].
    pub(super) inertia: [f64; 6],
}

impl Slice {
    /// Slices of a part of a set's masses, `count` of them.
    pub(super) fn of(set: &PayloadSet, (low, high): (f64, f64), count: u32) -> Vec<Self> {
        let width = (high - low) / f64::from(count);
        let half = half(set);
        let slice = |i: u32| {
            let mass = (low + f64::from(i) * width, low + f64::from(i + 1) * width);
            let second =
                |a: usize, b: usize| mass.1 * (half[a] * half[b] + set.gyration * set.gyration);
            let diagonal = |a: usize, b: usize| 0.5 * (second(a, a) + second(b, b));
            let inertia = [
                diagonal(1, 2),
                second(0, 1),
                second(0, 2),
                diagonal(0, 2),
                second(1, 2),
                diagonal(0, 1),
            ];
            Self { mass, half, inertia }
        };
        (0..count).map(slice).collect()
    }

    fn middle(&self) -> f64 {
        0.5 * (self.mass.0 + self.mass.1)
    }

    /// The model with the middle of the slice.
    pub(super) fn model(&self, scene: &Scene<'_>) -> Result<Model, TubeRefusal> {
        self.with(scene, self.middle())
    }

    /// The model with some mass of the slice, all else in the middle.
    fn with(&self, scene: &Scene<'_>, mass: f64) -> Result<Model, TubeRefusal> {
        let [xx, _, _, yy, _, zz] = self.inertia;
        scene.loaded(mass, [0.0; 3], [xx, 0.0, 0.0, yy, 0.0, zz])
    }

    /// The models with the smallest and the largest mass of the slice.
    pub(super) fn ends(&self, scene: &Scene<'_>) -> Result<Vec<Model>, TubeRefusal> {
        Ok(vec![self.with(scene, self.mass.0)?, self.with(scene, self.mass.1)?])
    }

    /// The ten parameters in their order: mass, first moments, inertia. `None` where it does not vary.
    pub(super) fn directions(
        &self,
        scene: &Scene<'_>,
    ) -> Result<Vec<Option<Direction>>, TubeRefusal> {
        let body = |mass: f64, off: [f64; 3], inertia: [f64; 6]| scene.loaded(mass, off, inertia);
        let still = [0.0; 3];
        let none = [0.0; 6];
        let mut all = Vec::with_capacity(10);
        all.push((self.mass.1 > self.mass.0).then_some(()).map(|()| {
            Ok(Direction { plus: body(1.0, still, none)?, minus: scene.bare.clone(), scale: 1.0 })
        }));
        for axis in 0..3 {
            all.push((self.half[axis] > 0.0).then_some(()).map(|()| {
                let off = |sign: f64| {
                    let mut off = still;
                    off[axis] = sign * OFFSET;
                    body(1.0, off, none)
                };
                Ok(Direction { plus: off(1.0)?, minus: off(-1.0)?, scale: 0.5 / OFFSET })
            }));
        }
        for entry in 0..6 {
            all.push((self.inertia[entry] > 0.0).then_some(()).map(|()| {
                let with = |sign: f64| {
                    let mut inertia = [1.0, 0.0, 0.0, 1.0, 0.0, 1.0];
                    inertia[entry] += 0.5 * sign;
                    body(1.0, still, inertia)
                };
                Ok(Direction { plus: with(1.0)?, minus: with(-1.0)?, scale: 1.0 })
            }));
        }
        all.into_iter().map(Option::transpose).collect()
    }

    /// Least and largest of a quantity that is linear in the parameters, from its value per unit of each.
    pub(super) fn hull(&self, unit: &[f64; 10]) -> (f64, f64) {
        let box_ = |m: f64| (0..3).map(|i| m * self.half[i] * unit[1 + i].abs()).sum::<f64>();
        let of = |m: f64| (m - self.middle()) * unit[0];
        let (a, b) = (self.mass.0, self.mass.1);
        let rest: f64 = (0..6).map(|i| self.inertia[i] * unit[4 + i].abs()).sum();
        let low = smaller(of(a) - box_(a), of(b) - box_(b)) - rest;
        let high = larger(of(a) + box_(a), of(b) + box_(b)) + rest;
        (low, high)
    }

    /// Largest size of the same.
    pub(super) fn size(&self, unit: &[f64; 10]) -> f64 {
        let (low, high) = self.hull(unit);
        larger(high, -low)
    }

    /// `|ΔI|` of the payload's spatial inertia about the box's middle, entry by entry, linear before angular.
    pub(super) fn spatial(&self) -> [[f64; 6]; 6] {
        let mut out = [[0.0; 6]; 6];
        let spread = 0.5 * (self.mass.1 - self.mass.0);
        let h = self.half.map(|half| half * self.mass.1);
        let skew = [[0.0, h[2], h[1]], [h[2], 0.0, h[0]], [h[1], h[0], 0.0]];
        let [xx, xy, xz, yy, yz, zz] = self.inertia;
        let angular = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
        for i in 0..3 {
            out[i][i] = spread;
            for j in 0..3 {
                out[i][3 + j] = skew[i][j];
                out[3 + i][j] = skew[i][j];
                out[3 + i][3 + j] = angular[i][j];
            }
        }
        out
    }
}
