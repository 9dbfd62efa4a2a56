//! The payload as numbers that inverse dynamics is linear in.

use phihat_certificate::extremes::{Extremes as _, larger, smaller};
use phihat_model::Model;

use super::refusal::TubeRefusal;
use super::scene::{Scene, half};
use phihat_study::PayloadSet;

/// Offset of a centre of mass by which first moments are told apart \[m\].
const OFFSET: f64 = 0.1;

/// Distance from an axis at which a payload's mass is compared with its centre when a slice is divided \[m\]:
/// that of a wrist.
const LEVER: f64 = 0.2;

/// One parameter of the payload: what it adds is `(plus − minus) · scale` per unit.
pub(super) struct Direction {
    pub(super) plus: Model,
    pub(super) minus: Model,
    pub(super) scale: f64,
}

/// A slice of the payloads, in mass and in where its centre is, measured from its middle.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Slice {
    /// Smallest and largest mass \[kg\].
    pub(super) mass: (f64, f64),
    /// Middle of its box of centres of mass, from that of the whole \[m\].
    pub(super) off: [f64; 3],
    /// Half widths of its box \[m\].
    pub(super) half: [f64; 3],
    /// Half ranges of the inertia about the box's middle, `xx, xy, xz, yy, yz, zz` \[kg·m²\].
    pub(super) inertia: [f64; 6],
}

impl Slice {
    /// All payloads of a set.
    fn whole(set: &PayloadSet) -> Self {
        Self::new(set.mass, ([0.0; 3], half(set)), set.gyration)
    }

    fn new(mass: (f64, f64), (off, half): ([f64; 3], [f64; 3]), gyration: f64) -> Self {
        let second = |a: usize, b: usize| mass.1 * (half[a] * half[b] + gyration * gyration);
        let diagonal = |a: usize, b: usize| 0.5 * (second(a, a) + second(b, b));
        let inertia = [
            diagonal(1, 2),
            second(0, 1),
            second(0, 2),
            diagonal(0, 2),
            second(1, 2),
            diagonal(0, 1),
        ];
        Self { mass, off, half, inertia }
    }

    /// So many slices that are a set together, if it can be divided: halves of its mass, then halves of
    /// whatever leaves most unknown.
    pub(super) fn all(set: &PayloadSet, count: u32) -> Vec<Self> {
        let whole = Self::whole(set);
        let mut all =
            if count > 1 && set.mass.1 > set.mass.0 { whole.by_mass(set, 2) } else { vec![whole] };
        while all.len() < count as usize {
            let widest = |slice: &Self| slice.unknown().into_iter().largest();
            let most = (0..all.len()).max_by(|i, j| widest(&all[*i]).total_cmp(&widest(&all[*j])));
            let Some(most) = most.filter(|most| widest(&all[*most]) > 0.0) else { break };
            let slice = all.remove(most);
            all.extend(slice.halves(set));
        }
        all
    }

    /// Uncertainty of a momentum by the mass and by each coordinate of its centre, for a turn about an axis
    /// [`LEVER`] away.
    fn unknown(&self) -> [f64; 4] {
        let [x, y, z] = self.half.map(|half| 2.0 * half * self.mass.1);
        [0.5 * (self.mass.1 - self.mass.0) * LEVER, x, y, z]
    }

    /// Two slices in place of one.
    fn halves(&self, set: &PayloadSet) -> Vec<Self> {
        let unknown = self.unknown();
        let most = unknown.into_iter().largest();
        match (1..4).find(|i| unknown[*i] >= most) {
            Some(axis) => self.by_centre(set, axis - 1),
            None => self.by_mass(set, 2),
        }
    }

    /// Parts of equal mass.
    pub(super) fn by_mass(&self, set: &PayloadSet, count: u32) -> Vec<Self> {
        let (low, high) = self.mass;
        let width = (high - low) / f64::from(count);
        let end = |i: u32| if i == count { high } else { low + f64::from(i) * width };
        let part = |i: u32| Self::new((end(i), end(i + 1)), (self.off, self.half), set.gyration);
        (0..count).map(part).collect()
    }

    /// Its heaviest payloads, so much of the mass.
    pub(super) fn heaviest(&self, set: &PayloadSet, width: f64) -> Self {
        Self::new((self.mass.1 - width, self.mass.1), (self.off, self.half), set.gyration)
    }

    /// Both halves of a coordinate of the centre of mass.
    fn by_centre(&self, set: &PayloadSet, axis: usize) -> Vec<Self> {
        let part = |side: f64| {
            let (mut off, mut half) = (self.off, self.half);
            half[axis] *= 0.5;
            off[axis] += side * half[axis];
            Self::new(self.mass, (off, half), set.gyration)
        };
        vec![part(-1.0), part(1.0)]
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
        scene.loaded(mass, self.off, [xx, 0.0, 0.0, yy, 0.0, zz])
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
        self.along(&scene.bare, |mass, off, inertia| scene.loaded(mass, off, inertia))
    }

    /// The same of an arm, and of what it is with a mass, its centre from the middle of the box, and its
    /// inertia about that.
    fn along<E>(
        &self,
        bare: &Model,
        body: impl Fn(f64, [f64; 3], [f64; 6]) -> Result<Model, E>,
    ) -> Result<Vec<Option<Direction>>, E> {
        let still = self.off;
        let none = [0.0; 6];
        let mut all = Vec::with_capacity(10);
        all.push((self.mass.1 > self.mass.0).then_some(()).map(|()| {
            Ok(Direction { plus: body(1.0, still, none)?, minus: bare.clone(), scale: 1.0 })
        }));
        for axis in 0..3 {
            all.push((self.half[axis] > 0.0).then_some(()).map(|()| {
                let off = |sign: f64| {
                    let mut off = still;
                    // About the slice's middle, so that second moments are those of neither.
                    off[axis] += sign * OFFSET;
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

#[cfg(test)]
mod tests {
    use phihat_model::{Body, Model, Robot, Workspace};
    use phihat_session::Dice;
    use phihat_study::PayloadSet;

    use super::Slice;

    fn set(mass: (f64, f64), com: [(f64, f64); 3]) -> PayloadSet {
        PayloadSet { frame: "tool".to_owned(), mass, com, gyration: 0.02, place_stated: true }
    }

    /// Ends of a slice's box along an axis, for a set whose box has its middle there.
    fn range(slice: &Slice, middle: [f64; 3], axis: usize) -> (f64, f64) {
        let at = middle[axis] + slice.off[axis];
        (at - slice.half[axis], at + slice.half[axis])
    }

    fn torque(model: &Model, [q, dq, ddq]: &[Vec<f64>; 3]) -> Vec<f64> {
        let mut tau = vec![0.0; q.len()];
        model.inverse_dynamics(&mut Workspace::new(model), q, dq, ddq, &mut tau);
        tau
    }

    /// Inverse dynamics is linear in mass, first moments and inertia about the slice's middle: the directions
    /// of a payload describe all that it does, wherever its slice lies.
    #[test]
    fn directions_are_all_that_a_payload_does() {
        let bare = Robot::named("panda").unwrap().plant_model();
        let com = [(-0.02, 0.06), (0.01, 0.05), (0.0, 0.08)];
        let set = set((0.2, 1.4), com);
        let centre = com.map(|(a, b)| 0.5 * (a + b));
        let body = |mass: f64, off: [f64; 3], inertia: [f64; 6]| {
            let com = core::array::from_fn(|i| centre[i] + off[i]);
            bare.clone().with_payload_on("panda_link8", &Body { mass, com, inertia })
        };
        let mut dice = Dice::new(9, 0);
        for slice in Slice::all(&set, 9) {
            let directions = slice.along(&bare, body).unwrap();
            let [xx, _, _, yy, _, zz] = slice.inertia;
            let middle = body(slice.middle(), slice.off, [xx, 0.0, 0.0, yy, 0.0, zz]).unwrap();
            for _ in 0..5 {
                let state: [Vec<f64>; 3] =
                    core::array::from_fn(|_| (0..7).map(|_| dice.between(-1.5, 1.5)).collect());
                let mass = dice.between(slice.mass.0, slice.mass.1);
                let d = slice.half.map(|half| dice.between(-half, half));
                let own = [1e-3, 2e-4, -1e-4, 2e-3, 3e-4, 1.5e-3];
                let off = core::array::from_fn(|i| slice.off[i] + d[i]);
                let found = torque(&body(mass, off, own).unwrap(), &state);
                let far = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
                let about = |entry: usize, (a, b): (usize, usize)| {
                    own[entry] + mass * (if a == b { far } else { 0.0 } - d[a] * d[b])
                };
                let pairs = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
                let mut by = vec![mass - slice.middle()];
                by.extend(d.map(|d| mass * d));
                by.extend(pairs.into_iter().enumerate().map(|(entry, pair)| {
                    let known = if pair.0 == pair.1 { slice.inertia[entry] } else { 0.0 };
                    about(entry, pair) - known
                }));
                let mut sum = torque(&middle, &state);
                for (direction, by) in directions.iter().zip(by) {
                    let direction = direction.as_ref().unwrap();
                    let (plus, minus) =
                        (torque(&direction.plus, &state), torque(&direction.minus, &state));
                    for (sum, (plus, minus)) in sum.iter_mut().zip(plus.iter().zip(minus)) {
                        *sum += by * direction.scale * (plus - minus);
                    }
                }
                for (sum, found) in sum.iter().zip(&found) {
                    assert!((sum - found).abs() < 1e-10, "{slice:?}: {sum} for {found}");
                }
            }
        }
    }

    #[test]
    fn every_payload_is_in_a_slice_and_slices_share_no_more_than_sides() {
        let com = [(-0.02, 0.06), (0.01, 0.01), (0.0, 0.05)];
        let middle = com.map(|(a, b)| 0.5 * (a + b));
        for mass in [(0.0, 1.0), (0.3, 2.0), (1.5, 1.5)] {
            let set = set(mass, com);
            for count in 1..=14 {
                let all = Slice::all(&set, count);
                assert_eq!(all.len(), count as usize);
                let width = |(low, high): (f64, f64)| if high > low { high - low } else { 1.0 };
                let volume = |slice: &Slice| {
                    width(slice.mass)
                        * (0..3).map(|i| width(range(slice, middle, i))).product::<f64>()
                };
                let whole = width(mass) * com.into_iter().map(width).product::<f64>();
                let sum: f64 = all.iter().map(volume).sum();
                assert!((sum / whole - 1.0).abs() < 1e-12, "{count}: {sum} of {whole}");
                // On a grid, ends among it: the slices that hold a point.
                let point =
                    |(low, high): (f64, f64), k: u32| low + (high - low) * f64::from(k) / 6.0;
                for k in 0..7_u32.pow(3) {
                    let m = point(mass, k % 7);
                    let c = [point(com[0], k / 7 % 7), com[1].0, point(com[2], k / 49)];
                    let near =
                        |(low, high): (f64, f64), x: f64| x >= low - 1e-15 && x <= high + 1e-15;
                    let held = all.iter().filter(|slice| {
                        near(slice.mass, m) && (0..3).all(|i| near(range(slice, middle, i), c[i]))
                    });
                    assert!(held.count() > 0, "{count}: {m} kg at {c:?}");
                }
            }
        }
    }

    #[test]
    fn a_mass_is_halved_first_and_what_has_no_width_never() {
        let wide = set((0.0, 1.0), [(0.0, 0.0), (0.0, 0.0), (0.0, 0.5)]);
        let two = Slice::all(&wide, 2);
        assert_eq!([two[0].mass, two[1].mass], [(0.0, 0.5), (0.5, 1.0)]);
        assert!(two.iter().all(|slice| (slice.half[2] - 0.25).abs() < 1e-15));
        // Then the heavier half, across its wide box.
        let three = Slice::all(&wide, 3);
        assert!(
            three[1..].iter().all(|s| s.mass == (0.5, 1.0) && (s.half[2] - 0.125).abs() < 1e-15)
        );
        let known = set((1.0, 1.0), [(0.1, 0.1), (0.0, 0.0), (0.0, 0.0)]);
        assert_eq!(Slice::all(&known, 6).len(), 1);
        let heavier = set((0.0, 1.0), [(0.1, 0.1), (0.0, 0.0), (0.0, 0.0)]);
        assert!(Slice::all(&heavier, 4).iter().all(|s| (s.mass.1 - s.mass.0 - 0.25).abs() < 1e-15));
    }
}
