//! Stability of a family of loops: no root on a circle, and as many inside as there are.

use core::f64::consts::{PI, TAU};

use super::complex::{Complex, Disc};
use super::returns::{Return, Returns};
use crate::{Refutation, refutation::refuse};

/// Cells narrower than this share of their frequency prove nothing more in double precision.
const NARROWEST: f64 = 1e-12;

/// The same near zero frequency \[rad/sample\].
const NARROWEST_AT_ZERO: f64 = 1e-16;

/// Cells after which a proof is given up.
const MOST: u32 = 4_000_000;

/// Loops `Δ + N/μ`, `μ` in `[low, high]`.
///
/// # Method
///
/// The half circle `w = ρe^{jθ} − 1` is cut into arcs, each inside a disc of `w`. Disc arithmetic encloses `Δ` and `N`
/// over it. Where 0 lies outside of every disc `Δ + N/μ`, no loop has a root there, and the argument turns by less
/// than `π` from end to end; else the arc is halved. Turns must add up to `π` times the degree: then all roots of one
/// loop are inside, and so are those of all.
///
/// # Not claimed
///
/// Rounding is bounded in every operation on discs, but not in sines and arc tangents: an error of one unit there is
/// taken for covered by the allowance of the products.
#[derive(Debug, Clone)]
pub(crate) struct Family<'a> {
    pub(crate) returns: &'a Returns,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

/// One arc: its disc of `w`, and both ends.
pub(crate) struct Arc {
    from: f64,
    to: f64,
    pub(crate) disc: Disc,
}

impl Arc {
    fn new(from: f64, to: f64, radius: f64) -> Self {
        let (centre, half) = (0.5 * (from + to), 0.5 * (to - from));
        // No point of an arc is farther from its middle than the arc is long.
        let reach = radius * half * (1.0 + 1e-12) + 1e-300;
        Self { from, to, disc: Disc::new(point(centre, radius), reach) }
    }
}

/// `ρe^{jθ} − 1`, without cancellation near `θ = 0`.
fn point(theta: f64, radius: f64) -> Complex {
    let half = (0.5 * theta).sin();
    Complex::new((radius - 1.0) - 2.0 * radius * half * half, radius * theta.sin())
}

impl Family<'_> {
    /// Proves all loops stable, every root within `radius`, and `|1 + L/μ| > distance` on the circle; `extra`
    /// samples of delay that the law does not know of come on top.
    pub(crate) fn stable(
        &self,
        claim: &str,
        (radius, distance, extra): (f64, f64, usize),
    ) -> Result<(), Refutation> {
        let Self { low, high, .. } = *self;
        if !(0.0 < low && low <= high && high.is_finite()) {
            return Err(refuse(claim, "0 < low ≤ high < ∞", low, high));
        }
        let wanted = PI * (self.returns.degree() + extra) as f64;
        let mut turned = 0.0;
        let late = |at: Return, w: Disc| Return {
            open: at.open * (w + Disc::real(1.0)).power(extra),
            back: at.back,
        };
        let closed = |theta: f64| {
            let w = Disc::new(point(theta, radius), 0.0);
            let at = late(self.returns.at(w), w);
            at.open.centre + at.back.centre.times(1.0 / high)
        };
        self.over_arcs(claim, radius, |arc| {
            let at = late(self.returns.at(arc.disc), arc.disc);
            let [a, b] =
                [1.0 / high, 1.0 / low].map(|share| at.open.centre + at.back.centre.times(share));
            let needed = at.open.radius
                + at.back.radius / low
                + distance * at.open.most()
                + 8.0 * f64::EPSILON * (at.open.most() + at.back.most() / low);
            let clear = from_segment(a, b) > needed;
            if clear {
                let (start, middle, end) =
                    (closed(arc.from), closed(0.5 * (arc.from + arc.to)), closed(arc.to));
                turned += middle.over(start).angle() + end.over(middle).angle();
            }
            clear
        })?;
        if (turned - wanted).abs() < 1e-6 {
            Ok(())
        } else {
            let what = "argument of Δ + N/μ over the half circle = π · degree";
            Err(refuse(claim, what, turned, wanted))
        }
    }

    /// Proves that no `−L/μ` equals `e^{jψ}` with `|ψ| ≤ phase` \[rad\], on the unit circle.
    pub(crate) fn turns(&self, claim: &str, phase: f64) -> Result<(), Refutation> {
        self.over_arcs(claim, 1.0, |arc| {
            self.outside(self.returns.at(arc.disc), |angle, half| {
                let folded = (angle + PI).rem_euclid(TAU) - PI;
                folded.abs() - half > phase
            })
        })
    }

    /// Proves that no `−L/μ` equals `e^{jθκ}` with `0 ≤ κ ≤ samples`: a lag.
    pub(crate) fn lags(&self, claim: &str, samples: f64) -> Result<(), Refutation> {
        self.over_arcs(claim, 1.0, |arc| {
            let most = arc.to * samples;
            self.outside(self.returns.at(arc.disc), |angle, half| {
                let first = (angle - half).rem_euclid(TAU);
                first > most && first + 2.0 * half < TAU
            })
        })
    }

    /// Returns true if `|L|` is outside of `[low, high]` all over a disc, or if `apart` accepts the angle of
    /// `−L`.
    fn outside(&self, at: Return, apart: impl Fn(f64, f64) -> bool) -> bool {
        let smallest = at.back.least() / at.open.most();
        if smallest > self.high {
            return true;
        }
        let open = at.open.least();
        if open > 0.0 && at.back.most() / open < self.low {
            return true;
        }
        let half = at.back.half_angle() + at.open.half_angle();
        half.is_finite() && {
            let angle = (-at.back.centre).angle() - at.open.centre.angle();
            apart(angle, half + 1e-15)
        }
    }

    /// Halves arcs of the half circle until `proves` says yes to each.
    fn over_arcs(
        &self,
        claim: &str,
        radius: f64,
        mut proves: impl FnMut(&Arc) -> bool,
    ) -> Result<(), Refutation> {
        over_arcs(radius, &mut proves).map_err(|from| {
            let what = format!(
                "0 is not among Δ + N/μ at θ = {from:.6} rad/sample, μ in [{}, {}]",
                self.low, self.high
            );
            let at = self.returns.at(Disc::new(point(from, radius), 0.0));
            let ends = [1.0 / self.high, 1.0 / self.low]
                .map(|share| at.open.centre + at.back.centre.times(share));
            let left = from_segment(ends[0], ends[1]);
            refuse(claim, &what, left, at.open.most())
        })
    }
}

/// Halves arcs of the half circle until `proves` says yes to each; else where it does not \[rad/sample\].
pub(crate) fn over_arcs(radius: f64, mut proves: impl FnMut(&Arc) -> bool) -> Result<(), f64> {
    let mut arcs = vec![(0.0, PI)];
    let mut seen = 0_u32;
    while let Some((from, to)) = arcs.pop() {
        seen += 1;
        if proves(&Arc::new(from, to, radius)) {
            continue;
        }
        if to - from < NARROWEST * to + NARROWEST_AT_ZERO || seen > MOST {
            return Err(from);
        }
        let middle = 0.5 * (from + to);
        arcs.extend([(middle, to), (from, middle)]);
    }
    Ok(())
}

/// `−L` at one frequency of the unit circle \[rad/sample\].
pub(crate) fn crossing(returns: &Returns, theta: f64) -> Complex {
    let at = returns.at(Disc::new(point(theta, 1.0), 0.0));
    (-at.back.centre).over(at.open.centre)
}

/// A point of the unit circle, as `w`.
pub(crate) fn on_circle(theta: f64) -> Complex {
    point(theta, 1.0)
}

/// Distance of 0 from the segment between two complex numbers.
fn from_segment(a: Complex, b: Complex) -> f64 {
    let along = b - a;
    let length = along.re * along.re + along.im * along.im;
    let share = -(a.re * along.re + a.im * along.im) / length;
    let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
    (a + along.times(share)).size()
}
