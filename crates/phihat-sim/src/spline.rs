//! Twice continuously differentiable interpolation: natural cubic splines and quintic steps.

/// A natural cubic spline through one joint's samples: C², second derivative zero at both ends.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Spline {
    t: Vec<f64>,
    y: Vec<f64>,
    /// Second derivative at each knot.
    curvature: Vec<f64>,
}

/// Value, first and second derivative.
pub(crate) type Jet = [f64; 3];

impl Spline {
    /// Through `y[i]` at strictly increasing `t[i]`; fewer than two knots make a constant.
    pub(crate) fn new(t: &[f64], y: &[f64]) -> Self {
        Self { t: t.to_vec(), y: y.to_vec(), curvature: natural_curvature(t, y) }
    }

    /// The jet at `t`; held constant outside the knots.
    pub(crate) fn at(&self, t: f64) -> Jet {
        let (Some(first), Some(last)) = (self.t.first(), self.t.last()) else { return [0.0; 3] };
        if t < *first || self.t.len() < 2 {
            return [self.y[0], 0.0, 0.0];
        }
        if t > *last {
            return [self.y[self.y.len() - 1], 0.0, 0.0];
        }
        let right = self.t.partition_point(|knot| *knot <= t).clamp(1, self.t.len() - 1);
        let left = right - 1;
        let h = self.t[right] - self.t[left];
        let (a, b) = ((self.t[right] - t) / h, (t - self.t[left]) / h);
        let (y0, y1) = (self.y[left], self.y[right]);
        let (c0, c1) = (self.curvature[left], self.curvature[right]);
        let value = a * y0 + b * y1 + ((a * a * a - a) * c0 + (b * b * b - b) * c1) * h * h / 6.0;
        let slope = (y1 - y0) / h + ((1.0 - 3.0 * a * a) * c0 + (3.0 * b * b - 1.0) * c1) * h / 6.0;
        [value, slope, a * c0 + b * c1]
    }
}

impl Spline {
    /// The cubics between neighbouring samples.
    pub(crate) fn pieces(&self) -> impl Iterator<Item = SplinePiece> {
        let knots = self.t.windows(2).zip(self.curvature.windows(2));
        knots.filter_map(|(t, bend)| {
            let (&[from, to], &[bend, bend_after]) = (t, bend) else { return None };
            let slope = self.at(from)[1];
            Some(SplinePiece { from, length: to - from, slope, bend, bend_after })
        })
    }

    /// Times of the first and of the last sample.
    pub(crate) fn ends(&self) -> impl Iterator<Item = f64> {
        [self.t.first(), self.t.last()].into_iter().flatten().copied()
    }
}

/// A cubic between two samples.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SplinePiece {
    /// Time of its begin.
    pub(crate) from: f64,
    pub(crate) length: f64,
    /// Velocity at its begin.
    pub(crate) slope: f64,
    /// Acceleration at its begin and at its end.
    pub(crate) bend: f64,
    pub(crate) bend_after: f64,
}

/// Solves the tridiagonal system of the natural spline.
fn natural_curvature(t: &[f64], y: &[f64]) -> Vec<f64> {
    let n = t.len();
    let mut curvature = vec![0.0; n];
    let mut upper = vec![0.0; n];
    for i in 1..n.saturating_sub(1) {
        let (before, after) = (t[i] - t[i - 1], t[i + 1] - t[i]);
        let share = before / (before + after);
        let pivot = share * upper[i - 1] + 2.0;
        upper[i] = (share - 1.0) / pivot;
        let bend = (y[i + 1] - y[i]) / after - (y[i] - y[i - 1]) / before;
        curvature[i] = (6.0 * bend / (before + after) - share * curvature[i - 1]) / pivot;
    }
    for i in (1..n.saturating_sub(1)).rev() {
        curvature[i] += upper[i] * curvature[i + 1];
    }
    curvature
}

/// The quintic step `10s³ − 15s⁴ + 6s⁵` of `s = t/duration`, 0 before and 1 after: C².
pub(crate) fn quintic_step(t: f64, duration: f64) -> Jet {
    if t >= duration {
        return [1.0, 0.0, 0.0];
    }
    if t <= 0.0 {
        return [0.0; 3];
    }
    let s = t / duration;
    let value = s * s * s * (10.0 + s * (6.0 * s - 15.0));
    let slope = 30.0 * s * s * (1.0 - s) * (1.0 - s) / duration;
    let bend = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / (duration * duration);
    [value, slope, bend]
}
