//! Extent of a motion from samples: its box, and its largest speed, acceleration and jerk, joint by joint.

use crate::spline::{Spline, SplinePiece};

/// A largest value and its time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Extreme {
    /// The value, in the unit of what it is the largest of.
    pub value: f64,
    /// Time \[s\] at which it is reached; of a jerk the begin of its interval.
    pub at_s: f64,
}

impl Extreme {
    /// The larger of this and another value.
    fn or(&mut self, value: f64, at_s: f64) {
        if value > self.value || value.is_nan() {
            *self = Self { value, at_s };
        }
    }
}

/// Extent of one joint's motion.
#[derive(Debug, Clone, PartialEq)]
pub struct JointExtent {
    /// Lowest and highest position \[rad\] (m).
    pub low: Extreme,
    /// See `low`.
    pub high: Extreme,
    /// Largest `|q̇_d|` \[rad/s\].
    pub speed: Extreme,
    /// Largest `|q̈_d|` \[rad/s²\].
    pub acceleration: Extreme,
    /// Largest `|q⃛_d|` \[rad/s³\].
    pub jerk: Extreme,
    /// Larger of `|q̇_d|` at the first and at the last sample \[rad/s\]: before and after it the joint rests.
    pub end_speed: Extreme,
}

/// A motion through samples: a natural cubic spline per joint, as a study's reference of `kind = "csv"` is.
///
/// ```text
/// position, velocity, acceleration: continuous between the first sample and the last; jerk: constant between samples
/// ```
///
/// # Not claimed
///
/// Another interpolation of the same samples is another motion. Few digits of closely spaced samples are jerk: a step
/// of 1e-6 rad over 1 ms is 1000 rad/s³.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledMotion {
    splines: Vec<Spline>,
    end_s: f64,
}

impl SampledMotion {
    /// Through one row of positions \[rad\] per time \[s\]; times grow, and every row has the same joints.
    pub fn new(t: &[f64], q: &[Vec<f64>]) -> Self {
        let joints = q.first().map_or(0, Vec::len);
        let column = |j: usize| q.iter().filter_map(|row| row.get(j).copied()).collect::<Vec<_>>();
        let splines = (0..joints).map(|j| Spline::new(t, &column(j))).collect();
        Self { splines, end_s: t.last().copied().unwrap_or(0.0) }
    }

    /// Time of the last sample \[s\].
    pub fn end_s(&self) -> f64 {
        self.end_s
    }

    /// Position, velocity and acceleration of every joint at a time \[s\].
    pub fn at(&self, t: f64) -> [Vec<f64>; 3] {
        let jets = || self.splines.iter().map(|spline| spline.at(t));
        [0, 1, 2].map(|order| jets().map(|jet| jet[order]).collect())
    }

    /// Extent of every joint's motion: at the samples, and between them where a derivative is zero.
    pub fn extents(&self) -> Vec<JointExtent> {
        self.splines.iter().map(Spline::extent).collect()
    }
}

impl Spline {
    fn extent(&self) -> JointExtent {
        let (low, high) = (f64::INFINITY, f64::NEG_INFINITY);
        let at = |value| Extreme { value, at_s: 0.0 };
        let none = Extreme::default();
        let mut extent = JointExtent {
            low: at(low),
            high: at(high),
            speed: none,
            acceleration: none,
            jerk: none,
            end_speed: none,
        };
        // The lowest position is the highest of its opposite.
        let mut depth = Extreme { value: f64::NEG_INFINITY, at_s: 0.0 };
        for piece in self.pieces() {
            let [first, last] = [piece.from, piece.from + piece.length];
            let inside =
                piece.turns().into_iter().flatten().chain(piece.rests().into_iter().flatten());
            for t in [first, last].into_iter().chain(inside) {
                let [q, dq, ddq] = self.at(t);
                extent.high.or(q, t);
                depth.or(-q, t);
                extent.speed.or(dq.abs(), t);
                extent.acceleration.or(ddq.abs(), t);
            }
            extent.jerk.or(((piece.bend_after - piece.bend) / piece.length).abs(), first);
        }
        for t in self.ends() {
            extent.end_speed.or(self.at(t)[1].abs(), t);
        }
        extent.low = Extreme { value: -depth.value, at_s: depth.at_s };
        extent
    }
}

impl SplinePiece {
    /// Time inside at which the acceleration is zero.
    fn turns(&self) -> [Option<f64>; 1] {
        let opposite = self.bend * self.bend_after < 0.0;
        [opposite.then(|| self.from + self.length * self.bend / (self.bend - self.bend_after))]
    }

    /// Times inside at which the velocity is zero: `slope + bend s + ½ jerk s² = 0`.
    fn rests(&self) -> [Option<f64>; 2] {
        let half = 0.5 * (self.bend_after - self.bend) / self.length;
        let root = self.bend * self.bend - 4.0 * half * self.slope;
        if root < 0.0 {
            return [None, None];
        }
        // Without cancellation: the product of both roots is slope/half.
        let sum = -0.5 * (self.bend + self.bend.signum() * root.sqrt());
        let inside = |s: f64| (s > 0.0 && s < self.length).then_some(self.from + s);
        [inside(sum / half), inside(self.slope / sum)]
    }
}

#[cfg(test)]
mod tests {
    use super::SampledMotion;

    /// Samples at uneven times, with turns of position and velocity between them.
    fn motion() -> SampledMotion {
        let t: Vec<f64> = (0..40).map(|k| 0.1 * f64::from(k) + 0.02 * f64::from(k % 3)).collect();
        let row = |t: &f64| vec![(3.1 * t).sin() + 0.2 * (9.0 * t).cos(), -0.4 * (2.0 * t).cos()];
        SampledMotion::new(&t, &t.iter().map(row).collect::<Vec<_>>())
    }

    #[test]
    fn no_instant_is_beyond_an_extreme_and_each_is_reached() {
        let motion = motion();
        let extents = motion.extents();
        let steps = 400_000_u32;
        let h = motion.end_s() / f64::from(steps);
        let mut most = [[f64::NEG_INFINITY; 5]; 2];
        let mut before: Option<[Vec<f64>; 3]> = None;
        for k in 0..=steps {
            let now = motion.at(h * f64::from(k));
            for (i, most) in most.iter_mut().enumerate() {
                let jerk = before.as_ref().map_or(0.0, |old| ((now[2][i] - old[2][i]) / h).abs());
                let values = [now[0][i], -now[0][i], now[1][i].abs(), now[2][i].abs(), jerk];
                most.iter_mut().zip(values).for_each(|(most, value)| *most = most.max(value));
            }
            before = Some(now);
        }
        for (own, most) in extents.iter().zip(most) {
            let found = [own.high, own.low, own.speed, own.acceleration, own.jerk];
            for (k, (found, dense)) in found.into_iter().zip(most).enumerate() {
                let value = if k == 1 { -found.value } else { found.value };
                // Differences of accelerations have their rounding.
                let room = if k == 4 { 1e-8 * dense } else { 0.0 };
                assert!(value + room >= dense, "{k}: {value} {dense}");
                assert!(value - dense < 1e-4 * (1.0 + dense), "{k}: {value} {dense}");
            }
            let [_, there, _] = motion.at(own.speed.at_s);
            let off = there.iter().map(|dq| (dq.abs() - own.speed.value).abs()).fold(1.0, f64::min);
            assert!(off <= 0.0, "its time is that of the value");
        }
    }

    #[test]
    fn a_cubic_s_extremes_are_those_of_its_formula() {
        // Natural through (0, 0), (1, 1), (2, 0): y = 1.5 s − 0.5 s³ on the first piece, mirrored on the second.
        let motion = SampledMotion::new(&[0.0, 1.0, 2.0], &[vec![0.0], vec![1.0], vec![0.0]]);
        let own = &motion.extents()[0];
        let near = |a: f64, b: f64| (a - b).abs() < 1e-14;
        assert!(near(own.high.value, 1.0) && near(own.low.value, 0.0));
        assert!(near(own.speed.value, 1.5) && near(own.acceleration.value, 3.0));
        assert!(near(own.jerk.value, 3.0) && near(own.end_speed.value, 1.5));
        assert!(near(own.acceleration.at_s, 1.0), "{:?}", own.acceleration);
    }
}
