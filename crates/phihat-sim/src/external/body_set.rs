//! The bodies that every torque so far allows: a parallelotope around them, cut by one inequality at a time.

use phihat_study::PayloadSet;

/// Mass and first moments: what of a body is bounded. Its second moments are taken as an interval.
pub(super) const PARAMETERS: usize = 4;

/// Coefficients of a linear function of mass \[kg\] and first moments \[kg·m\].
pub(super) type BodyRow = [f64; PARAMETERS];

/// Least width of a strip: what is known exactly still has a volume.
const LEAST_WIDTH: f64 = 1e-9;

/// Margin of every bound for rounding, relative to its strip's width and size.
const ROUNDING: f64 = 1e-9;

/// Share by which a strip has to lessen the volume to take another's place.
const GAIN: f64 = 1e-3;

/// A set of bodies, `{p : low ≤ A p ≤ high}` within a box.
///
/// # Method
///
/// A new strip `l ≤ a·p ≤ h` is met with the four of the set; each of the five is then as narrow as the other four
/// allow, and the four with the least volume stay:
///
/// ```text
/// V = Π (high_i − low_i) / |det A|                                                           as (CW5)
/// ```
///
/// Every body that satisfies all strips so far is in the set.
///
/// # References
///
/// A. Vicino, G. Zappa, "Sequential approximation of feasible parameter sets for identification with set membership
/// uncertainty", IEEE Transactions on Automatic Control 41(6), 1996.
#[derive(Debug, Clone, Copy)]
pub(super) struct BodySet {
    rows: [BodyRow; PARAMETERS],
    /// Inverse of the matrix of the rows.
    inverse: [BodyRow; PARAMETERS],
    strips: [(f64, f64); PARAMETERS],
    /// Interval of each parameter by itself.
    box_of: [(f64, f64); PARAMETERS],
}

impl BodySet {
    /// All bodies of a payload set.
    pub(super) fn of(set: &PayloadSet) -> Self {
        let (low, high) = set.mass;
        let mut rows = [[0.0; PARAMETERS]; PARAMETERS];
        let mut inverse = rows;
        let mut strips = [widened((low, high)); PARAMETERS];
        let mut box_of = strips;
        (rows[0][0], inverse[0][0]) = (1.0, 1.0);
        for (axis, (from, to)) in set.com.into_iter().enumerate() {
            let (i, middle, half) = (axis + 1, 0.5 * (from + to), 0.5 * (to - from));
            (rows[i][i], inverse[i][i]) = (1.0, 1.0);
            (rows[i][0], inverse[i][0]) = (-middle, middle);
            strips[i] = widened((-half * high, half * high));
            let ends = [from * low, from * high, to * low, to * high];
            box_of[i] = widened(ends.into_iter().fold((f64::INFINITY, f64::NEG_INFINITY), hull));
        }
        Self { rows, inverse, strips, box_of }
    }

    /// Least and largest value of a linear function over the set.
    pub(super) fn range(&self, of: &BodyRow) -> (f64, f64) {
        let weights = self.weights(of);
        let by_strips = sum(&weights, &self.strips);
        let by_box = sum(of, &self.box_of);
        (larger(by_strips.0, by_box.0), smaller(by_strips.1, by_box.1))
    }

    /// Leaves the bodies with `low ≤ a·p ≤ high`; `false`: there is none, and the set is as it was.
    pub(super) fn cut(&mut self, a: &BodyRow, (low, high): (f64, f64)) -> bool {
        let slack = ROUNDING * (high - low + low.abs() + high.abs());
        let (low, high) = (low - slack, high + slack);
        let range = self.range(a);
        if low > range.1 || high < range.0 {
            return false;
        }
        let strip = (larger(low, range.0), smaller(high, range.1));
        if strip.0 <= range.0 && strip.1 >= range.1 {
            return true;
        }
        let weights = self.weights(a);
        let strips = narrowed(&weights, &self.strips, strip);
        self.box_of = narrowed(a, &self.box_of, strip);
        self.strips = strips;
        self.exchange(a, &weights, strip);
        for i in 0..PARAMETERS {
            let mut unit = [0.0; PARAMETERS];
            unit[i] = 1.0;
            let (from, to) = sum(&self.weights(&unit), &self.strips);
            let slack = ROUNDING * (to - from);
            let own = &mut self.box_of[i];
            *own = widened((larger(own.0, from - slack), smaller(own.1, to + slack)));
        }
        true
    }

    /// The strip takes the place of the one for which the volume becomes least, if it becomes less.
    fn exchange(&mut self, a: &BodyRow, weights: &BodyRow, strip: (f64, f64)) {
        let strip = widened(strip);
        let width = strip.1 - strip.0;
        let gain = |i: &usize| weights[*i].abs() * (self.strips[*i].1 - self.strips[*i].0) / width;
        let best = (1..PARAMETERS).fold(0, |best, i| if gain(&i) > gain(&best) { i } else { best });
        if gain(&best).is_nan() || gain(&best) < 1.0 + GAIN {
            return;
        }
        (self.rows[best], self.strips[best]) = (*a, strip);
        // A p with another row: A⁻¹ by a step of Gauss and Jordan.
        for row in &mut self.inverse {
            row[best] /= weights[best];
            for (j, weight) in weights.iter().enumerate() {
                if j != best {
                    row[j] -= weight * row[best];
                }
            }
        }
    }

    /// `w` with `a·p = w·(A p)`.
    fn weights(&self, a: &BodyRow) -> BodyRow {
        core::array::from_fn(|j| (0..PARAMETERS).map(|i| a[i] * self.inverse[i][j]).sum())
    }

    /// Interval of the mass \[kg\].
    pub(super) fn mass(&self) -> (f64, f64) {
        let (low, high) = self.range(&[1.0, 0.0, 0.0, 0.0]);
        (larger(low, 0.0), high)
    }

    /// Interval of a coordinate of the centre of mass \[m\], within one that is known.
    pub(super) fn com(&self, axis: usize, (from, to): (f64, f64)) -> (f64, f64) {
        let beyond = |x: f64| {
            let mut row = [-x, 0.0, 0.0, 0.0];
            row[axis + 1] = 1.0;
            self.range(&row)
        };
        // c ≤ x for all bodies of the set where h − m x ≤ 0 is, and that for all larger x too.
        let (mut low, mut high) = ((from, to), (from, to));
        for _ in 0..40 {
            let middle = 0.5 * (high.0 + high.1);
            if beyond(middle).1 <= 0.0 {
                high.1 = middle;
            } else {
                high.0 = middle;
            }
            let middle = 0.5 * (low.0 + low.1);
            if beyond(middle).0 >= 0.0 {
                low.0 = middle;
            } else {
                low.1 = middle;
            }
        }
        (low.0, high.1)
    }
}

/// Each interval as narrow as the others leave it, where the sum with these weights is in the strip.
fn narrowed(
    weights: &BodyRow,
    intervals: &[(f64, f64); PARAMETERS],
    (low, high): (f64, f64),
) -> [(f64, f64); PARAMETERS] {
    let mut next = *intervals;
    for i in 0..PARAMETERS {
        let mut others = *weights;
        others[i] = 0.0;
        let rest = sum(&others, intervals);
        let weight = weights[i];
        if weight.abs() < 1e-12 {
            continue;
        }
        let ends = ((low - rest.1) / weight, (high - rest.0) / weight);
        let (from, to) = if weight > 0.0 { ends } else { (ends.1, ends.0) };
        let slack = ROUNDING * (from.abs() + to.abs());
        let (old, own) = (intervals[i], (from - slack, to + slack));
        next[i] = widened((larger(old.0, own.0), smaller(old.1, own.1)));
    }
    next
}

/// Range of a sum with these weights.
fn sum(weights: &BodyRow, intervals: &[(f64, f64); PARAMETERS]) -> (f64, f64) {
    weights.iter().zip(intervals).fold((0.0, 0.0), |(low, high), (w, (from, to))| {
        let ends = (w * from, w * to);
        (low + smaller(ends.0, ends.1), high + larger(ends.0, ends.1))
    })
}

/// An interval that is not narrower than the least, about the same middle.
fn widened((low, high): (f64, f64)) -> (f64, f64) {
    let less = 0.5 * (LEAST_WIDTH - (high - low));
    if less > 0.0 { (low - less, high + less) } else { (low, high) }
}

fn hull((low, high): (f64, f64), x: f64) -> (f64, f64) {
    (smaller(low, x), larger(high, x))
}

pub(super) fn smaller(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}

pub(super) fn larger(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn payloads() -> PayloadSet {
        PayloadSet {
            frame: "tip".to_owned(),
            mass: (0.0, 2.0),
            com: [(-0.1, 0.1), (-0.05, 0.05), (0.0, 0.2)],
            gyration: 0.0,
            place_stated: true,
        }
    }

    /// A generator of its own: the tests must not depend on how a simulation draws.
    struct Drawn(u64);

    impl Drawn {
        fn next(&mut self, low: f64, high: f64) -> f64 {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            low + (high - low) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
        }
    }

    /// False if a cut ever loses the body that all strips were made around, or if strips do not narrow its mass.
    #[test]
    fn a_set_holds_the_body_that_every_strip_holds() {
        let mut drawn = Drawn(1);
        for _ in 0..300 {
            let (m, c) = (drawn.next(0.0, 2.0), payloads().com.map(|(a, b)| drawn.next(a, b)));
            let truth = [m, m * c[0], m * c[1], m * c[2]];
            let mut set = BodySet::of(&payloads());
            for _ in 0..200 {
                let a: BodyRow = core::array::from_fn(|i| {
                    drawn.next(-9.0, 9.0) * if i == 0 { 0.5 } else { 1.0 }
                });
                let value: f64 = a.iter().zip(truth).map(|(a, p)| a * p).sum();
                let strip = (value - drawn.next(0.0, 0.3), value + drawn.next(0.0, 0.3));
                assert!(set.cut(&a, strip));
                for (i, p) in truth.into_iter().enumerate() {
                    let mut unit = [0.0; PARAMETERS];
                    unit[i] = 1.0;
                    let (low, high) = set.range(&unit);
                    assert!(low <= p && p <= high, "{i}: {p} in {low} … {high}");
                }
            }
            let (low, high) = set.mass();
            assert!(high - low < 0.1, "{low} … {high}");
            for (axis, (prior, c)) in payloads().com.into_iter().zip(c).enumerate() {
                let (low, high) = set.com(axis, prior);
                assert!(
                    m < 1e-6 || (low <= c + 1e-9 && c - 1e-9 <= high),
                    "{axis}: {c} in {low} … {high}"
                );
            }
        }
    }

    /// False if a strip beside the set does not count as empty.
    #[test]
    fn a_strip_without_a_body_leaves_none() {
        let mut set = BodySet::of(&payloads());
        assert!(set.cut(&[1.0, 0.0, 0.0, 0.0], (0.4, 0.6)));
        assert!(!set.cut(&[1.0, 0.0, 0.0, 0.0], (0.7, 0.9)));
        let (low, high) = set.mass();
        assert!((low - 0.4).abs() < 1e-6 && (high - 0.6).abs() < 1e-6);
    }
}
