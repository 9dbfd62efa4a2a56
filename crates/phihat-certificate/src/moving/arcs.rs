//! The proof behind [`super::Moving`]: by arcs of the unit circle, from the checker's own loop.

use core::f64::consts::PI;

use super::document::{Moving, Unstable};
use crate::check::complex::{Complex, Disc};
use crate::check::exclusion::on_circle;
use crate::check::returns::Returns;

/// Arcs narrower than this share of their frequency prove nothing more in double precision.
const NARROWEST: f64 = 1e-12;

/// The same near zero frequency \[rad/sample\].
const NARROWEST_AT_ZERO: f64 = 1e-16;

/// Arcs after which a proof is given up.
const MOST: u32 = 1_000_000;

/// Room for the rounding of both sides, relative.
const ROOM: f64 = 1e-12;

/// One loop and what is claimed of it.
pub(super) struct Proof<'a> {
    moving: &'a Moving,
    returns: &'a Returns,
    /// `r² + κ + λη²`.
    whole: f64,
    /// `2 Σ j |h_j|`: bounds the slope of `y`.
    slope: f64,
}

/// Both sides in the middle of an arc, and whether they stay apart over all of it.
struct Sides {
    left: f64,
    right: f64,
    apart: bool,
}

impl<'a> Proof<'a> {
    pub(super) fn new(moving: &'a Moving, returns: &'a Returns, period: f64) -> Self {
        let (delta, eta) = moving.step(period);
        let range = moving.high - moving.low;
        let taps = || moving.h.iter().enumerate().map(|(j, h)| ((j + 1) as f64, h.abs()));
        let kappa: f64 = taps().map(|(j, h)| h * (delta * j).min(range)).sum();
        let whole = 0.25 * range * range + kappa + moving.drift * eta * eta;
        Self { moving, returns, whole, slope: 2.0 * taps().map(|(j, h)| j * h).sum::<f64>() }
    }

    /// Halves arcs of the half circle until (M2) holds on each; the turns of `N + cΔ` must add up to those of a stable
    /// loop.
    pub(super) fn run(&self) -> Result<(), Unstable> {
        let mut arcs = vec![(0.0, PI)];
        let (mut turned, mut seen) = (0.0, 0_u32);
        while let Some((from, to)) = arcs.pop() {
            seen += 1;
            let sides = self.sides(from, to);
            if sides.apart {
                turned += self.turn(from, to);
            } else if to - from < NARROWEST * to + NARROWEST_AT_ZERO || seen > MOST {
                let what = format!(
                    "|N + cΔ|² + y Im(NΔ*) > (r² + κ + λη²)(|Δ|² + |K|²/λ) + |K|²y²/4λ at θ = {from:.6} rad/sample"
                );
                return Err(Unstable::new(what, from, (sides.left, sides.right)));
            } else {
                let middle = 0.5 * (from + to);
                arcs.extend([(middle, to), (from, middle)]);
            }
        }
        let wanted = PI * self.returns.degree() as f64;
        if (turned - wanted).abs() < 1e-6 {
            return Ok(());
        }
        let what = "argument of N + cΔ over the half circle = π · degree".to_owned();
        Err(Unstable::new(what, 0.0, (turned, wanted)))
    }

    fn sides(&self, from: f64, to: f64) -> Sides {
        let (theta, half) = (0.5 * (from + to), 0.5 * (to - from));
        let w = Disc::new(on_circle(theta), half * (1.0 + 1e-12) + 1e-300);
        let (at, kick) = (self.returns.at(w), self.returns.kicked(w));
        let shifted = self.shifted(at.back, at.open);
        let (n, d) = (at.back, at.open);
        let y = self.moving.multiplier(theta);
        let dy = (half + 64.0 * f64::EPSILON) * self.slope;
        let cross = n.centre.im * d.centre.re - n.centre.re * d.centre.im;
        let spread = n.centre.size() * d.radius
            + d.centre.size() * n.radius
            + n.radius * d.radius
            + 8.0 * f64::EPSILON * n.centre.size() * d.centre.size();
        let least = shifted.least().max(0.0);
        let low = least * least + y * cross - y.abs() * spread - dy * (cross.abs() + spread);
        let high = self.right(d.most(), kick.most(), y.abs() + dy);
        let left = shifted.centre.size() * shifted.centre.size() + y * cross;
        let right = self.right(d.centre.size(), kick.centre.size(), y.abs());
        let apart = shifted.least() > 0.0 && low > high + ROOM * (high + least * least);
        Sides { left, right, apart }
    }

    fn right(&self, open: f64, kick: f64, y: f64) -> f64 {
        let lambda = self.moving.drift;
        self.whole * (open * open + kick * kick / lambda) + kick * kick * y * y / (4.0 * lambda)
    }

    /// `N + cΔ`.
    fn shifted(&self, back: Disc, open: Disc) -> Disc {
        back + open.times(0.5 * (self.moving.low + self.moving.high))
    }

    /// Angle by which the argument turns over an arc on which the values stay on one side of 0 \[rad\].
    fn turn(&self, from: f64, to: f64) -> f64 {
        let at = |theta: f64| -> Complex {
            let at = self.returns.at(Disc::new(on_circle(theta), 0.0));
            self.shifted(at.back, at.open).centre
        };
        let (start, middle, end) = (at(from), at(0.5 * (from + to)), at(to));
        middle.over(start).angle() + end.over(middle).angle()
    }
}
