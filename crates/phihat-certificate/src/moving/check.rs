//! The proof behind [`super::Moving`], with nothing but arithmetic: polynomials in `w = z − 1`, by cells of frequency.

use core::f64::consts::PI;

/// Cells narrower than this share of their frequency prove nothing more in double precision.
const NARROWEST: f64 = 1e-12;

/// The same near zero frequency \[rad/sample\].
const NARROWEST_AT_ZERO: f64 = 1e-18;

/// Most taps of a multiplier.
const TAPS: usize = 4096;

/// One joint's loop, cut where its torque meets the inertia; coefficients of `w⁰, w¹, …`.
#[derive(Debug, Clone, PartialEq)]
pub struct Loop {
    /// `N`: from acceleration, held over a sample, to minus the torque, over `Δ`.
    pub numerator: Vec<f64>,
    /// `Δ`.
    pub denominator: Vec<f64>,
    /// `K`: the same from a kick in position of `T²/2` at the end of a sample.
    pub kick: Vec<f64>,
}

/// What is to be proved: see [`super::Moving`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Claim<'a> {
    pub(crate) low: f64,
    pub(crate) high: f64,
    pub(crate) period: f64,
    pub(crate) rate: f64,
    pub(crate) h: &'a [f64],
    pub(crate) drift: f64,
}

/// An inequality that does not hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Failure {
    /// As a formula.
    pub inequality: String,
    /// Frequency \[rad/sample\], where there is one.
    pub theta: f64,
    /// Its left side.
    pub left: f64,
    /// Its right side.
    pub right: f64,
}

impl Claim<'_> {
    /// `χ = high·rate·T/low²`.
    fn chi(&self) -> f64 {
        self.high * self.rate * self.period / (self.low * self.low)
    }

    /// `δ = rate·T (1 + χ²/12)`: bounds the change of `W_k` from one sample to the next.
    pub(crate) fn delta(&self) -> f64 {
        self.rate * self.period * (1.0 + self.chi() * self.chi() / 12.0)
    }

    /// `η = χ/6`: position and velocity see means of `W^{-1}` that differ by at most this share.
    pub(crate) fn apart(&self) -> f64 {
        self.chi() / 6.0
    }

    /// `Σ |h_j| min(δ j, high − low)`: what the change of inertia may add.
    pub(crate) fn spent(&self) -> f64 {
        let (delta, most) = (self.delta(), self.high - self.low);
        let taps = self.h.iter().enumerate();
        taps.map(|(j, h)| h.abs() * (delta * (j + 1) as f64).min(most)).sum()
    }

    /// `y(θ) = 2 Σ h_j sin jθ`, and a bound on its slope.
    pub(crate) fn multiplier(&self, theta: f64) -> f64 {
        let taps = self.h.iter().enumerate();
        2.0 * taps.map(|(j, h)| h * ((j + 1) as f64 * theta).sin()).sum::<f64>()
    }

    fn slope(&self) -> f64 {
        2.0 * self.h.iter().enumerate().map(|(j, h)| (j + 1) as f64 * h.abs()).sum::<f64>()
    }

    /// Proves the claim about one loop.
    pub(crate) fn check(&self, about: &Loop) -> Result<(), Failure> {
        self.plausible(about)?;
        let mut cells = vec![(0.0, PI)];
        let mut turned = 0.0;
        let shifted = self.shifted(about);
        while let Some((from, to)) = cells.pop() {
            let cell = self.cell(about, &shifted, (from, to));
            if cell.holds {
                turned += turn(&shifted, from, to);
            } else if to - from < NARROWEST * to + NARROWEST_AT_ZERO {
                let inequality = format!(
                    "|N + cΔ|² + y Im(NΔ*) > (r² + κ + λη²)(|Δ|² + |K|²/λ) + |K|²y²/4λ at θ = {from:.6} rad/sample"
                );
                return Err(Failure {
                    inequality,
                    theta: from,
                    left: cell.left,
                    right: cell.right,
                });
            } else {
                let middle = 0.5 * (from + to);
                cells.extend([(middle, to), (from, middle)]);
            }
        }
        let wanted = PI * (about.denominator.len() - 1) as f64;
        holds("argument of N + cΔ over the half circle = π · degree", (turned, wanted), {
            (turned - wanted).abs() < 1e-6
        })
    }

    fn plausible(&self, about: &Loop) -> Result<(), Failure> {
        let Self { low, high, period, rate, drift, .. } = *self;
        holds("0 < low ≤ high < ∞", (low, high), 0.0 < low && low <= high && high.is_finite())?;
        holds("0 < T < ∞", (period, 0.0), 0.0 < period && period.is_finite())?;
        holds("0 ≤ rate < ∞", (rate, 0.0), 0.0 <= rate && rate.is_finite())?;
        holds("0 < λ < ∞", (drift, 0.0), 0.0 < drift && drift.is_finite())?;
        let finite = self.h.iter().all(|h| h.is_finite()) && self.h.len() <= TAPS;
        holds("taps are finite", (self.h.len() as f64, TAPS as f64), finite)?;
        let (n, d, k) = (about.numerator.len(), about.denominator.len(), about.kick.len());
        let leads = about.denominator.last().is_some_and(|lead| lead.abs() > 0.0);
        let proper = d > 1 && n < d && k < d && leads;
        holds("the torque answers later than it acts", (n.max(k) as f64, d as f64), proper)?;
        let all = about.numerator.iter().chain(&about.denominator).chain(&about.kick);
        holds("the loop is finite", (0.0, 0.0), all.into_iter().all(|c| c.is_finite()))
    }

    /// `N + cΔ`, `c = (low + high)/2`.
    fn shifted(&self, about: &Loop) -> Vec<f64> {
        let c = 0.5 * (self.low + self.high);
        let n = |i: usize| about.numerator.get(i).copied().unwrap_or(0.0);
        about.denominator.iter().enumerate().map(|(i, d)| n(i) + c * d).collect()
    }

    /// Both sides at the middle of a cell, and whether they stay apart over all of it.
    fn cell(&self, about: &Loop, shifted: &[f64], (from, to): (f64, f64)) -> Cell {
        let (theta, half) = (0.5 * (from + to), 0.5 * (to - from));
        let (w, reach) = (on_circle(theta), size(on_circle(to)));
        let ball = |p: &[f64]| {
            let moves = half * slope(p, reach) + 64.0 * f64::EPSILON * bound(p, reach);
            (at(p, w), moves)
        };
        let ((g, dg), (d, dd)) = (ball(shifted), ball(&about.denominator));
        let ((n, dn), (k, dk)) = (ball(&about.numerator), ball(&about.kick));
        let (y, rounding) = (self.multiplier(theta), 64.0 * f64::EPSILON * self.slope());
        let dy = half * self.slope() + rounding;
        let turned = n.1 * d.0 - n.0 * d.1;
        let dt = size(n) * dd + size(d) * dn + dn * dd + 8.0 * f64::EPSILON * size(n) * size(d);
        let room = |g: f64, y_turned: f64, (d, k, y): (f64, f64, f64)| {
            let (r, apart) = (0.5 * (self.high - self.low), self.apart());
            let whole = r * r + self.spent() + self.drift * apart * apart;
            let right = whole * (d * d + k * k / self.drift) + k * k * y * y / (4.0 * self.drift);
            (g * g + y_turned, right)
        };
        let (left, right) = room(size(g), y * turned, (size(d), size(k), y));
        let least = (size(g) - dg).max(0.0);
        let y_turned = y * turned - y.abs() * dt - dy * (turned.abs() + dt);
        let (low, high) = room(least, y_turned, (size(d) + dd, size(k) + dk, y.abs() + dy));
        Cell { left, right, holds: size(g) > dg && low > high * (1.0 + 1e-12) }
    }
}

struct Cell {
    left: f64,
    right: f64,
    holds: bool,
}

fn holds(inequality: &str, (left, right): (f64, f64), holds: bool) -> Result<(), Failure> {
    let failure = || Failure { inequality: inequality.to_owned(), theta: 0.0, left, right };
    if holds { Ok(()) } else { Err(failure()) }
}

/// `e^{jθ} − 1`, without cancellation near `θ = 0`.
fn on_circle(theta: f64) -> (f64, f64) {
    let half = (0.5 * theta).sin();
    (-2.0 * half * half, theta.sin())
}

fn size((re, im): (f64, f64)) -> f64 {
    re.hypot(im)
}

fn at(p: &[f64], (re, im): (f64, f64)) -> (f64, f64) {
    p.iter().rev().fold((0.0, 0.0), |(a, b), c| (a * re - b * im + c, a * im + b * re))
}

/// `Σ |c_k| r^k`.
fn bound(p: &[f64], r: f64) -> f64 {
    p.iter().rev().fold(0.0, |sum, c| sum * r + c.abs())
}

/// `Σ k |c_k| r^{k−1}`.
fn slope(p: &[f64], r: f64) -> f64 {
    let terms = p.iter().enumerate().skip(1).rev();
    terms.fold(0.0, |sum, (k, c)| sum * r + k as f64 * c.abs())
}

/// How far the argument turns over a cell on which the polynomial moves less than its own size.
fn turn(p: &[f64], from: f64, to: f64) -> f64 {
    let [a, b, c] = [from, 0.5 * (from + to), to].map(|theta| at(p, on_circle(theta)));
    let angle = |a: (f64, f64), b: (f64, f64)| (b.1 * a.0 - b.0 * a.1).atan2(b.0 * a.0 + b.1 * a.1);
    angle(a, b) + angle(b, c)
}
